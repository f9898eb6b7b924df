// Decides whether the silence of the filter states is a failure (core/integrity/silence.hpp) and whether a message
// about it is due. Times: s of one clock. The clock may jump back when simulated time restarts; silence then counts
// from there.
#pragma once

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "core/integrity/silence.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

class SilenceWatch {
 public:
  static constexpr double kRepeat_s = 0.1;  ///< interval between the messages during silence

  /// Silence counts from `now_s` on.
  explicit SilenceWatch(const SilenceParams& params = {}, double now_s = 0.0) : params_(params), heard_s_(now_s) {}

  /// Call for each filter state; `dt_s`: since the previous one, 0: there is none.
  void heard(double now_s, double dt_s) {
    heard_s_ = now_s;
    if (!(dt_s > 0.0)) return;
    period_s_ = dt_s;
    shortest_s_ = std::min(shortest_s_, dt_s);
    ++periods_;
  }
  /// Call after publishing a message about a filter state or about silence.
  void published(double now_s) { published_s_ = now_s; }

  /// One line for the user, once the period is known: a sweep that waits for its deadline already counts as silence.
  /// Empty: it does not. `deadline_s`: fusion_ukf/deadline_s.
  std::optional<std::string> deadlineFault(double deadline_s) const {
    if (periods_ < kPeriods) return std::nullopt;
    const double limit_s = staleAfter_s(params_, shortest_s_);
    if (shortest_s_ + deadline_s < limit_s) return "";
    char text[300];
    std::snprintf(
        text, sizeof text,
        "fusion_ukf/deadline_s (%g s) plus the sweeps' period (%.2f s) reaches the silence limit (%.2f s, from "
        "fail_aware_monitor/stale_sweeps): a sweep that waits for a source until its deadline makes the state "
        "FAILED; lower deadline_s or raise stale_sweeps",
        deadline_s, shortest_s_, limit_s);
    return text;
  }

  double silence_s(double now_s) const { return now_s - heard_s_; }

  bool isDue(double now_s) {
    heard_s_ = std::min(heard_s_, now_s);
    published_s_ = std::min(published_s_, now_s);
    return silence_s(now_s) >= staleAfter_s(params_, period_s_) && now_s - published_s_ >= kRepeat_s - kEarly_s;
  }

 private:
  static constexpr double kEarly_s = 0.02;  ///< of a timer that beats at about half of kRepeat_s
  static constexpr int kPeriods = 10;       ///< the shortest of so many is a period without a dropped sweep

  SilenceParams params_;
  double heard_s_;
  double published_s_ = 0.0;
  double period_s_ = kUsualPeriod_s;  ///< of the filter states
  double shortest_s_ = kLongestPeriod_s;
  int periods_ = 0;
};

}  // namespace fail_aware
