// Classifies a sweep's stamp relative to the newest stamp. The live graph and the offline runner use this one rule.
//
// A stamp that does not advance is refused. So is a stamp that is far off: a single wrong stamp must not end the drive.
// If the next stamp follows it, the clock was set, or a recording restarts: a new drive begins. Far back is further
// than messages get out of order in transit. Far ahead is one hour: for a shorter gap the vehicle model predicts, and
// its covariance shows how good that is. A difference that is NaN is refused.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

namespace fail_aware {

inline constexpr double kMaxReorder_s = 0.5;
inline constexpr double kFarAhead_s = 3600.0;

enum class StampOrder { kAdvances, kSame, kReordered, kFarBack, kJumpedBack, kFarAhead, kJumpedAhead };

constexpr bool beginsDrive(StampOrder order) {
  return order == StampOrder::kJumpedBack || order == StampOrder::kJumpedAhead;
}

class StampSequence {
 public:
  void setMaxReorder(double max_reorder_s) { max_reorder_s_ = max_reorder_s; }

  /// Classifies the next stamp, `since_newest_s` after the newest accepted one (kAdvances, or the first of a drive).
  StampOrder next(double since_newest_s) {
    const double since_far_s = since_newest_s - std::exchange(far_s_, kNone);
    const bool far_ahead = since_newest_s > kFarAhead_s, far_back = since_newest_s < -max_reorder_s_;
    if (far_ahead || far_back) {
      const bool follows = since_far_s > 0.0 && since_far_s <= kFarAhead_s;
      if (follows) return far_ahead ? StampOrder::kJumpedAhead : StampOrder::kJumpedBack;
      far_s_ = since_newest_s;
      return far_ahead ? StampOrder::kFarAhead : StampOrder::kFarBack;
    }
    if (since_newest_s > 0.0) {
      const double back_s = std::exchange(refused_back_s_, 0.0);
      set_back_s_ = std::exchange(last_back_s_, back_s) > 0.0 ? 0.0 : back_s;
      return StampOrder::kAdvances;
    }
    if (since_newest_s <= 0.0) refused_back_s_ = std::max({refused_back_s_, -since_newest_s, kLeastBack_s});
    return since_newest_s == 0.0 ? StampOrder::kSame : StampOrder::kReordered;
  }

  /// The largest step back among the stamps refused before the newest accepted one; 0: none was refused. It reveals a
  /// clock that was set back a little. The same stamp again counts as a step of kLeastBack_s: a clock that is set back
  /// by a period. No clock is set back before each sweep, so a refusal right after another one counts as none: such a
  /// driver sends its clouds twice, or in the wrong order.
  double setBack_s() const { return set_back_s_; }

  void beginDrive() {
    far_s_ = kNone;
    set_back_s_ = refused_back_s_ = last_back_s_ = 0.0;
  }

 private:
  static constexpr double kLeastBack_s = 1e-6;
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double max_reorder_s_ = kMaxReorder_s;
  double far_s_ = kNone;  ///< the last stamp relative to the newest one, if it was refused as far off
  double set_back_s_ = 0.0;
  double refused_back_s_ = 0.0;  ///< since the newest accepted stamp
  double last_back_s_ = 0.0;     ///< before the newest accepted stamp
};

}  // namespace fail_aware
