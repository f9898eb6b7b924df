#include "core/estimation/prediction_noise.hpp"

#include <algorithm>
#include <cmath>

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kPersists_s = 0.5;
constexpr double kLeastTilt_rad = 1e-3;  // of a sweep's motion: a variance of 0 has no inverse

// What an error of the velocity adds to the position's variance in the long run, beyond that of independent errors, of
// which `kept` remains from sweep to sweep. The accumulated covariance allows for it by itself (drift_state.hpp).
double persistence(double kept, double dt_s) {
  const double most = std::max(1.0, kPersists_s / dt_s);
  return kept < 1.0 ? std::min(most, (1.0 + kept) / (1.0 - kept)) - 1.0 : most - 1.0;
}

}  // namespace

PredictionNoise predictionNoise(const VehicleModel& model, const MotionTracker& motion, const FilterState& last,
                                const PredictionInterval& interval) {
  const double dt_s = interval.dt_s;
  PredictionNoise noise;
  Matrix6d& Q = noise.filter;
  Q = model.processNoise(dt_s, interval.yaw_rad);
  const Eigen::Matrix3d R_odom_body = last.T_odom_cog.linear();
  const auto inOdom = [&](const Eigen::Matrix4d& increment) -> Eigen::Matrix3d {  // the position's covariance
    return R_odom_body * increment.topLeftCorner<3, 3>() * R_odom_body.transpose();
  };
  double uncertain_yaw = 0.0;
  Eigen::Matrix3d persistent = Eigen::Matrix3d::Zero();
  Matrix6d beyond = Matrix6d::Zero();
  if (!interval.motion_known) {
    const double sigma = interval.unknown_speed_sigma_mps * dt_s;  // of the distance along the road
    const Eigen::Vector2d forward(std::cos(interval.yaw_rad), std::sin(interval.yaw_rad));
    Q.topLeftCorner<2, 2>() += sigma * sigma * forward * forward.transpose();
  } else if (motion.deadReckoning().active()) {
    const Eigen::Matrix4d uncertain = motion.deadReckoning().incrementCovariance(dt_s);
    Q.topLeftCorner<3, 3>() += inOdom(uncertain);
    persistent = persistence(motion.deadReckoning().speedError().kept, dt_s) * inOdom(uncertain);
    uncertain_yaw = uncertain(3, 3);
  }
  if (interval.motion_known && interval.sigma_s > 0.0) {  // the distance is as uncertain as the interval
    const Eigen::Vector3d distance_m = R_odom_body * motion.motion().velocity_body_mps * interval.sigma_s;
    const double turn_rad = motion.motion().rpy_rates_rad_s.z() * interval.sigma_s;
    Q.topLeftCorner<3, 3>() += distance_m * distance_m.transpose();
    Q(5, 5) += turn_rad * turn_rad;
  }
  if (interval.motion_known && dt_s > kLongInterval_s) {
    const double speed_mps = motion.motion().velocity_body_mps.norm();
    const Eigen::Matrix4d driven = motion.deadReckoning().drivenCovariance(dt_s, last.dt_s, speed_mps);
    Q.topLeftCorner<3, 3>() += inOdom(driven);
    Q(5, 5) += driven(3, 3);
    const Eigen::Matrix4d later = motion.deadReckoning().drivenLaterCovariance(dt_s, speed_mps);
    beyond.topLeftCorner<3, 3>() = inOdom(later);
    beyond(5, 5) = later(3, 3);
  }
  if (dt_s > kLongInterval_s) {
    const Matrix6d one_step = model.processNoise(kUsualPeriod_s, interval.yaw_rad);
    for (int i = 3; i < 5; ++i) Q(i, i) = std::min(Q(i, i), one_step(i, i));
  }
  if (!last.measurement_applied) {
    for (int i = 3; i < 5; ++i) Q(i, i) = std::max(0.0, Q(i, i) - last.covariance(i, i));
  }
  noise.increment = Q + beyond;
  Q.topLeftCorner<3, 3>() += persistent;
  for (int i = 3; i < 5; ++i) noise.increment(i, i) = std::max(noise.increment(i, i), kLeastTilt_rad * kLeastTilt_rad);
  noise.increment(5, 5) += uncertain_yaw;  // in Q it would shorten the unscented mean of every step
  return noise;
}

}  // namespace fail_aware
