// Poses from elsewhere (GPS, visual odometry) that join the fusion: each has a stamp of its own, not a sweep's.
//
// The one nearest to the sweep's stamp within a tolerance is moved there by the vehicle's twist and becomes a
// measurement of the centre of gravity. Each is used for one sweep at most. Nothing waits for them.
// Inputs: base_link in odom; covariance in geometry/pose.hpp's convention (m, rad). A rotation block that is all zero
// means "rotation not measured". Failure is data: a pose that is not finite, whose covariance is not valid, or that
// is absurdly large (beyond 1e9 m, a variance above 1e12) has a reason.
// Cost: microseconds.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "core/geometry/pose.hpp"
#include "core/types/fusion_result.hpp"
#include "core/types/measurement.hpp"
#include "core/types/sweep_prediction.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// False: the rotation block is all zero.
bool rotationMeasured(const Matrix6d& covariance);

/// Why it cannot be used; empty if it can.
std::string unusableReason(const ExternalPose& pose);
/// The same of its covariance alone.
std::string unusableReason(const Matrix6d& covariance);

/// The centre of gravity at stamp_s, the vehicle moving on with this twist (m/s, rad/s; of the centre of gravity, in
/// its own axes); the motion between counts as known to a tenth of its length. A rotation that was not measured is
/// the predicted one, with a variance so large that it does not count.
Measurement externalMeasurement(const ExternalPose& pose, double stamp_s, const Pose& T_odom_cog_predicted,
                                const Vector6d& twist_cog, const Pose& T_base_cog);

/// A pose of an external source that the fusion did not use.
struct RefusedPose {
  std::string source;
  std::string why;  ///< one line for the user
};

/// Why the fusion did not use the measurement of an external source, one line for the user; empty: it was used, or was
/// absent, or too vague to count. `off`: its state less the predicted one.
std::string refusalOf(const FusionResult& fusion, std::size_t input, const Vector6d& off);

/// One source of such poses: its last few, by stamp; the oldest are dropped.
class ExternalPoseSource {
 public:
  explicit ExternalPoseSource(double tolerance_s = 0.1) : tolerance_s_(tolerance_s) {}

  /// Why the pose cannot be used; empty: it waits for its sweep. A stamp before the newest means that the source began
  /// anew: what came before is forgotten.
  std::string offer(const ExternalPose& pose);
  /// For a sweep; nothing if no pose is near it. The nearest and what is older are used up. While no motion is known
  /// there is nothing to move a pose with: it waits.
  std::optional<Measurement> measure(const SweepPrediction& prediction, const Pose& T_base_cog);
  void clear() {
    poses_.clear();
    offered_ = false;
    later_s_ = 0.0;
  }

  /// Why none of the poses that came since the sweep before can belong to a sweep, one line for the user: another
  /// clock. Of the last measure(); empty: one may, or none came.
  std::string timeFault() const;

  static constexpr std::size_t kKept = 100;

 private:
  std::optional<ExternalPose> takeNearest(double stamp_s);

  double tolerance_s_;
  std::deque<ExternalPose> poses_;
  bool offered_ = false;  ///< since the last measure()
  double later_s_ = 0.0;  ///< of the last measure(): stamp of the nearest pose, after the sweep's; 0: none came since
};

}  // namespace fail_aware
