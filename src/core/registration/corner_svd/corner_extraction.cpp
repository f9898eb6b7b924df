#include "core/registration/corner_svd/corner_extraction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/geometry/degree.hpp"
#include "core/registration/corner_svd/dbscan.hpp"

namespace fail_aware {

namespace {

constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();
constexpr float kMaxHeight = 1000.0F;       // m; greater heights are not valid measurements
constexpr double kSyntheticHeight_m = 0.0;  // of M, above the frame's origin: a convention, see corner.hpp

float verticalExtent(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& up) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const Eigen::Vector3f& p : points) {
    const float height = up.dot(p);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return points.empty() ? 0.0F : high - low;
}

int countNearLine(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& on_line,
                  const Eigen::Vector3d& direction, double distance_m) {
  const Eigen::Vector3f origin = on_line.cast<float>(), axis = direction.cast<float>();
  const float limit = static_cast<float>(distance_m * distance_m);
  int count = 0;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f offset = p - origin;
    const float along = offset.dot(axis);
    count += offset.squaredNorm() - along * along < limit ? 1 : 0;
  }
  return count;
}

Corner::Rectangle rectangleOf(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& on_line,
                              const Eigen::Vector3d& direction, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d across = direction.cross(normal).normalized();
  Eigen::Matrix<float, 2, 3> axes;
  axes << direction.transpose().cast<float>(), across.transpose().cast<float>();
  Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector2f place = axes * (p - on_line.cast<float>());
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  if (points.empty()) low = high = Eigen::Vector2f::Zero();
  const auto vertex = [&](const Eigen::Vector2f& v) {
    return (on_line + static_cast<double>(v.x()) * direction + static_cast<double>(v.y()) * across).eval();
  };
  return {vertex(low), vertex(high)};
}

// Corners with the most points first; a corner nearer than `distance_m` to a better one is dropped.
std::vector<Corner> withoutNeighbours(std::vector<Corner> corners, double distance_m) {
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.points() > b.points(); });
  std::vector<Corner> kept;
  for (const Corner& corner : corners) {
    const bool alone = std::none_of(kept.begin(), kept.end(),
                                    [&](const Corner& other) { return (other.M - corner.M).norm() < distance_m; });
    if (alone) kept.push_back(corner);
  }
  return kept;
}

}  // namespace

void CornerExtractor::Params::checkRules() const {
  requireParameter(std::isfinite(max_range_m) && max_range_m > min_range_m, "max_range_m", max_range_m,
                   "finite and > min_range_m", min_range_m);
  requireWithin("max_range_m", max_range_m, min_range_m, 1000.0);
  requireParameter(max_range_m / cell_m <= 5000.0, "cell_m", cell_m, ">= max_range_m / 5000");
}

CornerExtractor::CornerExtractor(const Params& params) : params_(params) {
  grid_width_ = 2 * (static_cast<int>(params_.max_range_m / params_.cell_m) + 2);  // one spare cell for rounding
  grid_.assign(static_cast<std::size_t>(grid_width_) * static_cast<std::size_t>(grid_width_), 0);
}

std::vector<Corner> CornerExtractor::extract(const Points& points, const Eigen::Matrix3d& R_odom_frame) {
  std::vector<Corner> corners;
  if (!R_odom_frame.allFinite()) return corners;
  const Eigen::Vector3d up = R_odom_frame.transpose().col(2);
  std::uint32_t seed = static_cast<std::uint32_t>(params_.seed);
  for (Points& cluster : clustersOf(cellsWithWalls(points))) {
    const std::vector<Plane> planes = findPlanes(std::move(cluster), up, seed++);
    for (std::size_t a = 0; a < planes.size(); ++a) {
      for (std::size_t b = a + 1; b < planes.size(); ++b) {
        Corner corner;
        if (makeCorner(planes[a], planes[b], R_odom_frame, corner)) corners.push_back(corner);
      }
    }
  }
  return withoutNeighbours(std::move(corners), params_.min_corner_distance_m);
}

// The points of the cells with enough beams.
std::vector<CornerExtractor::Points> CornerExtractor::cellsWithWalls(const Points& points) {
  const float inverse_cell = static_cast<float>(1.0 / params_.cell_m);
  const float inverse_step = static_cast<float>(1.0 / params_.height_step_m);
  const float middle = 0.5F * static_cast<float>(grid_width_);
  const float min_range2 = static_cast<float>(params_.min_range_m * params_.min_range_m);
  const float max_range2 = static_cast<float>(params_.max_range_m * params_.max_range_m);

  touched_.clear();
  cell_of_point_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    const float range2 = p.x() * p.x() + p.y() * p.y();
    cell_of_point_[i] = kNoCell;
    if (!(range2 >= min_range2 && range2 < max_range2 && std::abs(p.z()) < kMaxHeight)) continue;
    const int column = static_cast<int>(p.x() * inverse_cell + middle);
    const int row = static_cast<int>(p.y() * inverse_cell + middle);
    const std::uint32_t cell = static_cast<std::uint32_t>(row * grid_width_ + column);
    cell_of_point_[i] = cell;
    const auto step = static_cast<unsigned>((p.z() + kMaxHeight) * inverse_step);
    if (grid_[cell] == 0) touched_.push_back(cell);
    grid_[cell] |= std::uint64_t{1} << (step & 63U);
  }

  // From here a grid cell holds 0 or the index of the kept cell + 1.
  std::uint64_t kept = 0;
  for (const std::uint32_t cell : touched_) {
    grid_[cell] = static_cast<int>(std::bitset<64>(grid_[cell]).count()) >= params_.min_beams_per_cell ? ++kept : 0;
  }
  std::vector<Points> cells(kept);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (cell_of_point_[i] == kNoCell || grid_[cell_of_point_[i]] == 0) continue;
    cells[grid_[cell_of_point_[i]] - 1].push_back(points[i]);
  }
  for (const std::uint32_t cell : touched_) grid_[cell] = 0;
  return cells;
}

std::vector<CornerExtractor::Points> CornerExtractor::clustersOf(std::vector<Points> cells) const {
  if (!params_.cluster_cells) {
    std::vector<Points> single;  // a cell for each point
    for (const Points& cell : cells) {
      for (const Eigen::Vector3f& p : cell) single.push_back({p});
    }
    cells.swap(single);
  }
  std::vector<Eigen::Vector2f> places;
  std::vector<int> weights;
  for (const Points& cell : cells) {
    Eigen::Vector2f sum = Eigen::Vector2f::Zero();
    for (const Eigen::Vector3f& p : cell) sum += p.head<2>();
    weights.push_back(static_cast<int>(cell.size()));
    places.push_back(sum / static_cast<float>(cell.size()));
  }
  const std::vector<int> labels = dbscan2d(places, params_.dbscan_eps_m, params_.dbscan_min_points, weights);

  std::vector<Points> clusters;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    if (labels[k] < 0) continue;
    const auto label = static_cast<std::size_t>(labels[k]);
    clusters.resize(std::max(clusters.size(), label + 1));
    clusters[label].insert(clusters[label].end(), cells[k].begin(), cells[k].end());
  }
  const auto is_small = [&](const Points& cluster) {
    return cluster.size() < static_cast<std::size_t>(params_.min_cluster_points);
  };
  clusters.erase(std::remove_if(clusters.begin(), clusters.end(), is_small), clusters.end());
  return clusters;
}

std::vector<CornerExtractor::Plane> CornerExtractor::findPlanes(Points cluster, const Eigen::Vector3d& up,
                                                                std::uint32_t seed) const {
  std::vector<Plane> planes;
  for (int k = 0; k < params_.max_planes_per_cluster; ++k) {
    RansacPlane found = ransacPlane(cluster, up, params_.ransac, seed);
    if (!found.found) break;
    Plane plane{found.normal, found.d_m, found.rms_m, {}};
    plane.inliers.reserve(found.inliers.size());
    std::size_t next_inlier = 0, outliers = 0;
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      if (next_inlier < found.inliers.size() && static_cast<std::size_t>(found.inliers[next_inlier]) == i) {
        plane.inliers.push_back(cluster[i]);
        ++next_inlier;
      } else {
        cluster[outliers++] = cluster[i];
      }
    }
    cluster.resize(outliers);
    if (static_cast<double>(verticalExtent(plane.inliers, up.cast<float>())) < params_.min_plane_height_m) continue;
    planes.push_back(std::move(plane));
  }
  return planes;
}

bool CornerExtractor::makeCorner(const Plane& a, const Plane& b, const Eigen::Matrix3d& R_odom_frame,
                                 Corner& corner) const {
  const double angle = std::acos(std::clamp(a.normal.dot(b.normal), -1.0, 1.0));
  if (angle < params_.min_angle_deg * kDegree || angle > params_.max_angle_deg * kDegree) return false;

  const Eigen::Vector3d up = R_odom_frame.transpose().col(2);
  Eigen::Vector3d direction = a.normal.cross(b.normal).normalized();
  if (direction.dot(up) < 0.0) direction = -direction;
  if (direction.dot(up) < std::cos(params_.ransac.max_tilt_deg * kDegree)) return false;
  Eigen::Matrix3d planes;
  planes << a.normal.transpose(), b.normal.transpose(), up.transpose();
  corner.M = planes.inverse() * Eigen::Vector3d(-a.d_m, -b.d_m, kSyntheticHeight_m);
  if (!corner.M.allFinite() || corner.M.norm() > params_.max_range_m) return false;
  for (const Plane* plane : {&a, &b}) {
    if (params_.min_points_near_corner == 0) break;
    if (countNearLine(plane->inliers, corner.M, direction, params_.max_corner_gap_m) < params_.min_points_near_corner) {
      return false;
    }
  }

  // Horizontal directions of both planes; N lies in the plane closer to odom's x axis.
  const Eigen::Vector3d forward = R_odom_frame.transpose().col(0);
  const Eigen::Vector3d along_a = up.cross(a.normal).normalized(), along_b = up.cross(b.normal).normalized();
  const bool first = std::abs(along_a.dot(forward)) >= std::abs(along_b.dot(forward));
  const Eigen::Vector3d& along = first ? along_a : along_b;
  const Plane& reference = first ? a : b;
  const Plane& other = first ? b : a;
  corner.J = corner.M + Corner::kLineLength * direction;
  corner.N = corner.M + (along.dot(forward) < 0.0 ? -Corner::kPlaneLength : Corner::kPlaneLength) * along;
  const auto described = [&](const Plane& plane) {
    return Corner::Plane{plane.normal, plane.rms_m, static_cast<int>(plane.inliers.size()),
                         rectangleOf(plane.inliers, corner.M, direction, plane.normal)};
  };
  corner.planes = {described(reference), described(other)};
  return corner.J.allFinite() && corner.N.allFinite();
}

}  // namespace fail_aware
