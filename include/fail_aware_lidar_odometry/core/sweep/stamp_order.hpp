// How a sweep's stamp stands to the newest one's: the one rule of the live graph and of the offline runner.
//
// A stamp that does not advance is refused; one that lies further back than what gets out of order on the way means
// that the clock was set back, or that a recording begins again: there a drive begins. A difference that is no number
// is refused.
#pragma once

namespace fail_aware {

inline constexpr double kMaxReorder_s = 0.5;

enum class StampOrder { kAdvances, kSame, kReordered, kJumpedBack };

inline StampOrder stampOrder(double since_newest_s, double max_reorder_s = kMaxReorder_s) {
  if (since_newest_s > 0.0) return StampOrder::kAdvances;
  if (since_newest_s < -max_reorder_s) return StampOrder::kJumpedBack;
  return since_newest_s == 0.0 ? StampOrder::kSame : StampOrder::kReordered;
}

}  // namespace fail_aware
