#include "core/initial_guess/estimate_track.hpp"

#include <cmath>

#include "core/stamp_difference.hpp"

namespace fail_aware {

EstimateTrack::Increment EstimateTrack::add(const FilterState& state) {
  const bool was_measured = measured_;
  measured_ = state.inMap() && state.measurement_applied;
  if (state.inMap()) {
    setPlaced(state.T_odom_cog);
  } else if (!tooManyUnplaced()) {
    unplaced_.push_back({state.dt_s, state.set_back_s});
  }
  speed_observed_ = state.measurement_applied && state.speed_error.variance_m2_s2 == 0.0;
  if (state.motion_status == MotionStatus::kUnknown) speed_was_observed_ = false;  // lost: it is searched for anew
  speed_was_observed_ = speed_was_observed_ || (speed_observed_ && state.dt_s > 0.0);
  speed_sigma_mps_ = std::sqrt(state.speed_error.variance_m2_s2);
  // if the clouds contradict the prediction, a long interval may be an undetected clock jump
  const bool clock_jump_suspected =
      state.clock_jump || (state.fusion.prediction_overruled && state.dt_s > kLongInterval_s);
  Increment increment;
  increment.between_measured = was_measured && measured_;
  if (increment.between_measured && !clock_jump_suspected && state.dt_s > 0.0) {
    increment.twist_cog = logSe3(state.T_previous_now) / state.dt_s;
  }
  if (state.inMap() && !clock_jump_suspected) placed_twist_cog_ = increment.twist_cog;
  return increment;
}

void EstimateTrack::beginAt(const FilterState& state) {
  measured_ = true;  // the first motion is measured from here
  setPlaced(state.T_odom_cog);
  if (!state.inMap()) placed_twist_cog_.reset();
}

void EstimateTrack::setPlaced(const Pose& T_odom_cog) {
  T_odom_cog_placed_ = T_odom_cog;
  unplaced_.clear();
}

}  // namespace fail_aware
