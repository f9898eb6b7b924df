// A pose that is said from outside (set_pose): where base_link is in odom. Not in the paper.
//
// It is taken with the next estimate, moved there from its own stamp by the vehicle's motion (a stamp of 0: as if said
// of that estimate). A covariance that is all zero means known exactly.
// Refused, with a reason: no pose, no covariance (or one that is zero for the rotation only), a stamp more than a second
// away from the last sweep's, or from the estimate that it is to be taken with.
// Units m, rad, s; covariance in geometry/pose.hpp's convention. Cost: microseconds.
#pragma once

#include <optional>
#include <string>

#include "core/estimation/external_pose.hpp"
#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"

namespace fail_aware {

class PoseSetting {
 public:
  struct AtEstimate {
    Pose T_odom_cog = Pose::Identity();
    Matrix6d covariance = Matrix6d::Zero();
  };

  /// Why it is refused; empty: it waits for the next estimate. `last_stamp_s`: of the last sweep; none: there was none.
  std::string offer(const ExternalPose& pose, std::optional<double> last_stamp_s);

  bool pending() const { return pending_.has_value(); }
  void clear() { pending_.reset(); }

  /// Why what was offered cannot be taken with this estimate (it is forgotten then); empty: it can.
  std::string outdated(const FilterState& state);

  /// What was offered, at this estimate; it is used up.
  AtEstimate take(const FilterState& state, const Pose& T_base_cog);

 private:
  std::optional<ExternalPose> pending_;
};

}  // namespace fail_aware
