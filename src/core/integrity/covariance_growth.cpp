#include "core/integrity/covariance_growth.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.hpp"

namespace fail_aware {

namespace {

constexpr double kLargestEntry = 1e12;
constexpr double kSmallestVariance = 1e-18;

bool bounded(double value) { return std::isfinite(value) && std::abs(value) <= kLargestEntry; }

bool isUsable(const CovarianceGrowth::WeakStretch& weak) {
  const double smallest =
      std::min({weak.distance_m, weak.rate, weak.speed_share, weak.speed_variance, weak.speed_forgotten_per_s});
  return smallest >= 0.0 && bounded(weak.distance_m) && bounded(weak.rate) && weak.speed_share <= 1.0 &&
         bounded(weak.speed_variance) && bounded(weak.speed_forgotten_per_s);
}

}  // namespace

bool isHorizontalCovariance(const Eigen::Matrix3d& C) {
  if (!C.allFinite() || C.cwiseAbs().maxCoeff() > kLargestEntry || C.diagonal().minCoeff() < 0.0) return false;
  const Eigen::Vector3d inverse_scale = C.diagonal().cwiseMax(kSmallestVariance).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d correlation = inverse_scale.asDiagonal() * symmetric(C) * inverse_scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(correlation, Eigen::EigenvaluesOnly);
  return eigen.info() == Eigen::Success && eigen.eigenvalues()[0] >= -1e-6;
}

bool isUsable(const CovarianceGrowth& g) {
  return isHorizontalCovariance(g.covariance) && isHorizontalCovariance(g.rate) && isHorizontalCovariance(g.drivers) &&
         g.cross.allFinite() && g.cross.cwiseAbs().maxCoeff() <= kLargestEntry && g.transient.allFinite() &&
         g.transient.cwiseAbs().maxCoeff() <= kLargestEntry && std::isfinite(g.course_rad) && bounded(g.speed_mps) &&
         bounded(g.yaw_rate_rps) && bounded(g.speed_noise) && g.speed_noise >= 0.0 &&
         bounded(g.speed_forgotten_per_s) && g.speed_forgotten_per_s >= 0.0 && g.speed_share >= 0.0 &&
         g.speed_share <= 1.0 && (!g.weak_stretch || isUsable(*g.weak_stretch));
}

GrowingCovariance::GrowingCovariance(const CovarianceGrowth& growth) : growth_(growth) {
  growth_.rate = symmetric(growth.rate);
  S_ << growth.covariance, growth.cross, growth.cross.transpose(), growth.drivers;
  S_ = symmetric(S_);
  const double speed_mps = std::abs(growth.speed_mps);
  const bool worse = growth.weak_stretch && growth.weak_stretch->speed_share > growth.speed_share && speed_mps > 0.0;
  if (worse) weak_from_s_ = growth.weak_stretch->distance_m / speed_mps;
}

double GrowingCovariance::begin(double t_s, double step_s) {
  if (t_s >= weak_from_s_) enterWeakStretch();
  if (t_s + step_s > weak_from_s_) step_s = weak_from_s_ - t_s;
  const double course = growth_.course_rad + growth_.yaw_rate_rps * (t_s + 0.5 * step_s);
  const double c = std::cos(course), s = std::sin(course), v = growth_.speed_mps;
  L_.row(0) << 0.0, 0.0, -v * s, 0.0, v * c, 0.0;
  L_.row(1) << 0.0, 0.0, v * c, 0.0, v * s, 0.0;
  L_(2, 3) = std::abs(v);  // by distance, whichever way
  const Eigen::Matrix3d R = Eigen::AngleAxisd(course, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Q_.topLeftCorner<3, 3>() = R * growth_.rate * R.transpose();
  along_ = growth_.speed_share * Eigen::Vector2d(c, s);
  return step_s;
}

void GrowingCovariance::enterWeakStretch() {
  const CovarianceGrowth::WeakStretch& weak = *growth_.weak_stretch;
  weak_from_s_ = std::numeric_limits<double>::infinity();
  growth_.rate(0, 0) = std::max(growth_.rate(0, 0), weak.rate);
  growth_.speed_share = weak.speed_share;
  growth_.speed_forgotten_per_s = weak.speed_forgotten_per_s;
  growth_.speed_noise = 2.0 * weak.speed_forgotten_per_s * weak.speed_variance;
  S_(5, 5) = std::max(S_(5, 5), weak.speed_variance);
}

// Solves dS/dt = L S + S L^T + Q; L^3 = 0, and L^2 Q = 0, since what L^2 takes in has no noise. The error of the speed
// has a solution of its own: it moves the position in the direction `along_`.
GrowingCovariance::Matrix GrowingCovariance::after(double dt_s) const {
  const SpeedStep step = speedStep(dt_s);
  Matrix A = Matrix::Identity() + dt_s * L_ + 0.5 * dt_s * dt_s * L_ * L_;
  A.block<2, 1>(0, 5) = step.way_s * along_;
  A(5, 5) = step.kept;
  const Matrix LQ = L_ * Q_;
  Matrix next = A * S_ * A.transpose() + dt_s * Q_ + 0.5 * dt_s * dt_s * (LQ + LQ.transpose()) +
                dt_s * dt_s * dt_s / 3.0 * LQ * L_.transpose();
  next.topLeftCorner<2, 2>() += step.way_variance * along_ * along_.transpose();
  next.block<2, 1>(0, 5) += step.cross * along_;
  next.block<1, 2>(5, 0) += step.cross * along_.transpose();
  next(5, 5) += step.variance;
  return next;
}

GrowingCovariance::SpeedStep GrowingCovariance::speedStep(double dt_s) const {
  const double k = growth_.speed_forgotten_per_s, noise = growth_.speed_noise, x = k * dt_s;
  SpeedStep step;
  step.kept = std::exp(-x);
  if (x < 1e-3) {  // to first order in x: the differences below would lose their digits
    step.way_s = dt_s * (1.0 - 0.5 * x);
    step.variance = noise * dt_s * (1.0 - x);
    step.cross = noise * dt_s * dt_s * (0.5 - 0.5 * x);
    step.way_variance = noise * dt_s * dt_s * dt_s * (1.0 / 3.0 - 0.25 * x);
    return step;
  }
  const double once = -std::expm1(-x) / k, twice = -std::expm1(-2.0 * x) / (2.0 * k);
  step.way_s = once;
  step.variance = noise * twice;
  step.cross = noise * (once - twice) / k;
  step.way_variance = noise * (dt_s - 2.0 * once + twice) / (k * k);
  return step;
}

}  // namespace fail_aware
