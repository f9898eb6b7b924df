#include "core/integrity/covariance_predictor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kMaxSteps = 100000.0;
constexpr double kLargestRadius_m = 1e6;
constexpr double kLargestEntry = kLargestRadius_m * kLargestRadius_m;
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

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The error of the speed: w' = -w / time + white noise.
struct SpeedWander {
  double forgotten_per_s = 0.0;  ///< 1 / time
  double noise = 0.0;            ///< m^2/s^3
};

// What of w is left after `dt`, its way, and the covariance of (w, way) that the noise makes.
struct SpeedStep {
  double kept = 1.0, way_s = 0.0, variance = 0.0, cross = 0.0, way_variance = 0.0;
};

SpeedStep stepOf(const SpeedWander& speed, double dt) {
  const double k = speed.forgotten_per_s, x = k * dt;
  SpeedStep step;
  step.kept = std::exp(-x);
  if (x < 1e-3) {  // to second order in x: the differences below would lose their digits
    step.way_s = dt * (1.0 - 0.5 * x);
    step.variance = speed.noise * dt * (1.0 - x);
    step.cross = speed.noise * dt * dt * (0.5 - 0.5 * x);
    step.way_variance = speed.noise * dt * dt * dt * (1.0 / 3.0 - 0.25 * x);
    return step;
  }
  const double once = -std::expm1(-x) / k, twice = -std::expm1(-2.0 * x) / (2.0 * k);
  step.way_s = once;
  step.variance = speed.noise * twice;
  step.cross = speed.noise * (once - twice) / k;
  step.way_variance = speed.noise * (dt - 2.0 * once + twice) / (k * k);
  return step;
}

// S after `dt` with dS/dt = L S + S L^T + Q, and the speed's error beside it, whose way goes `along` (x, y, 1/s).
// L^3 = 0, and L^2 Q = 0, since what L^2 takes in has no noise.
Matrix6 grown(const Matrix6& S, const Matrix6& L, const Matrix6& Q, const SpeedWander& speed,
              const Eigen::Vector2d& along, double dt) {
  const SpeedStep step = stepOf(speed, dt);
  Matrix6 A = Matrix6::Identity() + dt * L + 0.5 * dt * dt * L * L;
  A.block<2, 1>(0, 5) = step.way_s * along;
  A(5, 5) = step.kept;
  const Matrix6 LQ = L * Q;
  Matrix6 next =
      A * S * A.transpose() + dt * Q + 0.5 * dt * dt * (LQ + LQ.transpose()) + dt * dt * dt / 3.0 * LQ * L.transpose();
  next.topLeftCorner<2, 2>() += step.way_variance * along * along.transpose();
  next.block<2, 1>(0, 5) += step.cross * along;
  next.block<1, 2>(5, 0) += step.cross * along.transpose();
  next(5, 5) += step.variance;
  return next;
}

// Probability that an error with scales 1 and `ratio` is farther than `radius`. The integrand has period pi and is
// symmetric about pi / 2.
double exceedance(double ratio, double radius, double degrees_of_freedom) {
  constexpr int kSteps = 64;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double sine = std::sin(0.5 * M_PI * (i + 0.5) / kSteps);
    const double squared = radius * radius / (1.0 - (1.0 - ratio * ratio) * sine * sine);
    sum += degrees_of_freedom > 0.0 ? std::pow(1.0 + squared / degrees_of_freedom, -0.5 * degrees_of_freedom)
                                    : std::exp(-0.5 * squared);
  }
  return sum / kSteps;
}

// Standard deviations along the axes, the larger first.
Eigen::Vector2d axesOf(const Eigen::Matrix2d& covariance) {
  const double mean = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double half = std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return Eigen::Vector2d(std::max(mean + half, 0.0), std::max(mean - half, 0.0)).cwiseSqrt();
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
  requireParameter(alarm_confidence > 0.0 && alarm_confidence <= confidence, "alarm_confidence", alarm_confidence,
                   "in (0, confidence]");
  requireParameter(degrees_of_freedom == 0.0 || (degrees_of_freedom >= 1.0 && degrees_of_freedom <= 1e6),
                   "degrees_of_freedom", degrees_of_freedom, "0 or in [1, 1e6]");
  requirePositive("horizon_s", horizon_s);
  requirePositive("step_s", step_s);
  requireAtMost("step_s", step_s, 10.0);
  requireParameter(horizon_s / step_s <= kMaxSteps, "horizon_s", horizon_s, "at most 100000 steps of step_s");
  requireWithin("rate_scale", rate_scale, 0.0, 1e6);
}

ConfidenceRadius::ConfidenceRadius(double probability, double degrees_of_freedom) {
  const double n = degrees_of_freedom;
  const double circle = n > 0.0 ? std::sqrt(n * (std::pow(1.0 - probability, -2.0 / n) - 1.0))
                                : std::sqrt(-2.0 * std::log1p(-probability));  // the largest
  for (int i = 0; i <= kTable; ++i) {
    const double ratio = static_cast<double>(i) / kTable;
    double low = 0.0, high = circle * (1.0 + 1e-9);
    for (int k = 0; k < kBisections; ++k) {
      const double middle = 0.5 * (low + high);
      (exceedance(ratio, middle, n) > 1.0 - probability ? low : high) = middle;
    }
    sigmas_[static_cast<std::size_t>(i)] = high;
  }
}

double ConfidenceRadius::operator()(const Eigen::Matrix2d& covariance) const {
  const Eigen::Vector2d sigmas = axesOf(covariance);
  if (sigmas[0] <= 0.0) return 0.0;
  const double place = std::min(sigmas[1] / sigmas[0], 1.0) * kTable;
  const auto below = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(kTable - 1));
  const double share = place - static_cast<double>(below);
  return ((1.0 - share) * sigmas_[below] + share * sigmas_[below + 1]) * sigmas[0];
}

double exceedance(const Eigen::Matrix2d& covariance, double radius, double degrees_of_freedom) {
  const Eigen::Vector2d sigmas = axesOf(covariance);
  if (sigmas[0] <= 0.0) return 0.0;
  return exceedance(std::min(sigmas[1] / sigmas[0], 1.0), radius / sigmas[0], degrees_of_freedom);
}

namespace {

// Before the members are made of them.
const CovariancePredictor::Params& validated(const CovariancePredictor::Params& params) {
  params.validate();
  return params;
}

// The growth along the path, step by step.
class Growing {
 public:
  Growing(const CovarianceGrowth& growth, double rate_scale)
      : growth_(growth),
        scale_(rate_scale),
        rate_(0.5 * rate_scale * (growth.rate + growth.rate.transpose())),
        speed_{growth.speed_forgotten_per_s, rate_scale * growth.speed_noise},
        speed_share_(growth.speed_share) {
    const double speed_mps = std::abs(growth.speed_mps);
    const bool worse = growth.weak_stretch && growth.weak_stretch->speed_share > growth.speed_share && speed_mps > 0.0;
    if (worse) weak_from_s_ = growth.weak_stretch->distance_m / speed_mps;
  }

  /// Prepares a step from t_s on; returns its length: at most step_s, and not beyond the beginning of the weak stretch.
  double begin(double t_s, double step_s, Matrix6& S) {
    if (t_s >= weak_from_s_) enterWeakStretch(S);
    if (t_s + step_s > weak_from_s_) step_s = weak_from_s_ - t_s;
    const double course = growth_.course_rad + growth_.yaw_rate_rps * (t_s + 0.5 * step_s);
    const double c = std::cos(course), s = std::sin(course), v = growth_.speed_mps, scaled_v = growth_.pace * v;
    L_.row(0) << 0.0, 0.0, -v * s, 0.0, scaled_v * c, 0.0;
    L_.row(1) << 0.0, 0.0, v * c, 0.0, scaled_v * s, 0.0;
    L_(2, 3) = std::abs(v);  // by distance, whichever way
    const Eigen::Matrix3d R = Eigen::AngleAxisd(course, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Q_.topLeftCorner<3, 3>() = R * rate_ * R.transpose();
    along_ = speed_share_ * Eigen::Vector2d(c, s);
    return step_s;
  }

  Matrix6 after(const Matrix6& S, double dt) const { return grown(S, L_, Q_, speed_, along_, dt); }

 private:
  void enterWeakStretch(Matrix6& S) {
    const CovarianceGrowth::WeakStretch& weak = *growth_.weak_stretch;
    weak_from_s_ = std::numeric_limits<double>::infinity();
    rate_(0, 0) = std::max(rate_(0, 0), scale_ * weak.rate);
    speed_share_ = weak.speed_share;
    speed_ = {weak.speed_forgotten_per_s, scale_ * 2.0 * weak.speed_forgotten_per_s * weak.speed_variance};
    S(5, 5) = std::max(S(5, 5), weak.speed_variance);
  }

  const CovarianceGrowth& growth_;
  double scale_;
  Eigen::Matrix3d rate_;
  SpeedWander speed_;
  double speed_share_;
  double weak_from_s_ = std::numeric_limits<double>::infinity();
  Matrix6 L_ = Matrix6::Zero(), Q_ = Matrix6::Zero();
  Eigen::Vector2d along_ = Eigen::Vector2d::Zero();
};

bool isUsable(const CovarianceGrowth& g) {
  const auto bounded = [](double value) { return std::isfinite(value) && std::abs(value) <= kLargestEntry; };
  return isCovariance(g.covariance) && isCovariance(g.rate) && isCovariance(g.drivers) && g.cross.allFinite() &&
         g.cross.cwiseAbs().maxCoeff() <= kLargestEntry && g.transient.allFinite() &&
         g.transient.cwiseAbs().maxCoeff() <= kLargestEntry && std::isfinite(g.course_rad) && bounded(g.speed_mps) &&
         bounded(g.yaw_rate_rps) && bounded(g.speed_noise) && g.speed_noise >= 0.0 &&
         bounded(g.speed_forgotten_per_s) && g.speed_forgotten_per_s >= 0.0 && g.speed_share >= 0.0 &&
         g.speed_share <= 1.0 && bounded(g.pace) && g.pace >= 1.0;
}

}  // namespace

CovariancePredictor::CovariancePredictor(const Params& params)
    : params_(validated(params)), radius_(params.confidence, params.degrees_of_freedom) {}

CovariancePrediction CovariancePredictor::predict(const CovarianceGrowth& growth) const {
  CovariancePrediction prediction;
  if (!isUsable(growth)) return {TimeToFailure::reached(), TimeToFailure::reached(), kLargestRadius_m, 1.0};
  Matrix6 S;
  S << growth.covariance, growth.cross, growth.cross.transpose(), growth.drivers;
  S = (0.5 * (S + S.transpose())).eval();
  const auto horizontal = [&](const Matrix6& covariance) {
    return Eigen::Matrix2d(covariance.topLeftCorner<2, 2>() + growth.transient);
  };
  const auto failed = [&](const Matrix6& covariance) {
    return exceedance(horizontal(covariance), params_.alert_limit_m, params_.degrees_of_freedom);
  };
  prediction.radius_m = std::min(radius_(horizontal(S)), kLargestRadius_m);
  prediction.failed_probability = failed(S);
  struct Sought {
    TimeToFailure& time;
    double probability;
    bool found;
  };
  const double p = prediction.failed_probability;
  Sought all[] = {{prediction.time_to_failure, p + (1.0 - params_.confidence) * (1.0 - p), false},
                  {prediction.time_to_alarm, 1.0 - params_.alarm_confidence, false}};
  for (Sought& sought : all) {
    sought.time = TimeToFailure::fromSeconds(params_.horizon_s, params_.horizon_s);
    sought.found = p >= sought.probability;
    if (sought.found) sought.time = TimeToFailure::reached();
  }

  Growing growing(growth, params_.rate_scale);
  double t = 0.0;
  while (t < params_.horizon_s && !(all[0].found && all[1].found)) {
    const double step_s = growing.begin(t, std::min(params_.step_s, params_.horizon_s - t), S);
    const auto after = [&](double dt) { return growing.after(S, dt); };
    const Matrix6 next = after(step_s);
    const double at_end = failed(next);
    for (Sought& sought : all) {
      if (sought.found || at_end < sought.probability) continue;
      double low = 0.0, high = step_s;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (low + high);
        (failed(after(middle)) < sought.probability ? low : high) = middle;
      }
      sought.time = TimeToFailure::fromSeconds(t + high, params_.horizon_s);
      sought.found = true;
    }
    S = next;
    t += step_s;
  }
  prediction.time_to_failure = combine(prediction.time_to_failure, prediction.time_to_alarm);
  return prediction;
}

}  // namespace fail_aware
