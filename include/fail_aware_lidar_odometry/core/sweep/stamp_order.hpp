// How a sweep's stamp stands to the newest one's: the one rule of the live graph and of the offline runner.
//
// A stamp that does not advance is refused; one that lies further back than what gets out of order on the way means
// that the clock was set back, or that a recording begins again: there a drive begins. One that is far ahead is refused,
// as a single wrong one would end the drive; if the next one follows on it the clock was set, and a drive begins. Far is
// an hour: what is missing for less is bridged by the model, whose covariance says what that is worth. A difference that is no number is refused.
#pragma once

#include <algorithm>
#include <limits>

namespace fail_aware {

inline constexpr double kMaxReorder_s = 0.5;
inline constexpr double kFarAhead_s = 3600.0;

enum class StampOrder { kAdvances, kSame, kReordered, kJumpedBack, kFarAhead, kJumpedAhead };

/// `since_far_ahead_s`: since the last stamp, if that was refused as far ahead; otherwise no number.
inline StampOrder stampOrder(double since_newest_s, double max_reorder_s = kMaxReorder_s,
                             double since_far_ahead_s = std::numeric_limits<double>::quiet_NaN()) {
  if (since_newest_s > kFarAhead_s) {
    const bool confirmed = since_far_ahead_s > 0.0 && since_far_ahead_s <= kFarAhead_s;
    return confirmed ? StampOrder::kJumpedAhead : StampOrder::kFarAhead;
  }
  if (since_newest_s > 0.0) return StampOrder::kAdvances;
  if (since_newest_s < -max_reorder_s) return StampOrder::kJumpedBack;
  return since_newest_s == 0.0 ? StampOrder::kSame : StampOrder::kReordered;
}

/// By how much the stamps were refused that came before a sweep: it tells a clock that was set back a little.
class SetBack {
 public:
  void refused(StampOrder order, double since_newest_s) {
    if (order == StampOrder::kReordered && since_newest_s < 0.0) most_s_ = std::max(most_s_, -since_newest_s);
  }
  /// Of the sweep that is taken now; 0: none was refused.
  double take_s() {
    const double most_s = most_s_;
    most_s_ = 0.0;
    return most_s;
  }

 private:
  double most_s_ = 0.0;
};

}  // namespace fail_aware
