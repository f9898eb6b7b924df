// Estimates the vehicle's pose and its covariance: filter, accumulated covariance, stamp order, external poses. The
// live graph (FusionUkf) and the offline runner (OdometryPipeline) use the same class.
//
// Per sweep: accept() the stamp, predict(), measure outside, update(). In the live graph sweeps may wait between
// accept() and predict(), so accept() returns what predict() needs to know about the stamps.
// A new drive begins when stamps jump (stamp_order.hpp): odom continues at the last pose; the motion, the accumulated
// covariance and the pending external poses are reset. reset() also moves base_link back to odom's origin.
// Units m, rad, s; covariances in geometry/pose.hpp's convention. Failure is data: StampOrder, PoseSet, FilterState.
// Cost: about 50 us a sweep.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/external_pose.hpp"
#include "core/estimation/odometry_covariance.hpp"
#include "core/estimation/pose_filter.hpp"
#include "core/estimation/pose_setting.hpp"
#include "core/estimation/stamp_order.hpp"
#include "core/estimation/sweep_clock.hpp"
#include "core/pipeline_parameters.hpp"

namespace fail_aware {

/// The measurement of a source of poses that have their own stamps.
struct ExternalMeasurement {
  std::string source;
  std::optional<Measurement> measurement;  ///< none: no pose was close enough in time to the sweep
};

class Estimator {
 public:
  struct Accepted {
    StampOrder order = StampOrder::kAdvances;
    double set_back_s = 0.0;  ///< SweepTime::set_back_s, for predict()
    bool taken() const { return order == StampOrder::kAdvances || beginsDrive(); }
    /// This stamp begins a new drive.
    bool beginsDrive() const { return fail_aware::beginsDrive(order); }
  };

  explicit Estimator(const PipelineParameters& params);

  Accepted accept(double stamp_s);
  /// Time from the newest accepted stamp to `stamp_s`; 0: no stamp was accepted yet.
  double sinceNewest_s(double stamp_s) const;
  void setMaxReorder(double max_reorder_s) { stamps_.setMaxReorder(max_reorder_s); }

  /// False if the sweep's time is not after the last estimate's; then the estimate stays.
  bool predict(double stamp_s, double set_back_s, SweepPrediction& prediction);

  /// Finishes the sweep of the last predict().
  const FilterState& update(const std::vector<FusionInput>& measurements, const SweepFindings& findings);

  /// Adds a source of poses whose stamps differ from the sweeps'. A pose is used within `tolerance_s` of a sweep.
  void addSource(const std::string& name, double tolerance_s);
  /// Returns why the pose cannot be used; empty: the pose waits for its sweep.
  std::string offer(const std::string& source, const ExternalPose& pose);
  /// From the last update(), ordered by source name.
  const std::vector<ExternalMeasurement>& externalMeasurements() const { return external_; }
  /// From the last update(): of these sources, and of external sources among its measurements.
  const std::vector<RefusedPose>& refusedPoses() const { return refused_; }

  /// set_pose: returns why the pose is refused; empty: the pose waits for the next update().
  std::string setPose(const ExternalPose& pose) { return pose_setting_.offer(pose, newest_stamp_s_); }
  /// The outcome of the pose that waited, once.
  PoseSet takePoseSet() { return std::exchange(pose_set_, PoseSet()); }

  /// Resets everything; base_link is at odom's origin.
  void reset();

  void setFusion(const MeasurementFusion& params) { filter_.setFusion(params); }

  const FilterState& state() const { return filter_.state(); }
  FilterState stateAsDriven() const { return filter_.stateAsDriven(); }
  /// The accumulated covariance of T_odom_cog. covarianceIsWhole() is false if the last increment was not finite and is
  /// therefore missing from the covariance.
  const Matrix6d& odometryCovariance() const { return odometry_covariance_.covariance(); }
  bool covarianceIsWhole() const { return covariance_is_whole_; }
  const SweepClock& sweepClock() const { return clock_; }

 private:
  void beginDrive(const Pose& T_odom_cog);
  void noteRefused(const std::vector<FusionInput>& inputs);
  void takeSetPose(bool motion_known);

  Pose T_base_cog_;
  Matrix6d start_covariance_;  ///< lower bound of any pose's covariance: a published covariance is positive definite
  PoseFilter filter_;
  OdometryCovariance odometry_covariance_;
  SweepClock clock_;
  StampSequence stamps_;
  std::optional<double> newest_stamp_s_;
  PoseSetting pose_setting_;
  PoseSet pose_set_;
  std::map<std::string, ExternalPoseSource> sources_;
  std::vector<ExternalMeasurement> external_;
  std::vector<RefusedPose> refused_;
  bool covariance_is_whole_ = true;
};

}  // namespace fail_aware
