#include "core/estimation/dead_reckoning.hpp"

#include <cmath>
#include <limits>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kLongestDriven_s = 3.0;
constexpr double kWidestDriven_rad = 0.25;
// Gaps of 8 and 12 s on eight simulated country roads: errors of 7 to 57 m and of 28 to 120 m.
constexpr double kTurnedInAGap_rad = 0.4;
constexpr double kCrawl_mps = 0.5;

/// The largest sigma of a measurement that corrects the motion. None over a gap: even an uncertain mean is nearer to
/// the motion at its end than what the motion before it becomes with a constant acceleration.
double largestSigma(double of_one_sweep, double dt_s) {
  return dt_s > kLongInterval_s ? std::numeric_limits<double>::max() : of_one_sweep;
}

Eigen::Matrix4d fromSigmas(double along_m, double across_m, double yaw_rad) {
  return Eigen::Vector4d(along_m, across_m, 0.0, yaw_rad).cwiseAbs2().asDiagonal();
}

/// A vehicle that brakes stops: an acceleration does not change the speed's sign, and at a crawl it does not go on.
/// Otherwise a vehicle that stops in a tunnel would be driven backwards.
void stopAtStandstill(double speed_before_mps, MotionDerivatives& motion) {
  double& speed_mps = motion.velocity_body_mps.x();
  const bool reverses = speed_before_mps * speed_mps < 0.0;
  if (!reverses && std::abs(speed_before_mps) >= kCrawl_mps) return;
  speed_mps = reverses ? 0.0 : speed_before_mps;
  motion.acceleration_body_mps2.x() = 0.0;
}

}  // namespace

void DeadReckoning::reset(const Eigen::Vector3d& sigmas_mps, double yaw_rate_sigma_rad_s) {
  S_.setZero();
  S_.diagonal().head<3>() = sigmas_mps.cwiseAbs2();
  S_.diagonal().tail<3>() << params_.acceleration_mps2 * params_.acceleration_mps2,
      Eigen::Vector2d::Constant(params_.lateral_acceleration_mps2 * params_.lateral_acceleration_mps2);
  S_yaw_.setZero();
  S_yaw_.diagonal() << yaw_rate_sigma_rad_s * yaw_rate_sigma_rad_s,
      params_.yaw_acceleration_rad_s2 * params_.yaw_acceleration_rad_s2;
  kept_ = 0.0;
  observed_in_a_row_ = 0;
  active_ = false;
}

bool DeadReckoning::observes(const Measured& measured) const {
  const double max_sigma_rad = params_.observed_sigma_deg * kDegree;
  return std::max(measured.R(0, 0), measured.R(1, 1)) <= params_.observed_sigma_m * params_.observed_sigma_m &&
         measured.yaw_variance <= max_sigma_rad * max_sigma_rad;
}

// R and the yaw's variance are those of the displacement; the motion is the displacement / dt_s.
void DeadReckoning::widenForGap(double dt_s, Measured& measured) const {
  const double lever_s2 = 0.5 * dt_s * dt_s;
  const double along_m = params_.acceleration_mps2 * lever_s2, across_m = params_.lateral_acceleration_mps2 * lever_s2;
  const double yaw_rad = yawAcceleration_rad_s2(measured.velocity_mps.norm()) * lever_s2;
  measured.R.diagonal() += Eigen::Vector3d(along_m * along_m, across_m * across_m, across_m * across_m);
  measured.yaw_variance += yaw_rad * yaw_rad;
}

// A single accurate pose between inaccurate ones does not end the dead reckoning.
bool DeadReckoning::isObservedWith(const Measured& measured) const {
  return observes(measured) && (!active_ || observed_in_a_row_ + 1 >= params_.observed_sweeps);
}

double DeadReckoning::sureness(const Measured& measured) const {
  if (active_) return 0.0;
  if (observed_in_a_row_ < params_.observed_sweeps) return 1.0;  // a drive's first: the filter knows too few
  const double sigma_m = std::sqrt(std::max(measured.R(0, 0), measured.R(1, 1)));
  return std::clamp((params_.unsure_sigma_m - sigma_m) / (params_.unsure_sigma_m - params_.sure_sigma_m), 0.0, 1.0);
}

double DeadReckoning::yawAcceleration_rad_s2(double speed_mps) const {
  const double slowness = std::min(1.0, params_.turning_speed_mps / std::max(speed_mps, 1e-3));
  return params_.yaw_acceleration_rad_s2 * slowness * slowness;
}

MotionDerivatives DeadReckoning::predict(const MotionDerivatives& before, double dt_s) {
  const double kept = std::exp(-dt_s / params_.acceleration_time_s);
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>().diagonal().setConstant(dt_s);
  F.bottomRightCorner<3, 3>().diagonal().setConstant(kept);
  S_ = (F * S_ * F.transpose()).eval();
  const double along = params_.acceleration_mps2, across = params_.lateral_acceleration_mps2;
  S_.diagonal().tail<3>() += (1.0 - kept * kept) * Eigen::Vector3d(along * along, across * across, across * across);

  const double yaw_kept = std::exp(-dt_s / params_.yaw_acceleration_time_s);
  Eigen::Matrix2d F_yaw;
  F_yaw << 1.0, dt_s, 0.0, yaw_kept;
  S_yaw_ = (F_yaw * S_yaw_ * F_yaw.transpose()).eval();
  const double yaw_acceleration = yawAcceleration_rad_s2(before.velocity_body_mps.norm());
  S_yaw_(1, 1) += (1.0 - yaw_kept * yaw_kept) * yaw_acceleration * yaw_acceleration;

  MotionDerivatives motion = before;
  motion.velocity_body_mps += dt_s * before.acceleration_body_mps2;
  motion.acceleration_body_mps2 *= kept;
  if (active_) stopAtStandstill(before.velocity_body_mps.x(), motion);
  motion.rpy_rates_rad_s.z() += dt_s * before.rpy_accelerations_rad_s2.z();
  motion.rpy_accelerations_rad_s2.z() *= yaw_kept;
  return motion;
}

void DeadReckoning::correctVelocity(const Eigen::Vector3d& velocity_mps, const Eigen::Matrix3d& R,
                                    const Eigen::Matrix3d& P_previous, double dt_s, MotionDerivatives& motion) {
  const double max_sigma_m = largestSigma(params_.max_measured_sigma_m, dt_s);
  // along R's eigenvectors, so that unobserved directions can be left out completely
  const auto eigen = symmetricEigen(R);
  for (int i = 0; i < 3; ++i) {
    const double variance = eigen.eigenvalues()[i];
    if (std::sqrt(variance) > max_sigma_m) continue;
    Vector6d axis = Vector6d::Zero();
    axis.head<3>() = eigen.eigenvectors().col(i);
    const Vector6d S_axis = S_ * axis;
    const double previous = std::max(variance, axis.head<3>().dot(P_previous * axis.head<3>()));
    const Vector6d gain = S_axis / (axis.dot(S_axis) + (variance + previous) / (dt_s * dt_s));
    const double innovation = axis.head<3>().dot(velocity_mps - motion.velocity_body_mps);
    motion.velocity_body_mps += innovation * gain.head<3>();
    motion.acceleration_body_mps2 += innovation * gain.tail<3>();
    S_ -= (gain * S_axis.transpose()).eval();
    S_ = symmetric(S_);
    kept_ *= std::clamp(1.0 - gain[0] * axis[0], 0.0, 1.0);
  }
}

void DeadReckoning::correctYawRate(const Measured& measured, double dt_s, MotionDerivatives& motion) {
  const double max_sigma_rad = largestSigma(params_.max_measured_sigma_deg * kDegree, dt_s);
  if (std::sqrt(measured.yaw_variance) > max_sigma_rad) return;
  const Eigen::Vector2d S_rate = S_yaw_.col(0);
  const Eigen::Vector2d gain = S_rate / (S_rate[0] + 2.0 * measured.yaw_variance / (dt_s * dt_s));
  const double innovation = measured.yaw_rate_rad_s - motion.rpy_rates_rad_s.z();
  motion.rpy_rates_rad_s.z() += innovation * gain[0];
  motion.rpy_accelerations_rad_s2.z() += innovation * gain[1];
  S_yaw_ -= gain * S_rate.transpose();
}

MotionDerivatives DeadReckoning::filter(const MotionDerivatives& before, double dt_s, const Measured* measured) {
  kept_ = active_ ? 1.0 : 0.0;
  active_ = measured == nullptr || !isObservedWith(*measured);
  observed_in_a_row_ = measured && observes(*measured) ? observed_in_a_row_ + 1 : 0;
  MotionDerivatives motion = predict(before, dt_s);
  if (measured) {
    if (const std::optional<MeanVelocity>& alone = measured->motion) {
      correctVelocity(alone->velocity_mps, alone->R, Eigen::Matrix3d::Zero(), dt_s, motion);
    }
    correctVelocity(measured->velocity_mps, measured->R, measured->P_previous, dt_s, motion);
    correctYawRate(*measured, dt_s, motion);
  }
  return motion;
}

Eigen::Matrix4d DeadReckoning::incrementCovariance(double dt_s) const {
  Eigen::Matrix4d added = Eigen::Matrix4d::Zero();
  if (!active_) return added;
  added.topLeftCorner<3, 3>() = dt_s * dt_s * S_.topLeftCorner<3, 3>();
  added(3, 3) = dt_s * dt_s * S_yaw_(0, 0);
  return added;
}

// Rates are means over an interval, extrapolated to its end with accelerations from one interval earlier: the rates are
// three quarters of an interval old. Limited, because no driver accelerates or turns for longer, and because the
// filter's sigma points must not turn around.
Eigen::Matrix4d DeadReckoning::drivenCovariance(double dt_s, double previous_dt_s, double speed_mps) const {
  const double bounded_s = std::min(dt_s, kLongestDriven_s);
  const double per_acceleration = (0.5 * bounded_s + 0.75 * std::min(previous_dt_s, kLongestDriven_s)) * bounded_s;
  const double along_m = params_.acceleration_mps2 * per_acceleration;
  const double yaw_rad = std::min(yawAcceleration_rad_s2(speed_mps) * per_acceleration, kWidestDriven_rad);
  const double across_m = speed_mps * bounded_s * yaw_rad / 3.0;  // the turn grows with the square of the time
  return fromSigmas(along_m, across_m, yaw_rad);
}

// The errors of speed and heading at the limit go on.
Eigen::Matrix4d DeadReckoning::drivenLaterCovariance(double dt_s, double speed_mps) const {
  const double later_s = std::max(0.0, dt_s - kLongestDriven_s);
  const double along_m = params_.acceleration_mps2 * kLongestDriven_s * later_s;
  const double yaw_rad = later_s > 0.0 ? kTurnedInAGap_rad : 0.0, across_m = speed_mps * later_s * yaw_rad;
  return fromSigmas(along_m, across_m, yaw_rad);
}

}  // namespace fail_aware
