#include "core/initial_guess/first_motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.hpp"
#include "core/registration/normal_equations.hpp"

namespace fail_aware {

namespace {

// In place of standstill_ratio where nearly all meets at standstill. A tunnel without a niche has up to 0.04, and all
// of it meets at standstill, too.
constexpr double kSureRatio = 0.06;

// A Kalman update: along `axis` (of length 1, in odom) the true position differs from the measured one by `offset_m`,
// with standard deviation `sigma_m`.
void addPosition(const Eigen::Vector3d& axis, double offset_m, double sigma_m, Measurement& measurement) {
  Vector6d along = Vector6d::Zero();
  along.head<3>() = axis;
  const Vector6d C_along = measurement.covariance * along;
  const Vector6d gain = C_along / (along.dot(C_along) + sigma_m * sigma_m);
  measurement.T_odom_cog = applyStep(measurement.T_odom_cog, gain * offset_m);
  measurement.covariance = symmetric(measurement.covariance - gain * C_along.transpose());
}

void inflateAlong(const Eigen::Vector3d& axis, double sigma_m, Measurement& measurement) {
  measurement.covariance.topLeftCorner<3, 3>() += sigma_m * sigma_m * axis * axis.transpose();
}

}  // namespace

void addSearchedMotion(const InitialGuess& guess, Measurement& measurement) {
  if (!(guess.searched_sigma_m > 0.0) || !measurement.ok()) return;
  for (const Eigen::Vector3d axis : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}) {
    const double offset_m = axis.dot(guess.T_odom_cog.translation() - measurement.T_odom_cog.translation());
    addPosition(axis, offset_m, guess.searched_sigma_m, measurement);
  }
}

void addDriveOff(const InitialGuess& guess, const MotionInitialization::Params& params, Measurement& measurement) {
  if (!guess.start || !measurement.ok() || measurement.min_information_ratio > params.standstill_ratio) return;
  const Eigen::Vector3d forward = guess.T_odom_cog_previous.linear().col(0);
  const double offset_m = forward.dot(guess.T_odom_cog.translation() - measurement.T_odom_cog.translation());
  const double sigma_m = guess.start->sigma_m;
  const bool found = guess.start->distance_m.has_value();
  const double wrong_m = found ? std::max(0.0, std::abs(offset_m) - sigma_m) : sigma_m;
  inflateAlong(forward, wrong_m, measurement);
  if (found) addPosition(forward, offset_m, sigma_m, measurement);
}

void inflateAlongTrack(const InitialGuess& guess, const MotionInitialization::Params& params,
                       Measurement& measurement) {
  if (!measurement.ok() || !(guess.dt_s > 0.0)) return;
  const bool little_informs = measurement.min_information_ratio <= kSureRatio;
  if (guess.start && !(guess.start->distance_m == 0.0 && little_informs)) return;
  const Eigen::Vector3d forward = guess.T_odom_cog_previous.linear().col(0);
  const double distance_m = forward.dot(measurement.T_odom_cog.translation() - guess.T_odom_cog_previous.translation());
  if (std::abs(distance_m) > params.standstill_m || measurement.min_information_ratio > params.standstill_ratio) return;
  inflateAlong(forward, params.max_speed_mps * guess.dt_s, measurement);
  measurement.degenerate_directions = std::min(measurement.degenerate_directions + 1, 6);
  measurement.min_information_ratio = 0.0;
}

}  // namespace fail_aware
