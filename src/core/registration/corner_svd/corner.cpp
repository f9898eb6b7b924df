#include "core/registration/corner_svd/corner.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

// Difference between two corners; distance_m is infinite if the normals agree in neither order.
struct Difference {
  double distance_m;
  bool planes_swapped;
};

Difference difference(const Corner& a, const Corner& b, double min_cosine) {
  const auto agree = [&](std::size_t k, std::size_t l) {
    return a.planes[k].normal.dot(b.planes[l].normal) >= min_cosine;
  };
  const bool straight = agree(0, 0) && agree(1, 1), swapped = agree(0, 1) && agree(1, 0);
  if (!straight && !swapped) return {std::numeric_limits<double>::infinity(), false};
  return {(atHeight(a, b.M.z()).M - b.M).norm(), !straight};
}

}  // namespace

Corner movedCorner(const Pose& T_a_b, const Corner& corner_b) {
  Corner corner = corner_b;
  corner.M = T_a_b * corner_b.M;
  corner.J = T_a_b * corner_b.J;
  corner.N = T_a_b * corner_b.N;
  for (Corner::Plane& plane : corner.planes) {
    plane.normal = T_a_b.linear() * plane.normal;
    plane.rectangle = {T_a_b * plane.rectangle.low, T_a_b * plane.rectangle.high};
  }
  return corner;
}

std::vector<Corner> movedCorners(const Pose& T_a_b, const std::vector<Corner>& corners_b) {
  std::vector<Corner> corners;
  for (const Corner& corner : corners_b) corners.push_back(movedCorner(T_a_b, corner));
  return corners;
}

Corner atHeight(const Corner& corner_odom, double z_odom_m) {
  const Eigen::Vector3d direction = corner_odom.lineDirection();
  const Eigen::Vector3d slide = (z_odom_m - corner_odom.M.z()) / direction.z() * direction;
  Corner corner = corner_odom;
  corner.M += slide;
  corner.J += slide;
  corner.N += slide;
  return corner;
}

Corner withOtherPlane(const Corner& corner_odom) {
  Corner corner = corner_odom;
  std::swap(corner.planes[0], corner.planes[1]);
  const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(corner.planes[0].normal).normalized();
  corner.N = corner.M + (along.x() < 0.0 ? -Corner::kPlaneLength : Corner::kPlaneLength) * along;
  return corner;
}

std::vector<CornerPair> matchCorners(const std::vector<Corner>& corners_odom, const std::vector<Corner>& others_odom,
                                     double distance_m, double angle_deg) {
  const double min_cosine = std::cos(angle_deg * kDegree);
  struct Nearest {
    int index = -1;
    Difference how{std::numeric_limits<double>::infinity(), false};
  };
  std::vector<Nearest> nearest_other(corners_odom.size()), nearest_corner(others_odom.size());
  for (std::size_t i = 0; i < corners_odom.size(); ++i) {
    for (std::size_t j = 0; j < others_odom.size(); ++j) {
      const Difference d = difference(corners_odom[i], others_odom[j], min_cosine);
      if (!(d.distance_m < distance_m)) continue;
      if (d.distance_m < nearest_other[i].how.distance_m) nearest_other[i] = {static_cast<int>(j), d};
      if (d.distance_m < nearest_corner[j].how.distance_m) nearest_corner[j] = {static_cast<int>(i), d};
    }
  }
  std::vector<CornerPair> pairs;
  for (std::size_t i = 0; i < corners_odom.size(); ++i) {
    const Nearest& nearest = nearest_other[i];
    if (nearest.index < 0) continue;
    const auto j = static_cast<std::size_t>(nearest.index);
    if (nearest_corner[j].index != static_cast<int>(i)) continue;
    const Corner corner = atHeight(corners_odom[i], others_odom[j].M.z());
    pairs.push_back({i, j, nearest.how.planes_swapped ? withOtherPlane(corner) : corner});
  }
  return pairs;
}

}  // namespace fail_aware
