// A sweep as the two ICPs register it: its thinned clouds, and the motion that they are deskewed for.
//
// The builder corrects the points by the estimated errors of the beams (beam_bias_estimator.hpp). The deskew motion of
// a compensated sweep (sensor.timing.source none) is unknown.
// Frames: the centre of gravity's.
// Failure: `usable` is false. Cost: that of registration_cloud.hpp and beam_bias_estimator.hpp.
#pragma once

#include "core/preprocessing/registration_cloud.hpp"
#include "core/registration/beam_bias_estimator.hpp"
#include "core/types/corrected_sweep.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

struct RegistrationScan {
  RegistrationCloud cloud;
  Pose T_cog_lidar = Pose::Identity();
  /// The motion that the cloud is deskewed for (compensated: the predicted motion), m/s and rad/s.
  Vector6d twist_cog = Vector6d::Zero();
  bool usable = false;  ///< false: too few points in range, the sweep cannot be registered

  /// Deskews the cloud for another motion. Points measured at still_s (relative to the stamp) do not move.
  void redeskewTo(const Vector6d& other_twist_cog, double still_s);
};

class RegistrationScanBuilder {
 public:
  RegistrationScanBuilder(const RegistrationCloudBuilder& builder, const BeamBiasEstimator& beam_bias_estimator)
      : builder_(builder), beam_bias_estimator_(beam_bias_estimator) {}

  /// Builds the scan, deskewed for the prediction. `scan` is reused.
  void build(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar,
             RegistrationScan& scan);

  /// Updates the errors of the beams from a scan at its estimate, before the scan is inserted.
  void observeBeams(const RegistrationScan& scan, const VoxelMap& map, const Pose& T_odom_cog);

  void reset() { beam_bias_estimator_.reset(); }

 private:
  RegistrationCloudBuilder builder_;
  BeamBiasEstimator beam_bias_estimator_;
};

}  // namespace fail_aware
