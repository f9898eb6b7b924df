#include "core/preprocessing/vertical_reference.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <iterator>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/robust_kernel.hpp"
#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr double kStartTilt = 0.1;  // rad: mount and slope at the start
constexpr double kRangeEdges_m[] = {7.0, 10.0, 14.0, 20.0};
constexpr float kMaxNormalZ = 0.26f;  // 15 deg: steeper surfaces are not meant to be upright
constexpr float kMinLineZ = 0.96f;
constexpr float kLineShape = 10.0f;    // largest over middle eigenvalue
constexpr float kSurfaceShape = 5.0f;  // middle over smallest
constexpr float kMaxLineSigma_m = 0.12f;
constexpr double kMaxLineError = 4.0 * kDegree;
constexpr double kLineErrorRatio = 0.45;  // of a trunk: its width is no noise, all beams see the same near half
constexpr double kKernelSigmas = 2.0;
constexpr double kMinTrust = 0.3;  // mean robust weight below which the tilt is let go
constexpr double kLetGo = 1.0 * kDegree;
constexpr std::size_t kMinUprights = 6;

int rangeIndex(double range_m) {
  return static_cast<int>(std::upper_bound(std::begin(kRangeEdges_m), std::end(kRangeEdges_m), range_m) -
                          std::begin(kRangeEdges_m));
}

Eigen::Vector2d lateralAxis(const Pose& T_odom_lidar) {
  const Eigen::Vector2d lateral = T_odom_lidar.linear().col(1).head<2>();
  return lateral / std::max(lateral.norm(), 1e-9);
}

}  // namespace

void LevelKeepingParams::validate() const {
  requirePositive("look_every_m", look_every_m);
  requireWithin("column_m", column_m, 0.1, 10.0);
  requireNotNegative("min_range_m", min_range_m);
  requireParameter(max_range_m > min_range_m && max_range_m <= 100.0 * column_m, "max_range_m", max_range_m,
                   "> min_range_m and <= 100 column_m");
  requireWithin("min_height_m", min_height_m, -100.0, 100.0);
  requireParameter(max_height_m > min_height_m, "max_height_m", max_height_m, "> min_height_m");
  requireAtMost("max_height_m", max_height_m, 100.0);
  requireWithin("min_points", min_points, 4, 1e6);
  requirePositive("min_extent_m", min_extent_m);
  requireWithin("beam_step_deg", beam_step_deg, 0.01, 10.0);
  requirePositive("max_standard_error_deg", max_standard_error_deg);
  requirePositive("sigma_surface_deg", sigma_surface_deg);
  requirePositive("sigma_line_deg", sigma_line_deg);
  requirePositive("sigma_lean_deg", sigma_lean_deg);
  requireNotNegative("sigma_place_deg", sigma_place_deg);
  requirePositive("place_length_m", place_length_m);
  requirePositive("sigma_drift_deg_per_m", sigma_drift_deg_per_m);
  requireNotNegative("drift_walk_deg_per_m", drift_walk_deg_per_m);
  requirePositive("tilt_walk_deg", tilt_walk_deg);
  requireWithin("correlation_inflation", correlation_inflation, 1.0, 1e6);
  requireWithin("tilt_gain_per_m", tilt_gain_per_m, 0.0, 1.0);
  requireWithin("drift_gain", drift_gain, 0.0, 1.0);
  requireWithin("response", response, 0.1, 1.0);
  requireWithin("max_curvature_deg_per_m", max_curvature_deg_per_m, 0.0, 0.1);
  requirePositive("curvature_range_m", curvature_range_m);
}

VerticalReference::VerticalReference(const Params& params) : params_(params) {
  params_.validate();
  cells_ = 2 * static_cast<int>(std::ceil(params_.max_range_m / params_.column_m));
  reset();
}

void VerticalReference::reset() {
  report_ = Report();
  curvature_per_m_ = 0.0;
  x_.setZero();
  P_.setZero();
  P_(2, 2) = std::pow(params_.sigma_drift_deg_per_m * kDegree, 2);
  static_assert(std::size(kRangeEdges_m) + 1 == kRanges);
  P_.diagonal().segment<kRanges>(5).setConstant(std::pow(params_.sigma_lean_deg * kDegree, 2));
  forgetOdom();
  since_look_m_ = 0.0;
  odom_reset_count_ = 0;
}

/// What is known about odom's axes: tilt now and tilt at the start (the same, and unknown), and the place's lean.
void VerticalReference::forgetOdom() {
  for (const int i : {0, 1, 3, 4, kPlace, kPlace + 1}) {
    x_[i] = 0.0;
    P_.row(i).setZero();
    P_.col(i).setZero();
  }
  for (const int i : {0, 1}) {
    P_(i, i) = P_(i + 3, i + 3) = P_(i, i + 3) = P_(i + 3, i) = kStartTilt * kStartTilt;
    P_(i + 3, i + 3) += 1e-12;
  }
  P_.diagonal().tail<2>().setConstant(std::pow(params_.sigma_place_deg * kDegree, 2));
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

void VerticalReference::observe(const std::vector<Eigen::Vector3f>& points_lidar, const Pose& T_odom_lidar,
                                int odom_reset_count) {
  if (!params_.enabled || !isFinite(T_odom_lidar)) return;
  if (odom_reset_count != odom_reset_count_) forgetOdom();
  odom_reset_count_ = odom_reset_count;
  advance(T_odom_lidar);
  if (since_look_m_ >= params_.look_every_m) {
    since_look_m_ = 0.0;
    fillColumns(points_lidar, T_odom_lidar.linear().cast<float>());
    findUprights();
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
  Covariance F = Covariance::Identity();
  F.block<2, 1>(0, 2) = way * lateral;
  const double kept = std::exp(-way / params_.place_length_m);
  F.diagonal().tail<2>().setConstant(kept);
  x_ = F * x_;
  x_.head<2>() -= way * params_.response * curvature_per_m_ * lateral;
  P_ = F * P_ * F.transpose();
  P_.diagonal().head<2>().array() += way * std::pow(params_.tilt_walk_deg * kDegree, 2);
  P_(2, 2) += way * std::pow(params_.drift_walk_deg_per_m * kDegree, 2);
  P_.diagonal().tail<2>().array() += (1.0 - kept * kept) * std::pow(params_.sigma_place_deg * kDegree, 2);
}

void VerticalReference::fillColumns(const std::vector<Eigen::Vector3f>& points_lidar,
                                    const Eigen::Matrix3f& R_odom_lidar) {
  columns_.assign(static_cast<std::size_t>(cells_ * cells_), Column());
  const auto low = static_cast<float>(params_.min_height_m), high = static_cast<float>(params_.max_height_m);
  const auto near2 = static_cast<float>(params_.min_range_m * params_.min_range_m);
  const auto far2 = static_cast<float>(params_.max_range_m * params_.max_range_m);
  const auto size = static_cast<float>(params_.column_m);
  const float per_cell = 1.0f / size;
  const auto beams_per_slope = static_cast<float>(1.0 / (params_.beam_step_deg * kDegree));
  const int half = cells_ / 2;
  for (const Eigen::Vector3f& q : points_lidar) {
    if (!(q.z() > low && q.z() < high)) continue;
    const float r2 = q.squaredNorm();
    if (!(r2 > near2 && r2 < far2)) continue;
    const Eigen::Vector3f p = R_odom_lidar * q;
    const int i = std::clamp(static_cast<int>(std::floor(p.x() * per_cell)) + half, 0, cells_ - 1);
    const int j = std::clamp(static_cast<int>(std::floor(p.y() * per_cell)) + half, 0, cells_ - 1);
    Column& c = columns_[static_cast<std::size_t>(i * cells_ + j)];
    const float x = p.x() - size * (static_cast<float>(i - half) + 0.5f);
    const float y = p.y() - size * (static_cast<float>(j - half) + 0.5f);
    const float z = p.z();
    c.low = c.n > 0.0f ? std::min(c.low, z) : z;
    c.high = c.n > 0.0f ? std::max(c.high, z) : z;
    c.n += 1.0f;
    const float slope = q.z() / std::sqrt(std::max(r2 - q.z() * q.z(), 1e-6f));
    const auto beam = static_cast<int>(std::floor(slope * beams_per_slope));
    c.beams |= std::uint64_t{1} << (static_cast<unsigned>(beam) & 63u);
    c.sum += Eigen::Vector3f(x, y, z);
    c.xx += x * x;
    c.xy += x * y;
    c.xz += x * z;
    c.yy += y * y;
    c.yz += y * z;
    c.zz += z * z;
  }
}

void VerticalReference::findUprights() {
  uprights_.clear();
  report_.surfaces = report_.lines = 0;
  const auto min_points = static_cast<float>(params_.min_points);
  const auto min_extent = static_cast<float>(params_.min_extent_m);
  const double sigma_surface = params_.sigma_surface_deg * kDegree;
  const double max_error = params_.max_standard_error_deg * kDegree;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Column& c = columns_[k];
    if (c.n < min_points || c.high - c.low < min_extent) continue;
    const Eigen::Vector3f mean = c.sum / c.n;
    Eigen::Matrix3f C;
    C << c.xx, c.xy, c.xz, c.xy, c.yy, c.yz, c.xz, c.yz, c.zz;
    C = (C / c.n - mean * mean.transpose()).eval();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
    eigen.computeDirect(C);
    const Eigen::Vector3f& l = eigen.eigenvalues();
    const int i = static_cast<int>(k) / cells_ - cells_ / 2, j = static_cast<int>(k) % cells_ - cells_ / 2;
    const Eigen::Vector2d centre(params_.column_m * (i + 0.5) + static_cast<double>(mean.x()),
                                 params_.column_m * (j + 0.5) + static_cast<double>(mean.y()));
    const double range = centre.norm();
    const Eigen::Vector2d away = centre / std::max(range, 1e-9);
    const double beams = static_cast<double>(std::bitset<64>(c.beams).count());
    const double error_per_thickness = std::sqrt(12.0 / beams) / static_cast<double>(c.high - c.low);
    if (l[2] > kLineShape * l[1] && l[1] < kMaxLineSigma_m * kMaxLineSigma_m) {
      const Eigen::Vector3d u = eigen.eigenvectors().col(2).cast<double>();
      const double error = std::sqrt(static_cast<double>(std::max(l[1], 0.0f))) * error_per_thickness;
      if (std::abs(u.z()) < static_cast<double>(kMinLineZ) || error > kMaxLineError) continue;
      const Eigen::Vector2d slope = u.head<2>() / u.z(), aside(-away.y(), away.x());
      const double sigma_aside = std::hypot(sigma_surface, kLineErrorRatio * error);
      const double sigma_away = std::hypot(params_.sigma_line_deg * kDegree, sigma_aside);
      uprights_.push_back({slope.dot(away), sigma_away, {-away.y(), away.x()}, 1.0, rangeIndex(range)});
      uprights_.push_back({slope.dot(aside), sigma_aside, {-aside.y(), aside.x()}, 0.0, rangeIndex(range)});
      ++report_.lines;
      continue;
    }
    const double error = std::sqrt(static_cast<double>(std::max(l[0], 0.0f))) * error_per_thickness;
    if (l[1] < kSurfaceShape * l[0] || error > max_error) continue;
    Eigen::Vector3d n = eigen.eigenvectors().col(0).cast<double>();
    if (std::abs(n.z()) > static_cast<double>(kMaxNormalZ)) continue;
    if (n.head<2>().dot(centre) > 0.0) n = -n;  // towards the sensor
    uprights_.push_back({n.z(), std::hypot(sigma_surface, error), {n.y(), -n.x()}, 1.0, rangeIndex(range)});
    ++report_.surfaces;
  }
}

void VerticalReference::update() {
  if (uprights_.size() < kMinUprights) return;
  const State x_prior = x_;
  Covariance information = Covariance::Zero();
  Covariance gain = Covariance::Zero();
  double trust = 0.0;
  for (int iteration = 0; iteration < 3; ++iteration) {
    information.setZero();
    State right = State::Zero();
    trust = 0.0;
    for (const Upright& u : uprights_) {
      State row = State::Zero();
      row.head<2>() = u.tilt;
      row.segment<2>(kPlace) = u.tilt;
      row[5 + u.range] = u.lean;
      const double residual = u.value - row.dot(x_);
      const double prior_variance = iteration == 0 ? row.dot(P_ * row) : 0.0;
      const double kernel2 = kKernelSigmas * kKernelSigmas * (u.sigma * u.sigma + prior_variance);
      const double kernel_weight = gemanMcClureWeight(residual * residual, kernel2);
      const double w = kernel_weight / (u.sigma * u.sigma * params_.correlation_inflation);
      information += w * row * row.transpose();
      right += w * (u.value - row.dot(x_prior)) * row;
      trust += kernel_weight;
    }
    gain = P_ * (Covariance::Identity() + information * P_).inverse();
    x_ = x_prior + gain * right;
  }
  if (!x_.allFinite()) {
    x_ = x_prior;
    return;
  }
  P_ -= gain * information * P_;
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  if (trust < kMinTrust * static_cast<double>(uprights_.size())) P_.diagonal().head<2>().array() += kLetGo * kLetGo;
}

void VerticalReference::setBend(const Pose& T_odom_lidar) {
  const Eigen::Vector2d lateral = lateralAxis(T_odom_lidar);
  const double tilt = (x_.head<2>() - x_.segment<2>(3)).dot(lateral);
  const double limit = params_.max_curvature_deg_per_m * kDegree;
  const double unwanted = params_.drift_gain * x_[2] + params_.tilt_gain_per_m * tilt;
  curvature_per_m_ = std::clamp(unwanted / params_.response, -limit, limit);
  Eigen::Matrix<double, 4, 1> row;
  row << lateral, -lateral;
  Eigen::Matrix4d C;
  const int of[] = {0, 1, 3, 4};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) C(i, j) = P_(of[i], of[j]);
  }
  report_.tilt_deg = tilt / kDegree;
  report_.tilt_sigma_deg = std::sqrt(std::max(row.dot(C * row), 0.0)) / kDegree;
  report_.drift_deg_per_m = x_[2] / kDegree;
  report_.drift_sigma_deg_per_m = std::sqrt(P_(2, 2)) / kDegree;
  report_.curvature_deg_per_m = curvature_per_m_ / kDegree;
}

}  // namespace fail_aware
