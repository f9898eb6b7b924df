#include "evaluation/fail_aware_episode.hpp"

#include <algorithm>
#include <cmath>

#include "core/integrity/monitor_replay.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

FailAwareEpisode makeEpisode(const std::vector<Pose>& truth, const std::vector<MonitorInput>& log,
                             const FailureEpisode& found, const MonitorParameters& monitor, double alert_limit_m,
                             const SilenceParams& silence) {
  FailAwareEpisode episode;
  episode.begin_s = found.begin_s;
  episode.failed = found.failed;
  episode.time_s = found.time_s;
  episode.alert_limit_m = alert_limit_m;
  const std::vector<MonitorOutput> outputs = replayMonitor(log, found.begin_s - log.front().state.stamp_s, monitor);
  const Pose T_begin_truth = truth[found.begin].inverse();
  const Pose T_begin_estimate = log[found.begin].state.T_odom_cog.inverse();
  double distance_m = 0.0, period_s = kUsualPeriod_s;
  for (std::size_t i = found.begin; i < log.size(); ++i) {
    const FilterState& state = log[i].state;
    FailAwareSweep sweep;
    sweep.since_start_s = state.stamp_s - found.begin_s;
    sweep.remaining_s = found.time_s - sweep.since_start_s;
    const double step_m = state.T_previous_now.translation().norm();
    if (i > found.begin) distance_m += step_m;
    sweep.distance_m = distance_m;
    sweep.speed_mps = state.dt_s > 0.0 ? step_m / state.dt_s : 0.0;
    sweep.error_m =
        (T_begin_truth * truth[i].translation() - T_begin_estimate * state.T_odom_cog.translation()).head<2>();
    sweep.output = outputs[i];
    if (state.dt_s > 0.0) period_s = state.dt_s;
    if (i + 1 < log.size()) {
      const double interval_s = log[i + 1].state.stamp_s - state.stamp_s;
      sweep.silent_s = std::max(0.0, interval_s - staleAfter_s(silence, period_s));
    }
    episode.sweeps.push_back(sweep);
  }
  return episode;
}

}  // namespace

std::size_t FailAwareEpisode::sweepsBeforeFailure() const {
  if (!failed) return sweeps.size();
  const auto it =
      std::find_if(sweeps.begin(), sweeps.end(), [](const FailAwareSweep& s) { return s.remaining_s <= 0.0; });
  return static_cast<std::size_t>(it - sweeps.begin());
}

bool FailAwareEpisode::isBeforeAFault(std::size_t sweep) const {
  const double now_s = sweeps[sweep].since_start_s;
  return failed && std::any_of(fault_begins_s.begin(), fault_begins_s.end(),
                               [&](double fault_s) { return fault_s > now_s && fault_s < time_s; });
}

std::vector<FailAwareEpisode> failAwareEpisodes(const std::vector<Pose>& truth, const std::vector<MonitorInput>& log,
                                                const MonitorParameters& monitor, const FailureEpisode::Params& params,
                                                const SilenceParams& silence) {
  std::vector<Pose> estimate;
  std::vector<double> stamps_s;
  for (const MonitorInput& input : log) {
    estimate.push_back(input.state.T_odom_cog);
    stamps_s.push_back(input.state.stamp_s);
  }
  std::vector<FailAwareEpisode> episodes;
  std::size_t last_begin = log.size();
  for (const FailureEpisode& asked_for : failureEpisodes(truth, estimate, stamps_s, params)) {
    std::size_t begin = asked_for.begin;  // t1 waits for an observed motion
    while (begin < log.size() && !log[begin].state.motionObserved()) ++begin;
    if (begin + 1 >= log.size() || begin == last_begin) continue;
    last_begin = begin;
    const FailureEpisode found = failureEpisode(truth, estimate, stamps_s, begin, params.alert_limit_m);
    episodes.push_back(makeEpisode(truth, log, found, monitor, params.alert_limit_m, silence));
  }
  return episodes;
}

std::vector<std::size_t> judgedSweeps(const FailAwareEpisode& episode) {
  std::vector<std::size_t> judged;
  const std::size_t end = episode.sweepsBeforeFailure();
  int second = 1;
  for (std::size_t i = 0; i < end; ++i) {
    const double since_start_s = episode.sweeps[i].since_start_s + kStartTolerance_s;
    if (since_start_s < second) continue;
    judged.push_back(i);
    // 1, 3, 5, 6, 7, ... ; a gap in the stamps skips what fell into it
    do {
      second += second < 5 ? 2 : 1;
    } while (second <= since_start_s);
  }
  return judged;
}

std::vector<std::size_t> eachSecond(const FailAwareEpisode& episode) {
  std::vector<std::size_t> chosen;
  double next_s = 0.0;
  for (std::size_t i = 0; i < episode.sweeps.size(); ++i) {
    const double since_start_s = episode.sweeps[i].since_start_s + kStartTolerance_s;
    if (since_start_s < next_s) continue;
    next_s = std::floor(since_start_s) + 1.0;
    chosen.push_back(i);
  }
  return chosen;
}

}  // namespace fail_aware
