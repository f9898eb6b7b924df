#include "core/integrity/growth_rate.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kLeastKept = 1e-3;  // of a speed's error: all but nothing
constexpr double kBlinded_s = 0.28;  // three sweeps at 10 Hz, as silence (silence.hpp); stamps jitter
// Between the niches of simulated tunnels. Where niches are in view, 0.4 m/s are forgotten at 1.6 /s; with that growth
// three of six failures behind four mouths are stopped in time, with this one all six.
constexpr double kTunnelSpeedSigma_mps = 0.5, kTunnelSpeedForgotten_per_s = 0.3;

}  // namespace

bool IncrementRate::update(const Matrix6d& increment_covariance, double dt_s, bool open) {
  const Eigen::Matrix3d block = horizontalBlock(increment_covariance);
  if (!std::isfinite(dt_s) || dt_s <= 0.0 || !isHorizontalCovariance(block)) return false;
  while (!open && !increments_.empty() && increments_.back().open) increments_.pop_back();
  increments_.push_back({block, dt_s, open});
  double total_s = 0.0;
  for (const Increment& increment : increments_) total_s += increment.dt_s;
  while (increments_.size() > 1 && total_s - increments_.front().dt_s >= window_s_) {
    total_s -= increments_.front().dt_s;
    increments_.pop_front();
  }
  return true;
}

std::optional<Eigen::Matrix3d> IncrementRate::rate() const {
  const bool blinded = isBlinded();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double total_s = 0.0;
  for (const Increment& increment : increments_) {
    if (increment.open && !blinded) continue;
    sum += increment.covariance;
    total_s += increment.dt_s;
  }
  if (total_s == 0.0) return std::nullopt;
  return Eigen::Matrix3d(sum / total_s);
}

// For at least kBlinded_s, or there is nothing else.
bool IncrementRate::isBlinded() const {
  double open_s = 0.0;
  std::size_t sweeps = 0;
  for (auto it = increments_.rbegin(); it != increments_.rend() && it->open; ++it, ++sweeps) open_s += it->dt_s;
  return open_s >= kBlinded_s || sweeps == increments_.size();
}

void GrowthRate::add(const DriftRate& rate, const SpeedChange& speed, double dt_s) {
  if (!increments_.update(rate.covariance, dt_s, rate.open)) return;
  const double forgotten_per_s = -std::log(std::max(speed.kept, kLeastKept)) / dt_s;
  // d variance / dt = noise - 2 forgotten variance
  const double noise = (speed.variance_now - speed.variance_before) / dt_s + 2.0 * forgotten_per_s * speed.variance_now;
  speed_share_.add(rate.speed_share);
  speed_noise_.add(std::max(0.0, noise));
  speed_forgotten_.add(forgotten_per_s);
  weak_rate_.add(rate.on_weak_stretch.variance_m2 / dt_s);
  weak_share_.add(rate.on_weak_stretch.speed_share);
}

void GrowthRate::describe(double min_information_ratio, CovarianceGrowth& growth) const {
  growth.rate = increments_.rate().value_or(Eigen::Matrix3d::Zero());
  growth.speed_share = speed_share_.median();
  growth.speed_noise = speed_noise_.median();
  growth.speed_forgotten_per_s = speed_forgotten_.median();
  if (!known() || !road_ahead_.isWeak(min_information_ratio)) return;
  growth.weak_stretch =
      CovarianceGrowth::WeakStretch{road_ahead_.ahead().distance_m, weak_rate_.median(), weak_share_.median(),
                                    kTunnelSpeedSigma_mps * kTunnelSpeedSigma_mps, kTunnelSpeedForgotten_per_s};
}

}  // namespace fail_aware
