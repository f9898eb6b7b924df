// A pose of base_link in odom that is set from outside (set_pose). Not in the paper.
//
// The pose is applied at the next estimate, moved from its own stamp to the estimate's stamp by the vehicle's motion (a
// stamp of 0: that of the first estimate after the call). A covariance of zero means that the pose is exact.
// Refused, with a reason: no valid pose, no valid covariance (or one that is zero for the rotation only), a stamp more
// than a second away from the last sweep's stamp or from the stamp of the estimate that would apply it.
// Units m, rad, s; covariance in geometry/pose.hpp's convention. Cost: microseconds.
#pragma once

#include <optional>
#include <string>

#include "core/estimation/external_pose.hpp"
#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"

namespace fail_aware {

/// The outcome of a pose that was set, in one sweep.
struct PoseSet {
  bool done = false;    ///< odom was reset to the new pose
  std::string refused;  ///< the reason for a refusal; empty: it is done, it waits for a motion, or there was none
};

class PoseSetting {
 public:
  struct AtEstimate {
    Pose T_odom_cog = Pose::Identity();
    Matrix6d covariance = Matrix6d::Zero();
  };

  /// Returns why the pose is refused; empty: it waits for the next estimate. `last_stamp_s`: stamp of the last sweep;
  /// none: there was no sweep.
  std::string offer(const ExternalPose& pose, std::optional<double> last_stamp_s);

  bool pending() const { return pending_.has_value(); }
  /// The pose waits at an estimate that it cannot be applied to. Without a stamp of its own it gets the estimate's.
  void wait(double stamp_s) {
    if (pending_ && !stamp_s_) stamp_s_ = stamp_s;
  }
  /// The waiting pose is valid at this estimate as it is.
  bool isAt(const FilterState& state) const;
  void clear() { pending_.reset(); }

  /// Returns why the waiting pose cannot be applied at this estimate (it is then dropped); empty: it can.
  std::string outdated(const FilterState& state);

  /// Returns the waiting pose, moved to this estimate, and forgets it.
  AtEstimate take(const FilterState& state, const Pose& T_base_cog);

 private:
  std::optional<ExternalPose> pending_;
  std::optional<double> stamp_s_;  ///< of pending_; none: that of the next estimate
};

}  // namespace fail_aware
