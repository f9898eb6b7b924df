// Where the vehicle is, and how sure of it: filter, accumulated covariance, stamp order, poses from outside. One object
// for the live graph (FusionUkf) and the offline runner (OdometryPipeline).
//
// A sweep: accept() its stamp, predict(), measure outside, update(). In the live graph sweeps may wait between accept()
// and predict(), so accept() gives what predict() needs of the stamps.
// A new drive begins where stamps jump (stamp_order.hpp): odom continues at the last pose; the motion, the accumulated
// covariance and what waits from outside begin anew. reset() also puts base_link back to odom's origin.
// Units m, rad, s; covariances in geometry/pose.hpp's convention. Failure is data: StampOrder, PoseSet, FilterState.
// Cost: about 50 us a sweep.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/external_pose.hpp"
#include "core/estimation/odometry_covariance.hpp"
#include "core/estimation/pose_filter.hpp"
#include "core/estimation/pose_setting.hpp"
#include "core/estimation/stamp_order.hpp"
#include "core/estimation/sweep_clock.hpp"
#include "core/pipeline_parameters.hpp"
#include "core/types/pose_set.hpp"

namespace fail_aware {

/// The measurement of a source of poses with stamps of their own.
struct ExternalMeasurement {
  std::string source;
  std::optional<Measurement> measurement;  ///< none: no pose was near the sweep
};

class Estimator {
 public:
  struct Accepted {
    StampOrder order = StampOrder::kAdvances;
    double set_back_s = 0.0;  ///< SweepTime's, for predict()
    bool taken() const { return order == StampOrder::kAdvances || beginsDrive(); }
    /// A drive has begun with this stamp.
    bool beginsDrive() const { return order == StampOrder::kJumpedBack || order == StampOrder::kJumpedAhead; }
  };

  explicit Estimator(const PipelineParameters& params);

  Accepted accept(double stamp_s);
  /// Of a stamp, since the newest one that was taken; 0: there is none.
  double sinceNewest_s(double stamp_s) const;
  void setMaxReorder(double max_reorder_s) { stamps_.setMaxReorder(max_reorder_s); }

  /// False: the sweep's time is not after the last estimate's; nothing changes.
  bool predict(double stamp_s, double set_back_s, SweepPrediction& prediction);

  /// Closes the sweep that was predicted last. `middle_s`, `revolution_s`: SweepCorrectorReport's.
  const FilterState& update(const std::vector<FusionInput>& measurements, double middle_s, double revolution_s);

  /// A source of poses whose stamps are not the sweeps'. A pose farther than `tolerance_s` from a sweep is not used.
  void addSource(const std::string& name, double tolerance_s);
  /// Why the pose cannot be used; empty: it waits for its sweep.
  std::string offer(const std::string& source, const ExternalPose& pose);
  /// Of the last update(), in the sources' order by name.
  const std::vector<ExternalMeasurement>& externalMeasurements() const { return external_; }

  /// set_pose: why it is refused; empty: it waits for the next update().
  std::string setPose(const ExternalPose& pose) { return pose_setting_.offer(pose, newest_stamp_s_); }
  const PoseSet& poseSet() const { return pose_set_; }

  /// Everything anew; base_link is at odom's origin.
  void reset();

  /// The fusion's rules from the next sweep on. Throws ParameterError.
  void setFusion(const MeasurementFusion::Params& params) { filter_.setFusion(params); }

  const FilterState& state() const { return filter_.state(); }
  FilterState stateAsDriven() const { return filter_.stateAsDriven(); }
  /// Accumulated, of T_odom_cog; false of the other: the last increment was not finite and is not in it.
  const Matrix6d& odometryCovariance() const { return odometry_covariance_.covariance(); }
  bool covarianceIsWhole() const { return covariance_is_whole_; }
  const SweepClock& sweepClock() const { return clock_; }

 private:
  void beginDrive(const Pose& T_odom_cog);
  void takeSetPose(bool motion_known);

  Pose T_base_cog_;
  Matrix6d start_covariance_;  ///< no pose is known better: a covariance that is published is positive definite
  PoseFilter filter_;
  OdometryCovariance odometry_covariance_;
  SweepClock clock_;
  StampSequence stamps_;
  std::optional<double> newest_stamp_s_;
  SweepPrediction prediction_;
  PoseSetting pose_setting_;
  PoseSet pose_set_;
  std::map<std::string, ExternalPoseSource> sources_;
  std::vector<ExternalMeasurement> external_;
  bool covariance_is_whole_ = true;
};

}  // namespace fail_aware
