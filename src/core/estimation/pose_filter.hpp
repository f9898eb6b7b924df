// The filter of the paper's figure "UKF architecture" as one object: derivatives of past estimates -> vehicle model
// -> UKF prediction -> fusion of a sweep's measurements -> UKF correction. The FusionUkf nodelet holds one.
//
// Call predict(stamp) and correct(...) once a sweep, in this order. All poses are of the centre of gravity in odom.
// Until a motion is known (`SweepPrediction::motionKnown`), P along the road contains the speed's uncertainty.
// In a sweep without a measurement roll and pitch gain at most one step's process noise.
// After lost sweeps (an interval above kLongInterval_s) P grows by what the driver may have done meanwhile, so that the
// search and the gate are wide enough (DeadReckoning::drivenCovariance).
// A drive begins at the first sweep that has points to register; until then every sweep counts as the first.
// Failure: if the stamp does not advance, predict() returns false and changes nothing. Without a usable measurement the
// estimate is the prediction, and the state says so. Cost: about 50 us a sweep.
#pragma once

#include <vector>

#include "core/estimation/consistency_monitor.hpp"
#include "core/estimation/dead_reckoning.hpp"
#include "core/estimation/first_motion_watch.hpp"
#include "core/estimation/map_update_policy.hpp"
#include "core/estimation/measurement_fusion.hpp"
#include "core/estimation/motion_tracker.hpp"
#include "core/estimation/ukf.hpp"
#include "core/estimation/vehicle/motion_derivatives.hpp"
#include "core/estimation/vehicle/vehicle_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/fusion_input.hpp"
#include "core/types/sweep_findings.hpp"
#include "core/types/sweep_prediction.hpp"
#include "core/types/sweep_time.hpp"

namespace fail_aware {

class PoseFilter {
 public:
  struct Params {
    /// sigma of the speed until a motion is known: a third of a car's top speed
    double initial_speed_sigma_mps = 15.0;
    double initial_sigma_m = 1e-3;    ///< sigma of the start position: odom begins there by definition
    double initial_sigma_deg = 0.01;  ///< sigma of the start attitude
    double increment_scale = 0.43;    ///< scales the covariances of one sweep's increment and registration
    /// factor on both during dead reckoning: weakly observed measurements also mislead
    double dead_reckoning_increment_factor = 3.0;
    double increment_floor_m = 0.0005;   ///< least standard deviation of a sweep's increment
    double increment_per_metre_m = 0.0;  ///< added to it per metre driven
    double increment_floor_deg = 0.012;  ///< least standard deviation of a sweep's rotation
    ConsistencyMonitor::Params consistency;
    DeadReckoning::Params dead_reckoning;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("increment_scale", self.increment_scale, requirePositive);
      v("dead_reckoning_increment_factor", self.dead_reckoning_increment_factor, requirePositive);
      v("increment_floor_m", self.increment_floor_m, requireNotNegative);
      v("increment_per_metre_m", self.increment_per_metre_m, requireNotNegative);
      v("increment_floor_deg", self.increment_floor_deg, requireNotNegative);
      v("consistency", self.consistency);
      v("dead_reckoning", self.dead_reckoning);
    }
  };

  PoseFilter(const Params& params, const VehicleModel& model, const MotionHistory::Params& history,
             const MeasurementFusion& fusion);

  /// Restarts the filter; the next sweep's pose is T_odom_cog.
  void reset(const Pose& T_odom_cog);

  /// False if the sweep's time is not after the last estimate's.
  bool predict(const SweepTime& time, SweepPrediction& prediction);

  /// Finishes the sweep of the last predict().
  const FilterState& correct(const std::vector<FusionInput>& measurements, const SweepFindings& findings = {});

  /// Sets the vehicle's pose at the last estimate from outside: odom is moved under the vehicle. Motion, increments and
  /// P (about the vehicle) stay; odom_reset_count increases. A pose that is not finite: returns false, nothing changes.
  bool setPose(const Pose& T_odom_cog);

  /// The fusion's parameters, used from the next sweep on.
  void setFusion(const MeasurementFusion& params) { fusion_ = params; }

  /// Of the last predict() that returned true.
  const SweepPrediction& prediction() const { return prediction_; }
  const FilterState& state() const { return state_; }

  /// The state with a motion that a vehicle can follow. After a clock jump the increment between two estimates may undo
  /// the whole error of the prediction, backwards included. This state then holds the increment of the filter's
  /// velocity instead, over a dt of at most kLongInterval_s. dt is 0 before any motion was measured.
  FilterState stateAsDriven() const;

 private:
  FusionResult correctPrediction(const std::vector<FusionInput>& inputs);
  bool doubtPrediction(std::vector<FusionInput>& inputs);
  MotionStatus motionStatus() const;
  Vector6d applyMeasurements(std::vector<FusionInput>& inputs, FilterState& next);
  ConsistencyMonitor::Inflation judgeIncrement(const std::vector<FusionInput>& inputs, const Vector6d& innovation,
                                               FilterState& next);
  void trackMotion(double middle_s, bool map_begins);
  MapUpdatePolicy::Sweep sweepForMap(const FilterState& state, bool observes_tilt) const;
  void loseMotion();
  ConsistencyMonitor::Inflation addInflation(const std::vector<FusionInput>& inputs, const Vector6d& innovation,
                                             FilterState& state);

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
  double interval_sigma_s_ = 0.0;                  ///< SweepTime::interval_sigma_s of the last prediction
  bool started_ = false;
  FirstMotionWatch first_motion_;
};

}  // namespace fail_aware
