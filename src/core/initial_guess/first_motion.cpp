#include "core/initial_guess/first_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/registration/measurement_update.hpp"

namespace fail_aware {

void addSearchedMotion(const InitialGuess& guess, Measurement& measurement) {
  if (!(guess.searched_sigma_m > 0.0) || !measurement.ok()) return;
  for (const Eigen::Vector3d axis : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}) {
    const double offset_m = axis.dot(guess.T_odom_cog.translation() - measurement.T_odom_cog.translation());
    addPosition(axis, offset_m, guess.searched_sigma_m, measurement);
  }
}

void inflateAlongTrack(const InitialGuess& guess, const MotionInitialization::Params& params,
                       Measurement& measurement) {
  if (!measurement.ok() || !(guess.dt_s > 0.0)) return;
  const Eigen::Vector3d forward = guess.T_odom_cog_previous.linear().col(0);
  const double distance_m = forward.dot(measurement.T_odom_cog.translation() - guess.T_odom_cog_previous.translation());
  if (std::abs(distance_m) > params.standstill_m || measurement.min_information_ratio > params.standstill_ratio) return;
  const double sigma_m = params.max_speed_mps * guess.dt_s;
  measurement.covariance.topLeftCorner<3, 3>() += sigma_m * sigma_m * forward * forward.transpose();
  measurement.degenerate_directions = std::min(measurement.degenerate_directions + 1, 6);
  measurement.min_information_ratio = 0.0;
}

}  // namespace fail_aware
