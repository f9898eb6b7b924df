#include "core/estimation/vehicle/motion_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/rotation.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

// The vector, shortened to `max_norm` if it is longer.
Eigen::Vector3d limited(const Eigen::Vector3d& v, double max_norm) {
  const double norm = v.norm();
  return norm > max_norm ? Eigen::Vector3d(v * (max_norm / norm)) : v;
}

}  // namespace

void MotionHistory::push(double stamp_s, const Pose& T_odom_cog) {
  if (!std::isfinite(stamp_s) || !isFinite(T_odom_cog)) return;
  if (!samples_.empty()) {
    const double since_newest = secondsBetween(samples_.front().stamp_s, stamp_s);
    if (since_newest <= 0.0) return;
    if (since_newest < params_.min_interval_s) samples_.pop_front();
  }

  Sample sample;
  sample.stamp_s = stamp_s;
  sample.T_odom_cog = T_odom_cog;
  sample.rpy_rad = rpyFromRotation(T_odom_cog.linear());
  if (!samples_.empty()) {
    const Sample& previous = samples_.front();
    sample.interval_s = secondsBetween(previous.stamp_s, stamp_s);
    Vector6d increment;
    if (params_.second_differences) {
      increment.head<3>() =
          T_odom_cog.linear().transpose() * (T_odom_cog.translation() - previous.T_odom_cog.translation());
    } else {
      increment.head<3>() = logSe3(previous.T_odom_cog.inverse() * T_odom_cog).head<3>();
    }
    for (int i = 0; i < 3; ++i) increment[3 + i] = wrapAngle(sample.rpy_rad[i] - previous.rpy_rad[i]);
    sample.mean_rates = increment / sample.interval_s;
  }
  samples_.push_front(sample);
  const int intervals = std::max(params_.window_sweeps, params_.acceleration_window_sweeps);
  if (samples_.size() > static_cast<std::size_t>(intervals) + 1) samples_.pop_back();
}

void MotionHistory::move(const Pose& T_new_old) {
  const std::deque<Sample> before = std::exchange(samples_, {});
  for (auto it = before.rbegin(); it != before.rend(); ++it) {
    push(it->stamp_s, orthonormalized(T_new_old * it->T_odom_cog));
  }
}

// Slope of the weighted least-squares line through the newest `samples` mean rates at their intervals' middles.
Vector6d MotionHistory::meanAccelerations(std::size_t samples) const {
  const double newest_s = samples_.front().stamp_s;
  double weight_sum = 0.0, time_mean = 0.0, time_spread = 0.0;
  Vector6d rates_mean = Vector6d::Zero(), slope_numerator = Vector6d::Zero();
  for (std::size_t age = 0; age < samples; ++age) {
    const Sample& sample = samples_[age];
    const double middle_s = secondsBetween(newest_s, sample.stamp_s) - 0.5 * sample.interval_s;
    if (age > 0 && -middle_s > params_.max_age_s) break;
    const double weight = sample.interval_s * sample.interval_s;
    // running update of mean and co-moment
    weight_sum += weight;
    const double time_step = middle_s - time_mean;
    time_mean += weight / weight_sum * time_step;
    const Vector6d rates_step = sample.mean_rates - rates_mean;
    rates_mean += weight / weight_sum * rates_step;
    time_spread += weight * time_step * (middle_s - time_mean);
    slope_numerator += weight * (middle_s - time_mean) * rates_step;
  }
  return time_spread > 0.0 ? Vector6d(slope_numerator / time_spread) : Vector6d::Zero();
}

// x, y and yaw at the newest stamp; z, roll and pitch as the header says.
Vector6d MotionHistory::ratesAtNewest(std::size_t samples, const Vector6d& accelerations) const {
  Vector6d slopes = accelerations;
  slopes.segment<3>(2).setZero();
  const double newest_s = samples_.front().stamp_s;
  double weight_sum = 0.0;
  Vector6d rates = Vector6d::Zero();
  for (std::size_t age = 0; age < samples; ++age) {
    const Sample& sample = samples_[age];
    const double since_middle_s = secondsBetween(sample.stamp_s, newest_s) + 0.5 * sample.interval_s;
    if (age > 0 && since_middle_s > params_.max_age_s) break;
    const double weight = sample.interval_s * sample.interval_s;
    weight_sum += weight;
    rates += weight * (sample.mean_rates + since_middle_s * slopes);
  }
  rates /= weight_sum;
  rates.segment<2>(3) = samples_.front().mean_rates.segment<2>(3);
  return rates;
}

MotionDerivatives MotionHistory::derivatives() const {
  MotionDerivatives out;
  if (samples_.size() < 2) return out;
  const std::size_t available = samples_.size() - 1;

  Vector6d accelerations = Vector6d::Zero();
  if (params_.second_differences) {
    if (available >= 2) {
      accelerations = (samples_.front().mean_rates - samples_[1].mean_rates) / samples_.front().interval_s;
    }
  } else {
    accelerations =
        meanAccelerations(std::min(available, static_cast<std::size_t>(params_.acceleration_window_sweeps)));
  }
  accelerations.head<3>() = limited(accelerations.head<3>(), params_.max_acceleration_mps2);
  const double max_angular = params_.max_angular_acceleration_rad_s2;
  for (int i = 3; i < 6; ++i) accelerations[i] = std::clamp(accelerations[i], -max_angular, max_angular);

  const Vector6d rates =
      params_.second_differences
          ? samples_.front().mean_rates
          : ratesAtNewest(std::min(available, static_cast<std::size_t>(params_.window_sweeps)), accelerations);
  out.valid = rates.allFinite() && accelerations.allFinite();
  if (!out.valid) return out;
  out.velocity_body_mps = rates.head<3>();
  out.acceleration_body_mps2 = accelerations.head<3>();
  out.rpy_rates_rad_s = rates.tail<3>();
  out.rpy_accelerations_rad_s2 = accelerations.tail<3>();
  return out;
}

MotionDerivatives fading(const MotionDerivatives& motion, double dt_s) {
  constexpr double kAcceleration_s = 0.5, kTurnAcceleration_s = 0.25, kTilting_s = 0.5;  // how long they last
  // the distance of an acceleration that decays with `time_s`, against that of a constant one
  const auto lasting = [dt_s](double time_s) {
    return 2.0 * time_s / dt_s * (1.0 - time_s / dt_s * (1.0 - std::exp(-dt_s / time_s)));
  };
  MotionDerivatives faded = motion;
  faded.acceleration_body_mps2 *= lasting(kAcceleration_s);
  faded.rpy_accelerations_rad_s2 *= lasting(kTurnAcceleration_s);
  faded.rpy_rates_rad_s.head<2>() *= std::min(1.0, kTilting_s / dt_s);
  return faded;
}

}  // namespace fail_aware
