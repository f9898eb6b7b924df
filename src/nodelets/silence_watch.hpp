// Is the silence of the filter states long enough to be a failure (core/fail_aware/silence.hpp), and is it time to say so
// (again)? Times: s of one clock, which may jump back where simulated time begins anew: silence then counts from there.
// No failure modes.
#pragma once

#include <algorithm>

#include "fail_aware_lidar_odometry/core/fail_aware/silence.hpp"
#include "fail_aware_lidar_odometry/core/stamp_difference.hpp"

namespace fail_aware {

class SilenceWatch {
 public:
  static constexpr double kRepeat_s = 0.1;  ///< from one message to the next, while the silence lasts

  /// Silence counts from now on.
  explicit SilenceWatch(const SilenceParams& params = {}, double now_s = 0.0) : params_(params), heard_s_(now_s) {}

  /// A filter state; `dt_s`: since the one before, 0: there is none.
  void heard(double now_s, double dt_s) {
    heard_s_ = now_s;
    if (dt_s > 0.0) period_s_ = dt_s;
  }
  /// A message has been published, about a filter state or about silence.
  void published(double now_s) { published_s_ = now_s; }

  double silence_s(double now_s) const { return now_s - heard_s_; }

  bool isDue(double now_s) {
    heard_s_ = std::min(heard_s_, now_s);
    published_s_ = std::min(published_s_, now_s);
    return silence_s(now_s) >= staleAfter_s(params_, period_s_) && now_s - published_s_ >= kRepeat_s;
  }

 private:
  SilenceParams params_;
  double heard_s_;
  double published_s_ = 0.0;
  double period_s_ = kUsualPeriod_s;  ///< of the filter states
};

}  // namespace fail_aware
