// The filter of the article's figure "UKF architecture" as one object: derivatives of past estimates -> vehicle model
// -> UKF prediction -> fusion of a sweep's measurements -> UKF correction. What the FusionUkf nodelet holds.
//
// predict(stamp) and correct(...) are called once a sweep, in this order. All poses are of the centre of gravity in
// odom. Until a motion is known (`SweepPrediction::motionKnown`), P along the road is as wide as the speed is unknown.
// Where a sweep is not measured, roll and pitch gain no more than one step's process noise.
// After lost sweeps (an interval above kLongInterval_s) P grows by what the driver may have done meanwhile, so that search
// and gate reach as far (DeadReckoning::drivenCovariance).
// A drive begins at the first sweep that has points to register: until then the next sweep is the first again.
// Failure: a stamp that does not advance -> predict() says so and changes nothing. Without a usable measurement the
// estimate is the prediction, flagged. Cost: about 50 us a sweep.
#pragma once

#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/core/filter/dead_reckoning.hpp"
#include "fail_aware_lidar_odometry/core/filter/increment_covariance.hpp"
#include "fail_aware_lidar_odometry/core/filter/map_update_policy.hpp"
#include "fail_aware_lidar_odometry/core/filter/consistency_monitor.hpp"
#include "fail_aware_lidar_odometry/core/filter/motion_tracker.hpp"
#include "fail_aware_lidar_odometry/core/filter/ukf.hpp"
#include "fail_aware_lidar_odometry/core/fusion/measurement_fusion.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/core/types/fusion_input.hpp"
#include "fail_aware_lidar_odometry/core/types/odometry_increment.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_prediction.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_time.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/motion_derivatives.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/road_plane.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/vehicle_model.hpp"

namespace fail_aware {

class PoseFilter {
 public:
  struct Params {
    /// sigma of the speed until a motion is known: a third of a car's top speed
    double initial_speed_sigma_mps = 15.0;
    double initial_sigma_m = 1e-3;           ///< sigma of the start position: odom begins there by definition
    double initial_sigma_deg = 0.01;         ///< sigma of the start attitude
    double max_speed_mps = 80.0;             ///< larger speeds are cut to this: no car on a road is faster
    double max_yaw_rate_rps = 3.0;           ///< larger yaw rates are cut to this: half a turn a second
    double increment_scale = 0.43;           ///< on the covariance that one sweep adds to the odometry
    double dead_reckoning_increment_factor = 6.8;  ///< on that, where the filter coasts: what observes little misleads, too
    double increment_floor_m = 0.0005;       ///< standard deviation a sweep, at least, and per metre driven:
    double increment_per_metre_m = 0.0;
    double increment_floor_deg = 0.012;
    ConsistencyMonitor::Params consistency;
    DeadReckoning::Params dead_reckoning;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("increment_scale", self.increment_scale);
      v("dead_reckoning_increment_factor", self.dead_reckoning_increment_factor);
      v("increment_floor_m", self.increment_floor_m);
      v("increment_per_metre_m", self.increment_per_metre_m);
      v("increment_floor_deg", self.increment_floor_deg);
      v("consistency", self.consistency);
      v("dead_reckoning", self.dead_reckoning);
    }
    void validate() const;
  };

  PoseFilter(const Params& params, const Ukf::Params& ukf, const VehicleModel& model,
             const MotionHistory::Params& history, const RoadPlaneEstimator::Params& road,
             const MeasurementFusion::Params& fusion);

  /// Starts anew: the next sweep's pose is T_odom_cog.
  void reset(const Pose& T_odom_cog);

  /// False if the sweep's time is not after the last estimate's.
  bool predict(const SweepTime& time, SweepPrediction& prediction);

  /// Closes the sweep that was predicted last.
  /// `middle_s`: SweepCorrectorReport's.
  const FilterState& correct(const std::vector<FusionInput>& measurements, double middle_s = 0.0);

  /// Says from outside where the vehicle was at the last estimate: odom is moved under the vehicle. Motion, increments
  /// and P (about the vehicle) stay; odom_reset_count counts on. A pose that is not finite: false, nothing changes.
  bool setPose(const Pose& T_odom_cog);

  /// The fusion's rules from the next sweep on. Throws ParameterError.
  void setFusion(const MeasurementFusion::Params& params) { fusion_ = MeasurementFusion(params); }

  const FilterState& state() const { return state_; }

  /// With the motion that a vehicle can follow: where the stamps told another interval than was driven, the way between
  /// two estimates may be one back over all that the prediction was off by. There it is the way of the motion that
  /// the filter keeps, in a dt that is kLongInterval_s at most. Before any motion was measured dt is 0: there is none.
  FilterState stateAsDriven() const;

  bool started() const { return started_; }

 private:
  bool doubtPrediction(std::vector<FusionInput>& inputs);
  MotionStatus motionStatus() const;
  bool addInflation(const std::vector<FusionInput>& inputs, const Vector6d& innovation, FilterState& state);

  Params params_;
  VehicleModel model_;
  Ukf ukf_;
  MeasurementFusion fusion_;
  MotionTracker motion_;
  ConsistencyMonitor consistency_;
  MapUpdatePolicy map_update_policy_;
  SweepPrediction prediction_;
  FilterState state_;
  Matrix6d process_noise_ = Matrix6d::Identity();  ///< Q of the last prediction
  double interval_sigma_s_ = 0.0;                  ///< SweepTime's, of the last prediction
  bool started_ = false;
  int corrected_sweeps_ = 0;
};

}  // namespace fail_aware
