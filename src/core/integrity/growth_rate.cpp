#include "core/integrity/growth_rate.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kLeastKept = 1e-3;  // of a speed's error: all but nothing

}  // namespace

void GrowthRate::add(const DriftRate& rate, const SpeedChange& speed, double dt_s) {
  if (!increments_.update(rate.covariance, dt_s)) return;
  const double forgotten_per_s = -std::log(std::max(speed.kept, kLeastKept)) / dt_s;
  // d variance / dt = noise - 2 forgotten variance
  const double noise = (speed.variance_now - speed.variance_before) / dt_s + 2.0 * forgotten_per_s * speed.variance_now;
  speed_share_.add(rate.speed_share);
  speed_noise_.add(std::max(0.0, noise));
  speed_forgotten_.add(forgotten_per_s);
}

void GrowthRate::describe(CovarianceGrowth& growth) const {
  growth.rate = increments_.rate().value_or(Eigen::Matrix3d::Zero());
  growth.speed_share = speed_share_.median();
  growth.speed_noise = speed_noise_.median();
  growth.speed_forgotten_per_s = speed_forgotten_.median();
}

void GrowthRate::reset() {
  increments_.reset();
  speed_share_.clear();
  speed_noise_.clear();
  speed_forgotten_.clear();
}

}  // namespace fail_aware
