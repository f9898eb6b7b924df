#include "fail_aware_lidar_odometry/core/fail_aware/covariance_predictor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kMaxSteps = 100000.0;
constexpr double kLargestEntry = 1e12;
constexpr double kSmallestVariance = 1e-18;
constexpr int kBisections = 40;

// Up to rounding; bounded so that nothing below can overflow.
bool isCovariance(const Eigen::Matrix3d& C) {
  if (!C.allFinite() || C.cwiseAbs().maxCoeff() > kLargestEntry || C.diagonal().minCoeff() < 0.0) return false;
  const Eigen::Vector3d inverse_scale = C.diagonal().cwiseMax(kSmallestVariance).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d correlation =
      inverse_scale.asDiagonal() * (0.5 * (C + C.transpose())) * inverse_scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(correlation, Eigen::EigenvaluesOnly);
  return eigen.info() == Eigen::Success && eigen.eigenvalues()[0] >= -1e-6;
}

double radius(const Eigen::Matrix3d& S, double k) {
  const double mean = 0.5 * (S(0, 0) + S(1, 1));
  const double largest = mean + std::hypot(0.5 * (S(0, 0) - S(1, 1)), S(0, 1));
  return k * std::sqrt(std::max(largest, 0.0));
}

// The solution of dS/dt = L S + S L^T + Q after `dt`, L nilpotent (L^2 = 0).
Eigen::Matrix3d grown(const Eigen::Matrix3d& S, const Eigen::Matrix3d& L, const Eigen::Matrix3d& Q, double dt) {
  const Eigen::Matrix3d A = Eigen::Matrix3d::Identity() + dt * L;
  const Eigen::Matrix3d LQ = L * Q;
  return A * S * A.transpose() + dt * Q + 0.5 * dt * dt * (LQ + LQ.transpose()) +
         dt * dt * dt / 3.0 * LQ * L.transpose();
}

}  // namespace

Eigen::Matrix3d horizontalBlock(const Matrix6d& covariance) {
  constexpr int kIndex[3] = {0, 1, 5};
  Eigen::Matrix3d block;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) block(i, j) = covariance(kIndex[i], kIndex[j]);
  }
  return block;
}

IncrementRate::IncrementRate(double window_s) : window_s_(window_s) { requirePositive("window_s", window_s); }

bool IncrementRate::update(const Matrix6d& increment_covariance, double dt_s) {
  const Eigen::Matrix3d block = horizontalBlock(increment_covariance);
  if (!std::isfinite(dt_s) || dt_s <= 0.0 || !isCovariance(block)) return false;
  increments_.push_back({block, dt_s});
  double total_s = 0.0;
  for (const Increment& increment : increments_) total_s += increment.dt_s;
  while (increments_.size() > 1 && total_s - increments_.front().dt_s >= window_s_) {
    total_s -= increments_.front().dt_s;
    increments_.pop_front();
  }
  return true;
}

std::optional<Eigen::Matrix3d> IncrementRate::rate() const {
  if (increments_.empty()) return std::nullopt;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double total_s = 0.0;
  for (const Increment& increment : increments_) {
    sum += increment.covariance;
    total_s += increment.dt_s;
  }
  return Eigen::Matrix3d(sum / total_s);
}

void CovariancePredictor::Params::validate() const {
  requirePositive("alert_limit_m", alert_limit_m);
  requireParameter(std::isfinite(confidence) && confidence > 0.0 && confidence < 1.0, "confidence", confidence,
                   "in (0, 1)");
  requirePositive("horizon_s", horizon_s);
  requireParameter(std::isfinite(step_s) && step_s > 0.0 && horizon_s / step_s <= kMaxSteps, "step_s", step_s,
                   "> 0 and at least horizon_s / 100000");
  requireWithin("rate_scale", rate_scale, 0.0, 1e6);
}

CovariancePredictor::CovariancePredictor(const Params& params) : params_(params) {
  params_.validate();
  k_ = std::sqrt(-2.0 * std::log1p(-params_.confidence));
}

CovariancePrediction CovariancePredictor::predict(const CovarianceGrowth& growth) const {
  CovariancePrediction prediction;
  if (!isCovariance(growth.covariance) || !isCovariance(growth.rate) || !std::isfinite(growth.course_rad) ||
      !std::isfinite(growth.speed_mps) || std::abs(growth.speed_mps) > kLargestEntry ||
      !std::isfinite(growth.yaw_rate_rps) || std::abs(growth.yaw_rate_rps) > kLargestEntry) {
    return prediction;
  }
  Eigen::Matrix3d S = 0.5 * (growth.covariance + growth.covariance.transpose());
  const Eigen::Matrix3d rate = 0.5 * params_.rate_scale * (growth.rate + growth.rate.transpose());
  const auto passes = [this](const Eigen::Matrix3d& covariance) {
    return !(radius(covariance, k_) < params_.alert_limit_m);
  };
  prediction.radius_m = radius(S, k_);
  if (passes(S)) {
    prediction.time_to_failure = TimeToFailure::reached();
    return prediction;
  }

  for (double t = 0.0; t < params_.horizon_s; t += params_.step_s) {
    const double step_s = std::min(params_.step_s, params_.horizon_s - t);
    const double course = growth.course_rad + growth.yaw_rate_rps * (t + 0.5 * step_s);
    Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
    L(0, 2) = -growth.speed_mps * std::sin(course);
    L(1, 2) = growth.speed_mps * std::cos(course);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(course, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Matrix3d Q = R * rate * R.transpose();
    const Eigen::Matrix3d next = grown(S, L, Q, step_s);
    if (passes(next)) {
      double before = 0.0, after = step_s;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (before + after);
        (passes(grown(S, L, Q, middle)) ? after : before) = middle;
      }
      prediction.time_to_failure = TimeToFailure::fromSeconds(t + after, params_.horizon_s);
      return prediction;
    }
    S = next;
  }
  prediction.time_to_failure = TimeToFailure::fromSeconds(params_.horizon_s, params_.horizon_s);
  return prediction;
}

}  // namespace fail_aware
