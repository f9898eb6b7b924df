#include "evaluation/planner_figure.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>

namespace fail_aware {

namespace {

constexpr double kFirstLook_s = 3.0;
constexpr double kShortestStop_s = 1.0;
constexpr double kSame_s = 1e-6, kSame_m = 1e-6;  // stamps are differences

constexpr double kFirstTime_s = 3.0, kLastTime_s = 60.0, kTimeStep_s = 1.0;
constexpr double kFirstDistance_m = 10.0, kLastDistance_m = 1990.0, kDistanceStep_m = 10.0;

std::optional<double> ratioOf(double part, double whole) {
  return whole > 0.0 ? std::optional<double>(part / whole) : std::nullopt;
}

double stopTime_s(double speed_mps, double deceleration_mps2) {
  return std::max(kShortestStop_s, speed_mps / deceleration_mps2);
}

bool isStopState(FailAwareState state) {
  return state == FailAwareState::kFailing || state == FailAwareState::kFailed || state == FailAwareState::kUnknown;
}

bool isWithin(const TimeToFailure& time, double seconds) { return time.isKnown() && time.seconds <= seconds; }

/// The second in which the stop begins, of those from `first` on; the number of seconds if it never does.
using BeginOfStop = std::function<std::size_t(const PlannerDrive&, std::size_t first)>;

std::size_t firstLook(const PlannerDrive& drive) {
  const auto it = std::find_if(drive.seconds.begin(), drive.seconds.end(), [](const PlannerSecond& second) {
    return second.since_start_s >= kFirstLook_s - kSame_s;
  });
  return static_cast<std::size_t>(it - drive.seconds.begin());
}

// The last second before that time; nullptr if there is none.
const PlannerSecond* lastBefore(const PlannerDrive& drive, double since_start_s) {
  const auto it = std::find_if(drive.seconds.begin(), drive.seconds.end(),
                               [&](const PlannerSecond& second) { return second.since_start_s >= since_start_s; });
  return it == drive.seconds.begin() ? nullptr : &*std::prev(it);
}

// By the speed at the fault, whatever the planner does: which failures are stoppable is the same for all rules.
bool isTooSudden(const PlannerDrive& drive, double deceleration_mps2) {
  return std::any_of(drive.faults_s.begin(), drive.faults_s.end(), [&](double begin_s) {
    const PlannerSecond* const at_fault = lastBefore(drive, begin_s + kSame_s);
    const double stop_s = stopTime_s(at_fault ? at_fault->speed_mps : 0.0, deceleration_mps2);
    return begin_s > 0.0 && begin_s <= drive.time_s && drive.time_s - begin_s < stop_s;
  });
}

// A failure before the planner's first look, or at it.
void addEarlyFailure(const PlannerDrive& drive, PlannerFigure& figure) {
  const PlannerSecond* const last = lastBefore(drive, drive.time_s - kSame_s);
  if (!last) return;  // nothing was said before it
  ++figure.unstoppable;
  if (isStopState(last->state) || last->time_to_failure.seconds <= kShortestStop_s) ++figure.told;
}

void addSound(const PlannerDrive& drive, double stop_begin_s, PlannerFigure& figure) {
  ++figure.sound;
  if (stop_begin_s < drive.time_s) ++figure.sound_stopped;
  figure.possible_sound_s += drive.time_s;
  figure.used_sound_s += std::min(stop_begin_s, drive.time_s);
}

void add(const PlannerDrive& drive, double deceleration_mps2, const BeginOfStop& beginOfStop, PlannerFigure& figure) {
  const std::size_t look = firstLook(drive);
  const bool looks = look < drive.seconds.size();
  const double first_stop_s = looks ? stopTime_s(drive.seconds[look].speed_mps, deceleration_mps2) : kShortestStop_s;
  if (drive.failed && isTooSudden(drive, deceleration_mps2)) {
    ++figure.too_sudden;
    return;
  }
  if (drive.failed && (!looks || drive.seconds[look].since_start_s >= drive.time_s - kSame_s)) {
    addEarlyFailure(drive, figure);
    return;
  }
  if (!looks) return;
  const std::size_t stop = beginOfStop(drive, look);
  const bool stops = stop < drive.seconds.size();
  const double stop_begin_s = stops ? drive.seconds[stop].since_start_s : std::numeric_limits<double>::infinity();
  if (!drive.failed) {
    addSound(drive, stop_begin_s, figure);
  } else if (drive.time_s + kSame_s >= kFirstLook_s + first_stop_s) {
    const bool before = stop_begin_s < drive.time_s;  // one that begins after the failure says nothing of it
    const double stop_s = before ? stopTime_s(drive.seconds[stop].speed_mps, deceleration_mps2) : first_stop_s;
    ++figure.stoppable;
    if (stop_begin_s + stop_s <= drive.time_s + kSame_s) ++figure.in_time;
    const double possible_s = std::max(0.0, drive.time_s - stop_s);
    figure.possible_failing_s += possible_s;
    figure.used_failing_s += std::min(stop_begin_s, possible_s);
  } else {
    ++figure.unstoppable;
    if (stop_begin_s <= drive.seconds[look].since_start_s + kSame_s) ++figure.told;
  }
}

PlannerFigure figureWith(const std::vector<PlannerDrive>& drives, double deceleration_mps2,
                         const BeginOfStop& beginOfStop) {
  PlannerFigure figure;
  for (const PlannerDrive& drive : drives) add(drive, deceleration_mps2, beginOfStop, figure);
  return figure;
}

template <class Condition>
std::size_t firstSecond(const PlannerDrive& drive, std::size_t first, Condition&& condition) {
  while (first < drive.seconds.size() && !condition(drive.seconds[first])) ++first;
  return first;
}

/// The better of two baselines: see the header.
bool isBetter(const PlannerFigure& a, const PlannerFigure& b, std::size_t in_time) {
  const bool a_reaches = a.in_time >= in_time, b_reaches = b.in_time >= in_time;
  if (a_reaches != b_reaches) return a_reaches;
  if (!a_reaches) return a.in_time > b.in_time;
  return a.used_failing_s + a.used_sound_s > b.used_failing_s + b.used_sound_s;
}

template <class FigureAt>
FixedRule bestOf(double first, double last, double step, std::size_t in_time, FigureAt&& figureAt) {
  FixedRule best{first, figureAt(first)};
  for (int i = 1; first + i * step <= last; ++i) {
    const double value = first + i * step;
    const PlannerFigure figure = figureAt(value);
    if (isBetter(figure, best.figure, in_time)) best = {value, figure};
  }
  return best;
}

}  // namespace

PlannerDrive plannerDrive(const FailAwareEpisode& episode) {
  PlannerDrive drive;
  drive.time_s = episode.time_s;
  drive.failed = episode.failed;
  drive.faults_s = episode.fault_begins_s;
  for (const std::size_t i : eachSecond(episode)) {
    const FailAwareSweep& sweep = episode.sweeps[i];
    drive.seconds.push_back({sweep.since_start_s, sweep.output.time_to_failure, sweep.output.state, sweep.speed_mps});
  }
  return drive;
}

PlannerFigure plannerFigure(const std::vector<PlannerDrive>& drives, double deceleration_mps2, StopRule rule) {
  return figureWith(drives, deceleration_mps2, [&](const PlannerDrive& drive, std::size_t first) {
    return firstSecond(drive, first, [&](const PlannerSecond& second) {
      const bool by_time =
          rule != StopRule::kState && isWithin(second.time_to_failure, stopTime_s(second.speed_mps, deceleration_mps2));
      return by_time || (rule != StopRule::kTime && isStopState(second.state));
    });
  });
}

FixedRule bestFixedTime(const std::vector<PlannerDrive>& drives, double deceleration_mps2, std::size_t in_time) {
  return bestOf(kFirstTime_s, kLastTime_s, kTimeStep_s, in_time, [&](double time_s) {
    return figureWith(drives, deceleration_mps2, [&](const PlannerDrive& drive, std::size_t first) {
      return firstSecond(drive, first,
                         [&](const PlannerSecond& second) { return second.since_start_s >= time_s - kSame_s; });
    });
  });
}

FixedRule bestFixedDistance(const std::vector<PlannerDrive>& drives, double deceleration_mps2, std::size_t in_time) {
  return bestOf(kFirstDistance_m, kLastDistance_m, kDistanceStep_m, in_time, [&](double limit_m) {
    return figureWith(drives, deceleration_mps2, [&](const PlannerDrive& drive, std::size_t first) {
      double distance_m = 0.0;
      for (std::size_t i = 0; i < drive.seconds.size(); ++i) {
        const PlannerSecond& now = drive.seconds[i];
        if (i > 0) distance_m += (now.since_start_s - drive.seconds[i - 1].since_start_s) * now.speed_mps;
        if (i >= first && distance_m >= limit_m - kSame_m) return i;
      }
      return drive.seconds.size();
    });
  });
}

std::optional<double> PlannerFigure::usedRatio() const {
  return ratioOf(used_failing_s + used_sound_s, possible_failing_s + possible_sound_s);
}

std::optional<double> PlannerFigure::usedRatioOfFailing() const { return ratioOf(used_failing_s, possible_failing_s); }

std::optional<double> PlannerFigure::usedRatioOfSound() const { return ratioOf(used_sound_s, possible_sound_s); }

}  // namespace fail_aware
