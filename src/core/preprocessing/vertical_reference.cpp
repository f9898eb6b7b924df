#include "core/preprocessing/vertical_reference.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/robust_kernel.hpp"
#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr Eigen::Index kDrift = 2, kElevation = 3, kJitter = 4, kBeams = 6;  // in the state
constexpr double kStartTilt = 0.1;                                           // rad: mount and slope at the start
constexpr double kKnownTilt = 0.1 * kDegree;  // sigma from which on a tilt is known, and kept
constexpr double kKernelSigmas = 3.0;
constexpr int kReweightings = 3;
constexpr double kMinTrust = 0.3;  // mean robust weight below which the tilt is let go
constexpr double kLetGo = 1.0 * kDegree;
constexpr std::size_t kMinProfiles = 6;

Eigen::Vector2d lateralAxis(const Pose& T_odom_lidar) {
  const Eigen::Vector2d lateral = T_odom_lidar.linear().col(1).head<2>();
  return lateral / std::max(lateral.norm(), 1e-9);
}

}  // namespace

void VerticalReferenceParams::validate() const {
  requirePositive("look_every_m", look_every_m);
  profiles.validate();
  requirePositive("sigma_surface_deg", sigma_surface_deg);
  requirePositive("sigma_line_deg", sigma_line_deg);
  requirePositive("sigma_line_away_deg", sigma_line_away_deg);
  requirePositive("point_sigma_m", point_sigma_m);
  requirePositive("beam_sigma_m", beam_sigma_m);
  requireNotNegative("line_sigma_m", line_sigma_m);
  requirePositive("sigma_range_m", sigma_range_m);
  requirePositive("sigma_elevation_deg", sigma_elevation_deg);
  requirePositive("sigma_drift_deg_per_m", sigma_drift_deg_per_m);
  requireNotNegative("drift_walk_deg_per_m", drift_walk_deg_per_m);
  requirePositive("tilt_walk_deg", tilt_walk_deg);
  requireNotNegative("jitter_deg", jitter_deg);
  requireNotNegative("range_walk_m", range_walk_m);
  requireWithin("correlation_inflation", correlation_inflation, 1.0, 1e6);
  requireWithin("tilt_gain_per_m", tilt_gain_per_m, 0.0, 1.0);
  requireWithin("response", response, 0.1, 1.0);
  requireWithin("max_curvature_deg_per_m", max_curvature_deg_per_m, 0.0, 0.1);
  requirePositive("curvature_range_m", curvature_range_m);
}

/// A profile as weighted equations A x = b, their common unknown offset eliminated: one for the lean, which the true
/// lean of things makes uncertain, and those for the straightness, all of unit variance. Columns of A: `of` in the state.
struct VerticalReference::Equations {
  std::vector<Eigen::Index> of;
  Eigen::VectorXd lean;
  double lean_value;
  Eigen::MatrixXd straight;
  Eigen::VectorXd straight_values;

  Eigen::VectorXd pick(const Eigen::VectorXd& x) const {
    Eigen::VectorXd picked(static_cast<Eigen::Index>(of.size()));
    for (std::size_t i = 0; i < of.size(); ++i) picked[static_cast<Eigen::Index>(i)] = x[of[i]];
    return picked;
  }
  double leanVariance(const Eigen::MatrixXd& P) const {
    double variance = 0.0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      for (std::size_t j = 0; j < of.size(); ++j) {
        variance += lean[static_cast<Eigen::Index>(i)] * P(of[i], of[j]) * lean[static_cast<Eigen::Index>(j)];
      }
    }
    return variance;
  }
};

VerticalReference::VerticalReference(const Params& params) : params_(params), finder_(params.profiles) {
  params_.validate();
  reset();
}

void VerticalReference::reset() {
  report_ = Report();
  curvature_per_m_ = 0.0;
  x_.setZero(kBeams);
  P_.setZero(kBeams, kBeams);
  P_(kDrift, kDrift) = std::pow(params_.sigma_drift_deg_per_m * kDegree, 2);
  P_(kElevation, kElevation) = std::pow(params_.sigma_elevation_deg * kDegree, 2);
  ranges_.clear();
  forgetOdom();
  since_look_m_ = 0.0;
  odom_reset_count_ = 0;
}

/// What is known about odom's axes: the tilt.
void VerticalReference::forgetOdom() {
  for (const Eigen::Index i : {0, 1}) {
    x_[i] = 0.0;
    P_.row(i).setZero();
    P_.col(i).setZero();
    P_(i, i) = kStartTilt * kStartTilt;
  }
  kept_tilt_.reset();
  has_position_ = false;
}

void VerticalReference::apply(std::vector<Eigen::Vector3f>& points_lidar) const {
  if (curvature_per_m_ == 0.0) return;
  const auto half_curvature = static_cast<float>(0.5 * curvature_per_m_);
  const auto reach = static_cast<float>(params_.curvature_range_m);
  PointBlock p;
  forEachBlock(points_lidar.size(), [&](std::size_t first, std::size_t count) {
    p.load(&points_lidar[first], count);
    const PointBlock::Array h = (p.x * p.x + p.y * p.y).sqrt();
    p.z += half_curvature * h * h.min(reach);
    p.store(&points_lidar[first], count);
  });
}

void VerticalReference::observe(const std::vector<Eigen::Vector3f>& points_lidar,
                                const std::vector<std::uint16_t>& rings, const Pose& T_odom_lidar,
                                int odom_reset_count) {
  if (!params_.enabled || !isFinite(T_odom_lidar)) return;
  if (odom_reset_count != odom_reset_count_) forgetOdom();
  odom_reset_count_ = odom_reset_count;
  advance(T_odom_lidar);
  if (since_look_m_ >= params_.look_every_m) {
    since_look_m_ = 0.0;
    beginLook();
    finder_.find(points_lidar, rings, ranges_, T_odom_lidar.linear());
    resizeBeams();
    update();
    ++report_.looks;
  }
  setBend(T_odom_lidar);
}

void VerticalReference::advance(const Pose& T_odom_lidar) {
  const Eigen::Vector3d position = T_odom_lidar.translation();
  const double way = has_position_ ? (position - last_position_odom_).norm() : 0.0;
  has_position_ = true;
  last_position_odom_ = position;
  since_look_m_ += way;
  const Eigen::Vector2d lateral = lateralAxis(T_odom_lidar);
  x_.head<2>() += way * (x_[kDrift] - params_.response * curvature_per_m_) * lateral;
  P_.topRows<2>() += way * lateral * P_.row(kDrift);
  P_.leftCols<2>() += way * P_.col(kDrift) * lateral.transpose();
  P_.diagonal().head<2>().array() += way * std::pow(params_.tilt_walk_deg * kDegree, 2);
  P_(kDrift, kDrift) += way * std::pow(params_.drift_walk_deg_per_m * kDegree, 2);
  P_.diagonal().tail(x_.size() - kBeams).array() += way * params_.range_walk_m * params_.range_walk_m;
}

void VerticalReference::beginLook() {
  for (const Eigen::Index i : {kJitter, kJitter + 1}) {
    x_[i] = 0.0;
    P_.row(i).setZero();
    P_.col(i).setZero();
    P_(i, i) = std::pow(params_.jitter_deg * kDegree, 2);
  }
  ranges_.resize(static_cast<std::size_t>(x_.size() - kBeams));
  for (std::size_t ring = 0; ring < ranges_.size(); ++ring) {
    const Eigen::Index i = kBeams + static_cast<Eigen::Index>(ring);
    ranges_[ring] = {static_cast<float>(x_[i]), static_cast<float>(std::sqrt(P_(i, i)))};
  }
}

void VerticalReference::resizeBeams() {
  Eigen::Index size = x_.size();
  for (const UprightProfile::Beam& beam : finder_.beams()) {
    size = std::max(size, kBeams + static_cast<Eigen::Index>(beam.ring) + 1);
  }
  const Eigen::Index added = size - x_.size();
  if (added == 0) return;
  x_.conservativeResize(size);
  x_.tail(added).setZero();
  P_.conservativeResize(size, size);
  P_.rightCols(added).setZero();
  P_.bottomRows(added).setZero();
  P_.diagonal().tail(added).setConstant(params_.sigma_range_m * params_.sigma_range_m);
}

VerticalReference::Equations VerticalReference::equationsOf(const UprightProfile& profile) const {
  const auto n = static_cast<Eigen::Index>(profile.size);
  const bool surface = profile.kind == UprightProfile::Kind::kSurface;
  const Eigen::Vector2d& m = profile.direction;
  Equations e;
  e.of = {0, 1, kJitter, kJitter + 1, kElevation};
  constexpr Eigen::Index kShared = 5;
  Eigen::VectorXd w(n), z(n), y(n), oblique(n), rest(n);
  double known = 0.0;  // mean variance that the errors of the ranges explain, in units of the noise's
  for (Eigen::Index i = 0; i < n; ++i) {
    const UprightProfile::Beam& beam = finder_.beams()[profile.first + static_cast<std::size_t>(i)];
    const Eigen::Index of = kBeams + beam.ring;
    e.of.push_back(of);
    const double point = params_.point_sigma_m,
                 common = std::hypot(params_.beam_sigma_m, surface ? 0.0 : params_.line_sigma_m);
    w[i] = 1.0 / (common * common + point * point / static_cast<double>(beam.points));
    z[i] = static_cast<double>(beam.height_m);
    oblique[i] = static_cast<double>(beam.obliqueness);
    rest[i] = static_cast<double>(beam.offset_m);
    const double corrected = beam.ring < ranges_.size() ? static_cast<double>(ranges_[beam.ring].too_far_m) : 0.0;
    y[i] = rest[i] + oblique[i] * corrected;
    known += w[i] * oblique[i] * oblique[i] * P_(of, of) / static_cast<double>(n);
  }
  const double total = w.sum();
  z.array() -= w.dot(z) / total;
  y.array() -= w.dot(y) / total;
  const Eigen::VectorXd root = w.cwiseSqrt();
  const Eigen::VectorXd unit = root.cwiseProduct(z).normalized();  // of the weighted equations: the lean
  // how much less straight the profile is than the noise allows
  rest.array() -= w.dot(rest) / total;
  rest = root.cwiseProduct(rest).eval();
  rest -= unit * unit.dot(rest);
  const double roughness = std::max(1.0, rest.squaredNorm() / static_cast<double>(n - 2) / (1.0 + known));
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, kShared + n);
  A.col(0) = A.col(2) = -m.y() * z;
  A.col(1) = A.col(3) = m.x() * z;
  A.col(4) = m.dot(profile.away) * z;
  A.rightCols(n).diagonal() = oblique;
  A.rightCols(n).rowwise() -= (w.cwiseProduct(oblique) / total).transpose();
  A = ((root / std::sqrt(roughness)).asDiagonal() * A).eval();
  Eigen::VectorXd b = root.cwiseProduct(y) / std::sqrt(roughness);
  e.lean = A.transpose() * unit;
  e.lean_value = unit.dot(b);
  e.straight = A - unit * e.lean.transpose();
  e.straight_values = b - unit * e.lean_value;
  // to unit variance, that of the true lean included
  const double sigma = surface ? params_.sigma_surface_deg
                               : (profile.kind == UprightProfile::Kind::kLineAway ? params_.sigma_line_away_deg
                                                                                  : params_.sigma_line_deg);
  const double per_lean2 = w.dot(z.cwiseProduct(z)) / roughness;
  const double scale = 1.0 / std::sqrt(1.0 + per_lean2 * std::pow(sigma * kDegree, 2));
  e.lean *= scale;
  e.lean_value *= scale;
  return e;
}

void VerticalReference::update() {
  report_.surfaces = report_.lines = 0;
  std::vector<Equations> all;
  for (const UprightProfile& profile : finder_.profiles()) {
    all.push_back(equationsOf(profile));
    if (profile.kind == UprightProfile::Kind::kSurface) ++report_.surfaces;
    if (profile.kind == UprightProfile::Kind::kLineAcross) ++report_.lines;
  }
  if (all.size() < kMinProfiles) return;
  const Eigen::VectorXd prior = x_;
  const Eigen::Index size = x_.size();
  Eigen::MatrixXd information, gain;
  double trust = 0.0;
  for (int iteration = 0; iteration < kReweightings; ++iteration) {
    information.setZero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    trust = 0.0;
    for (const Equations& e : all) {
      const double residual = e.lean_value - e.lean.dot(e.pick(x_));
      const double prior_variance = iteration == 0 ? e.leanVariance(P_) : 0.0;
      const double kernel2 = kKernelSigmas * kKernelSigmas * (1.0 + prior_variance);
      const double kernel_weight = gemanMcClureWeight(residual * residual, kernel2);
      trust += kernel_weight;
      const double weight = kernel_weight / params_.correlation_inflation;
      const Eigen::VectorXd at = e.pick(prior);
      const Eigen::MatrixXd H = weight * (e.lean * e.lean.transpose() + e.straight.transpose() * e.straight);
      const Eigen::VectorXd r = weight * (e.lean * (e.lean_value - e.lean.dot(at)) +
                                          e.straight.transpose() * (e.straight_values - e.straight * at));
      for (std::size_t i = 0; i < e.of.size(); ++i) {
        right[e.of[i]] += r[static_cast<Eigen::Index>(i)];
        for (std::size_t j = 0; j < e.of.size(); ++j) {
          information(e.of[i], e.of[j]) += H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        }
      }
    }
    const Eigen::MatrixXd M = Eigen::MatrixXd::Identity(size, size) + P_ * information;
    gain = M.partialPivLu().solve(P_);
    x_ = prior + gain * right;
  }
  if (!x_.allFinite() || !gain.allFinite()) {
    x_ = prior;
    return;
  }
  P_ = 0.5 * (gain + gain.transpose());
  if (trust < kMinTrust * static_cast<double>(all.size())) P_.diagonal().head<2>().array() += kLetGo * kLetGo;
}

void VerticalReference::setBend(const Pose& T_odom_lidar) {
  const Eigen::Vector2d lateral = lateralAxis(T_odom_lidar);
  const double variance = std::max(lateral.dot(P_.topLeftCorner<2, 2>() * lateral), 0.0);
  if (!kept_tilt_ && variance < kKnownTilt * kKnownTilt) kept_tilt_ = x_.head<2>();
  const double tilt = kept_tilt_ ? lateral.dot(x_.head<2>() - *kept_tilt_) : 0.0;
  const double limit = params_.max_curvature_deg_per_m * kDegree;
  const double unwanted = x_[kDrift] + params_.tilt_gain_per_m * tilt;
  curvature_per_m_ = std::clamp(unwanted / params_.response, -limit, limit);
  report_.tilt_deg = tilt / kDegree;
  report_.tilt_sigma_deg = std::sqrt(variance) / kDegree;
  report_.drift_deg_per_m = x_[kDrift] / kDegree;
  report_.drift_sigma_deg_per_m = std::sqrt(P_(kDrift, kDrift)) / kDegree;
  report_.elevation_deg = x_[kElevation] / kDegree;
  report_.curvature_deg_per_m = curvature_per_m_ / kDegree;
}

}  // namespace fail_aware
