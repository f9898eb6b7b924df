// The noise of one prediction: the vehicle model's, and what is not known of the motion and of the interval. Not in the
// paper, whose Q is the model's alone.
//
// Over a long interval (kLongInterval_s) the driver may have done anything that a car can; the model's noise is that of
// consecutive sweeps. Roll and pitch stay close to the road: there P gains at most one step's noise, also over sweeps
// without a measurement. Accumulated, it would shorten the unscented mean of every step by cos(pitch), a tenth of the
// speed and more. During dead reckoning an error of the velocity persists from sweep to sweep: the filter's P grows by
// it, so that a registration that finds the right place again is within its gate.
// Failure: none. Cost: about 2 us.
#pragma once

#include "core/estimation/motion_tracker.hpp"
#include "core/estimation/vehicle/vehicle_model.hpp"
#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"

namespace fail_aware {

struct PredictionNoise {
  Matrix6d filter = Matrix6d::Zero();     ///< Q of the filter's step (state: x y z, roll pitch yaw)
  Matrix6d increment = Matrix6d::Zero();  ///< of the motion: with what the sigma points could not carry
};

struct PredictionInterval {
  double dt_s = 0.0;
  double sigma_s = 0.0;                  ///< of dt_s
  double yaw_rad = 0.0;                  ///< at its begin
  bool motion_known = false;             ///< SweepPrediction::motionKnown()
  double unknown_speed_sigma_mps = 0.0;  ///< where it is not known
};

/// `last`: the estimate that is predicted from, `motion`: how the vehicle moves then.
PredictionNoise predictionNoise(const VehicleModel& model, const MotionTracker& motion, const FilterState& last,
                                const PredictionInterval& interval);

}  // namespace fail_aware
