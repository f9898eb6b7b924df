// What a planner that acts on the state would have lived through. Alarm: state FAILING or FAILED, silence (STALE)
// included. A failure found at the first sweep after a silence counts as told by it: what was true during the silence
// is not looked at.
//
// Everything is counted before the failure (or, without one, up to the run's end):
// missed       failing episodes without any alarm before the failing sweep
// alarm share  of the time, the alarm up
// available    of the time, neither alarm nor UNKNOWN
// false alarm  the alarm goes up though the failure is more than `early_s` away; if the run ends within early_s without
//              a failure nothing can be said and the alarm does not count. Per hour of time without alarm.
// lead time    from the first alarm to the failure, for failing episodes that were not missed; it suffices at a given
//              deceleration if it is at least speed / deceleration at the first alarm.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/fail_aware_episode.hpp"

namespace fail_aware {

bool isAlarm(FailAwareState state);

struct LeadTime {
  double lead_s = 0.0;
  double speed_mps = 0.0;  ///< at the first alarm
};

/// Nothing: the episode did not fail, or it failed without an alarm.
std::optional<LeadTime> leadTime(const FailAwareEpisode& episode);

struct AlarmStatistics {
  std::size_t episodes = 0, failing = 0, missed = 0, false_alarms = 0;
  double watched_s = 0.0, alarm_s = 0.0, unknown_s = 0.0;
  std::vector<LeadTime> leads;

  double missedRatio() const;  ///< of the failing episodes; 0 without any
  double alarmRatio() const;   ///< of the watched time
  double availableRatio() const;
  double falseAlarmsPerHour() const;
  /// Share of all failing episodes whose lead time suffices for a stop; a missed one does not.
  double stopRatio(double deceleration_mps2) const;
};

AlarmStatistics alarmStatistics(const std::vector<FailAwareEpisode>& episodes, double early_s = 30.0);

}  // namespace fail_aware
