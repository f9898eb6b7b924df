#include "core/preprocessing/upright_profiles.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

constexpr double kColumn_m = 1.0;  // side of a column: holds a trunk, and little besides one wall
// Points used, by their distance from the sensor: nearer ones may be parts of the vehicle or its load, farther columns
// are hit by too few beams.
constexpr double kMinRange_m = 4.0, kMaxRange_m = 30.0;
constexpr int kCells = 2 * static_cast<int>(kMaxRange_m / kColumn_m);  // columns along a side of the grid
// Lowest and highest point of a column, above the sensor: the ground must be below, higher up are crowns and eaves.
constexpr float kMinHeight_m = -1.2f, kMaxHeight_m = 3.0f;
constexpr std::uint32_t kMinPoints = 12;  // of a column: fewer give no direction
constexpr float kMinExtent_m = 0.6f;      // from the lowest to the highest beam: lower things need not stand upright
constexpr std::size_t kMinBeams = 5;      // of a profile, each with two points or more
constexpr double kBeamStep_deg = 0.4;     // sweeps without rings: elevations that are nearer than this are one beam

constexpr float kMaxNormalZ = 0.2f;  // 12 deg: steeper surfaces are not meant to be upright
constexpr float kMinLineZ = 0.96f;
constexpr float kLineShape = 10.0f;    // largest over middle eigenvalue
constexpr float kSurfaceShape = 8.0f;  // middle over smallest
constexpr float kMaxLineSigma_m = 0.12f;
constexpr int kRefits = 4;
constexpr float kFarFromPlane_m = 0.3f;  // in the first fit, of all points
constexpr float kSurfaceKernel_m = 0.06f;
constexpr float kMinWeight = 0.3f;           // of points that count as the surface's
constexpr float kMinSurfaceRatio = 0.7f;     // of a column's points: with fewer, two things share the column
constexpr float kMinMeanObliqueness = 0.5f;  // surfaces that are seen at more grazing angles are met along, not through

struct Moments {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
};

template <class Point>
Moments momentsOf(const Point* points, std::size_t count, const std::vector<float>& weights) {
  float n = 0.0f;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  const Eigen::Vector3f origin = points[0].p;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f q = points[i].p - origin;
    const Eigen::Vector3f weighted = weights[i] * q;
    n += weights[i];
    sum += weighted;
    squares += q * weighted.transpose();
  }
  if (!(n > 0.0f)) return {};
  const Eigen::Vector3f mean = sum / n;
  return {mean + origin, squares / n - mean * mean.transpose()};
}

/// `l`: eigenvalues of the points' covariance, ascending.
bool isLine(const Eigen::Vector3f& l) { return l[2] > kLineShape * l[1] && l[1] < kMaxLineSigma_m * kMaxLineSigma_m; }

}  // namespace

void UprightProfileFinder::find(const std::vector<Eigen::Vector3f>& points_lidar,
                                const std::vector<std::uint16_t>& rings, const std::vector<BeamRange>& ranges,
                                const Eigen::Matrix3d& R_odom_lidar) {
  profiles_.clear();
  beams_.clear();
  hangs_ = R_odom_lidar(2, 2) < 0.0;
  sortIntoColumns(points_lidar, rings, ranges, R_odom_lidar.cast<float>());
  for (const Column& c : columns_) {
    if (c.points >= kMinPoints && c.high - c.low >= kMinExtent_m) readColumn(&sorted_[c.first], c.points);
  }
}

std::uint32_t UprightProfileFinder::columnOf(const Eigen::Vector3f& p) const {
  constexpr auto per_cell = static_cast<float>(1.0 / kColumn_m);
  const auto cell = [&](float v) {
    return std::clamp(static_cast<int>(std::floor(v * per_cell)) + kCells / 2, 0, kCells - 1);
  };
  return static_cast<std::uint32_t>(cell(p.x()) * kCells + cell(p.y()));
}

void UprightProfileFinder::sortIntoColumns(const std::vector<Eigen::Vector3f>& points_lidar,
                                           const std::vector<std::uint16_t>& rings,
                                           const std::vector<BeamRange>& ranges, const Eigen::Matrix3f& R_odom_lidar) {
  columns_.assign(static_cast<std::size_t>(kCells * kCells), Column());
  unsorted_.clear();
  const bool has_rings = rings.size() == points_lidar.size();
  constexpr auto near2 = static_cast<float>(kMinRange_m * kMinRange_m);
  constexpr auto far2 = static_cast<float>(kMaxRange_m * kMaxRange_m);
  constexpr auto beams_per_slope = static_cast<float>(1.0 / (kBeamStep_deg * kDegree));
  for (std::size_t i = 0; i < points_lidar.size(); ++i) {
    const Eigen::Vector3f& q = points_lidar[i];
    if (!(q.z() > kMinHeight_m && q.z() < kMaxHeight_m)) continue;
    const float r2 = q.squaredNorm();
    if (!(r2 > near2 && r2 < far2)) continue;
    Point point;
    if (has_rings) {
      if (rings[i] >= kMaxBeams) continue;
      point.ring = rings[i];
    } else {
      const float slope = q.z() / std::sqrt(std::max(r2 - q.z() * q.z(), 1e-6f));
      const auto step = static_cast<int>(std::floor(slope * beams_per_slope));
      point.ring = static_cast<std::uint16_t>(static_cast<unsigned>(step) % kMaxBeams);
    }
    const BeamRange range = point.ring < ranges.size() ? ranges[point.ring] : BeamRange();
    point.kernel2_m2 = kSurfaceKernel_m * kSurfaceKernel_m + 4.0f * range.sigma_m * range.sigma_m;
    point.p = R_odom_lidar * ((1.0f - range.too_far_m / std::sqrt(r2)) * q);
    point.column = columnOf(point.p);
    Column& c = columns_[point.column];
    c.low = c.points > 0 ? std::min(c.low, point.p.z()) : point.p.z();
    c.high = c.points > 0 ? std::max(c.high, point.p.z()) : point.p.z();
    ++c.points;
    unsorted_.push_back(point);
  }
  std::uint32_t first = 0;
  for (Column& c : columns_) {
    c.first = first;
    first += c.points;
    c.points = 0;
  }
  sorted_.resize(unsorted_.size());
  for (const Point& point : unsorted_) {
    Column& c = columns_[point.column];
    sorted_[c.first + c.points++] = point;
  }
}

void UprightProfileFinder::readColumn(const Point* points, std::size_t count) {
  weights_.assign(count, 1.0f);
  Moments m = momentsOf(points, count, weights_);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
  eigen.computeDirect(m.covariance);
  if (isLine(eigen.eigenvalues())) {
    readLine(points[0].column, m.mean);
    return;
  }
  Eigen::Vector3f normal = eigen.eigenvectors().col(0);
  for (int refit = 0; refit <= kRefits; ++refit) {
    std::size_t members = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float r = normal.dot(points[i].p - m.mean);
      if (refit == 0) {
        weights_[i] = std::abs(r) < kFarFromPlane_m ? 1.0f : 0.0f;
      } else {
        const float kernel = points[i].kernel2_m2 / (points[i].kernel2_m2 + r * r);  // as robust_kernel.hpp
        weights_[i] = kernel * kernel;
      }
      if (weights_[i] > kMinWeight) ++members;
    }
    const bool last = refit == kRefits;
    const float ratio = static_cast<float>(members) / static_cast<float>(count);
    if (ratio < (last ? kMinSurfaceRatio : 0.5f * kMinSurfaceRatio)) return;
    if (last) break;
    m = momentsOf(points, count, weights_);
    eigen.computeDirect(m.covariance);
    normal = eigen.eigenvectors().col(0);
  }
  if (eigen.eigenvalues()[1] < kSurfaceShape * eigen.eigenvalues()[0] || !(std::abs(normal.z()) < kMaxNormalZ)) return;
  addProfile(UprightProfile::Kind::kSurface, normal.head<2>().normalized(), m.mean, points, count);
}

/// Judged with all that stands around it; of the columns that share a trunk, that of its middle counts.
void UprightProfileFinder::readLine(std::uint32_t column, const Eigen::Vector3f& middle) {
  const auto reach = static_cast<float>(0.5 * kColumn_m);
  const int x = static_cast<int>(column) / kCells, y = static_cast<int>(column) % kCells;
  around_.clear();
  for (int i = std::max(x - 1, 0); i <= std::min(x + 1, kCells - 1); ++i) {
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kCells - 1); ++j) {
      const Column& c = columns_[static_cast<std::size_t>(i * kCells + j)];
      for (std::uint32_t k = c.first; k < c.first + c.points; ++k) {
        if ((sorted_[k].p - middle).head<2>().squaredNorm() < reach * reach) around_.push_back(sorted_[k]);
      }
    }
  }
  if (around_.empty()) return;  // two things in the corners, and nothing in the middle
  weights_.assign(around_.size(), 1.0f);
  const Moments m = momentsOf(around_.data(), around_.size(), weights_);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
  eigen.computeDirect(m.covariance);
  if (!isLine(eigen.eigenvalues()) || std::abs(eigen.eigenvectors()(2, 2)) < kMinLineZ || columnOf(m.mean) != column)
    return;
  const Eigen::Vector2f away = m.mean.head<2>().normalized();
  addProfile(UprightProfile::Kind::kLineAcross, {-away.y(), away.x()}, m.mean, around_.data(), around_.size());
  addProfile(UprightProfile::Kind::kLineAway, away, m.mean, around_.data(), around_.size());
}

void UprightProfileFinder::addProfile(UprightProfile::Kind kind, const Eigen::Vector2f& direction,
                                      const Eigen::Vector3f& centre, const Point* points, std::size_t count) {
  struct Sums {
    float n = 0, offset = 0, height = 0, obliqueness = 0, low = 0, high = 0;
  };
  std::array<Sums, kMaxBeams> sums{};
  for (std::size_t i = 0; i < count; ++i) {
    if (!(weights_[i] > kMinWeight)) continue;
    const Eigen::Vector3f& p = points[i].p;
    const float offset = direction.dot(p.head<2>() - centre.head<2>());
    Sums& s = sums[points[i].ring];
    s.low = s.n > 0 ? std::min(s.low, offset) : offset;
    s.high = s.n > 0 ? std::max(s.high, offset) : offset;
    s.n += 1;
    s.offset += offset;
    s.height += p.z();
    s.obliqueness += direction.dot(p.head<2>()) / p.norm();
  }
  const Eigen::Vector2d sight = centre.head<2>().cast<double>().normalized();
  UprightProfile profile{kind, direction.cast<double>(), hangs_ ? -sight : sight, beams_.size(), 0, 0.0f};
  float low = 0, high = 0, oblique = 0;
  for (std::size_t ring = 0; ring < kMaxBeams; ++ring) {
    const Sums& s = sums[ring];
    if (s.n < 2) continue;
    const bool across = kind == UprightProfile::Kind::kLineAcross;
    const float height = s.height / s.n;
    low = profile.size > 0 ? std::min(low, height) : height;
    high = profile.size > 0 ? std::max(high, height) : height;
    oblique += std::abs(s.obliqueness / s.n);
    beams_.push_back({static_cast<std::uint16_t>(ring), s.n, across ? 0.5f * (s.low + s.high) : s.offset / s.n, height,
                      across ? 0.0f : s.obliqueness / s.n});
    ++profile.size;
  }
  const bool grazing = kind == UprightProfile::Kind::kSurface &&
                       oblique < kMinMeanObliqueness * static_cast<float>(std::max<std::size_t>(profile.size, 1));
  if (profile.size < kMinBeams || grazing || high - low < kMinExtent_m) {
    beams_.resize(profile.first);
    return;
  }
  profile.top_m = high;
  profiles_.push_back(profile);
}

}  // namespace fail_aware
