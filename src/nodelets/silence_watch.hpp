// Decides whether the silence of the filter states is a failure (core/integrity/silence.hpp) and whether a message
// about it is due. Times: s of one clock. The clock may jump back when simulated time restarts; silence then counts
// from there.
#pragma once

#include <algorithm>

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
    if (dt_s > 0.0) period_s_ = dt_s;
  }
  /// Call after publishing a message about a filter state or about silence.
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
