#include "evaluation/alarm_statistics.hpp"

#include <algorithm>

namespace fail_aware {

namespace {

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

// What remained when the alarm of this sweep, or of the silence after it, came; nothing without either.
std::optional<double> remainingAtAlarm_s(const FailAwareEpisode& episode, std::size_t i) {
  const FailAwareSweep& sweep = episode.sweeps[i];
  if (isAlarm(sweep.output.state)) return sweep.remaining_s;
  if (sweep.silent_s > 0.0) return episode.sweeps[i + 1].remaining_s + sweep.silent_s;
  return std::nullopt;
}

}  // namespace

bool isAlarm(FailAwareState state) { return state == FailAwareState::kFailing || state == FailAwareState::kFailed; }

std::optional<LeadTime> leadTime(const FailAwareEpisode& episode) {
  if (!episode.failed) return std::nullopt;
  for (std::size_t i = 0; i < episode.sweepsBeforeFailure(); ++i) {
    const std::optional<double> remaining_s = remainingAtAlarm_s(episode, i);
    if (remaining_s) return LeadTime{*remaining_s, episode.sweeps[i].speed_mps};
  }
  return std::nullopt;
}

AlarmStatistics alarmStatistics(const std::vector<FailAwareEpisode>& episodes, double early_s) {
  AlarmStatistics statistics;
  for (const FailAwareEpisode& episode : episodes) {
    ++statistics.episodes;
    if (episode.failed) {
      ++statistics.failing;
      const std::optional<LeadTime> lead = leadTime(episode);
      if (lead) {
        statistics.leads.push_back(*lead);
      } else {
        ++statistics.missed;
      }
    }
    bool was_up = false;
    for (std::size_t i = 0; i < episode.sweepsBeforeFailure(); ++i) {
      const FailAwareSweep& sweep = episode.sweeps[i];
      const bool is_up = isAlarm(sweep.output.state);
      const std::optional<double> remaining_s = remainingAtAlarm_s(episode, i);
      const bool goes_on = is_up && was_up;
      if (remaining_s && !goes_on && *remaining_s > early_s) ++statistics.false_alarms;
      was_up = remaining_s.has_value();
      // a sweep's state holds until the next sweep, at the end of the run for nothing
      const bool last = i + 1 == episode.sweeps.size();
      const double held_s = last ? 0.0 : episode.sweeps[i + 1].since_start_s - sweep.since_start_s;
      statistics.watched_s += held_s;
      statistics.alarm_s += is_up ? held_s : sweep.silent_s;
      if (sweep.output.state == FailAwareState::kUnknown) statistics.unknown_s += held_s - sweep.silent_s;
    }
  }
  return statistics;
}

double AlarmStatistics::missedRatio() const { return share(static_cast<double>(missed), static_cast<double>(failing)); }

double AlarmStatistics::alarmRatio() const { return share(alarm_s, watched_s); }

double AlarmStatistics::availableRatio() const { return share(watched_s - alarm_s - unknown_s, watched_s); }

double AlarmStatistics::falseAlarmsPerHour() const {
  return share(3600.0 * static_cast<double>(false_alarms), watched_s - alarm_s);
}

double AlarmStatistics::stopRatio(double deceleration_mps2) const {
  const auto enough = std::count_if(leads.begin(), leads.end(), [&](const LeadTime& lead) {
    return lead.lead_s >= lead.speed_mps / deceleration_mps2;
  });
  return share(static_cast<double>(enough), static_cast<double>(failing));
}

}  // namespace fail_aware
