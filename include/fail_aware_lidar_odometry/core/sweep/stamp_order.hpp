// How a sweep's stamp stands to the newest one's: the one rule of the live graph and of the offline runner.
//
// A stamp that does not advance is refused; one that lies further back than what gets out of order on the way means
// that the clock was set back, or that a recording begins again: there a drive begins. One that is far ahead is refused,
// as a single wrong one would end the drive; if the next one follows on it the clock was set, and a drive begins. Far is
// an hour: what is missing for less is bridged by the model, whose covariance says what that is worth. A difference that is no number is refused.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

namespace fail_aware {

inline constexpr double kMaxReorder_s = 0.5;
inline constexpr double kFarAhead_s = 3600.0;

enum class StampOrder { kAdvances, kSame, kReordered, kJumpedBack, kFarAhead, kJumpedAhead };

class StampSequence {
 public:
  void setMaxReorder(double max_reorder_s) { max_reorder_s_ = max_reorder_s; }

  /// The next stamp, `since_newest_s` after the newest one that was taken (kAdvances, or the first of a drive).
  StampOrder next(double since_newest_s) {
    const double far_ahead_s = std::exchange(far_ahead_s_, kNone);
    if (since_newest_s > kFarAhead_s) {
      const double since_far_ahead_s = since_newest_s - far_ahead_s;
      if (since_far_ahead_s > 0.0 && since_far_ahead_s <= kFarAhead_s) return StampOrder::kJumpedAhead;
      far_ahead_s_ = since_newest_s;
      return StampOrder::kFarAhead;
    }
    if (since_newest_s > 0.0) {
      set_back_s_ = std::exchange(refused_back_s_, 0.0);
      return StampOrder::kAdvances;
    }
    if (since_newest_s < -max_reorder_s_) return StampOrder::kJumpedBack;
    if (since_newest_s == 0.0) return StampOrder::kSame;
    if (since_newest_s < 0.0) refused_back_s_ = std::max(refused_back_s_, -since_newest_s);
    return StampOrder::kReordered;
  }

  /// By how much at most the stamps were out of order that were refused before the newest one that was taken; 0: none
  /// was. It tells a clock that was set back a little.
  double setBack_s() const { return set_back_s_; }

  void beginDrive() {
    far_ahead_s_ = kNone;
    set_back_s_ = refused_back_s_ = 0.0;
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double max_reorder_s_ = kMaxReorder_s;
  double far_ahead_s_ = kNone;  ///< since the newest one: the last stamp, if it was refused as that
  double set_back_s_ = 0.0;
  double refused_back_s_ = 0.0;  ///< since then
};

}  // namespace fail_aware
