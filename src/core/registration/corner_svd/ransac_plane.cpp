#include "core/registration/corner_svd/ransac_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

constexpr int kRefinements = 2;

struct Plane {
  Eigen::Vector3d normal;
  double d_m;
};

// Uniform in [0, bound) by multiplication: the same on every platform, unlike the standard's distributions.
std::size_t drawBelow(std::mt19937& generator, std::size_t bound) {
  const std::uint64_t bits = static_cast<std::uint32_t>(generator());
  return static_cast<std::size_t>((bits * static_cast<std::uint64_t>(bound)) >> 32);
}

// Horizontal coordinates of one random point from each of `count` equal parts of the points.
void drawSample(const std::vector<Eigen::Vector3f>& points, std::size_t count, const Eigen::Vector3f& axis_u,
                const Eigen::Vector3f& axis_v, std::mt19937& generator, Eigen::ArrayXf& u, Eigen::ArrayXf& v) {
  u.resize(static_cast<Eigen::Index>(count));
  v.resize(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * points.size() / count, end = (i + 1) * points.size() / count;
    const Eigen::Vector3f& p = points[begin + drawBelow(generator, end - begin)];
    u(static_cast<Eigen::Index>(i)) = axis_u.dot(p);
    v(static_cast<Eigen::Index>(i)) = axis_v.dot(p);
  }
}

// Draws needed so that, with the given confidence, one pair holds inliers only.
double drawsNeeded(double inlier_ratio, double confidence) {
  const double pair = inlier_ratio * inlier_ratio;
  if (pair >= 1.0) return 1.0;
  return pair > 0.0 ? std::log(1.0 - confidence) / std::log1p(-pair) : std::numeric_limits<double>::infinity();
}

void selectInliers(const std::vector<Eigen::Vector3f>& points, const Plane& plane, double distance_m,
                   std::vector<int>& inliers) {
  const Eigen::Vector3f n = plane.normal.cast<float>();
  const float d = static_cast<float>(plane.d_m), limit = static_cast<float>(distance_m);
  inliers.resize(points.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    inliers[count] = static_cast<int>(i);
    count += std::abs(n.x() * p.x() + n.y() * p.y() + n.z() * p.z() + d) < limit ? 1 : 0;
  }
  inliers.resize(count);
}

// Total least squares: the direction of least variance. Returns the RMS distance. Sums of scalars: with outer products of
// vectors all corners of a sweep take 4.3 ms in place of 3.0 ms.
double fitPlane(const std::vector<Eigen::Vector3f>& points, const std::vector<int>& indices, Plane& plane) {
  const Eigen::Vector3d origin = points[static_cast<std::size_t>(indices.front())].cast<double>();
  double sx = 0, sy = 0, sz = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (const int index : indices) {
    const Eigen::Vector3f& p = points[static_cast<std::size_t>(index)];
    const double x = static_cast<double>(p.x()) - origin.x(), y = static_cast<double>(p.y()) - origin.y(),
                 z = static_cast<double>(p.z()) - origin.z();
    sx += x, sy += y, sz += z;
    xx += x * x, xy += x * y, xz += x * z, yy += y * y, yz += y * z, zz += z * z;
  }
  const double n = static_cast<double>(indices.size());
  const Eigen::Vector3d mean(sx / n, sy / n, sz / n);
  Eigen::Matrix3d covariance;
  covariance << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  covariance = covariance / n - mean * mean.transpose();
  const auto eigen = symmetricEigen(covariance);
  plane.normal = eigen.eigenvectors().col(0);
  plane.d_m = -plane.normal.dot(origin + mean);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()(0)));
}

}  // namespace

RansacPlane ransacPlane(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& up,
                        const RansacPlane::Params& params, std::uint32_t seed) {
  RansacPlane result;
  if (points.size() < static_cast<std::size_t>(params.min_inliers)) return result;
  std::mt19937 generator(seed);
  const Eigen::Vector3d axis_u = up.unitOrthogonal(), axis_v = up.cross(axis_u);
  const double share = std::ceil(params.sample_ratio * static_cast<double>(points.size()));
  const std::size_t count =
      std::min({points.size(), static_cast<std::size_t>(params.max_sample_points), static_cast<std::size_t>(share)});
  Eigen::ArrayXf u, v;
  drawSample(points, count, axis_u.cast<float>(), axis_v.cast<float>(), generator, u, v);

  // Score of a hypothesis: the mean of min((distance / inlier distance)^2, 1); 1 - score never exceeds the inlier
  // ratio.
  const float inverse_distance = static_cast<float>(1.0 / params.inlier_distance_m);
  const double least_ratio = static_cast<double>(params.min_inliers) / static_cast<double>(points.size());
  float best_score = std::numeric_limits<float>::infinity();
  Eigen::Vector3f best_line = Eigen::Vector3f::Zero();  // (n_u, n_v, c), in inlier distances
  double needed = params.iterations;
  if (params.stop_early) needed = std::min(needed, drawsNeeded(least_ratio, params.confidence));
  for (; result.iterations < needed; ++result.iterations) {
    const Eigen::Index i = static_cast<Eigen::Index>(drawBelow(generator, count));
    const Eigen::Index j = static_cast<Eigen::Index>(drawBelow(generator, count));
    const float du = u(j) - u(i), dv = v(j) - v(i), length = std::sqrt(du * du + dv * dv);
    if (length * inverse_distance < 1.0F) continue;
    const float n_u = -dv / length * inverse_distance, n_v = du / length * inverse_distance;
    const float c = -(n_u * u(i) + n_v * v(i));
    const float score = (n_u * u + n_v * v + c).square().min(1.0F).sum();
    if (score >= best_score) continue;
    best_score = score;
    best_line << n_u, n_v, c;
    if (!params.stop_early) continue;
    const double inlier_ratio = 1.0 - static_cast<double>(score) / static_cast<double>(count);
    needed = std::min(needed, drawsNeeded(inlier_ratio, params.confidence));
  }
  if (!std::isfinite(best_score)) return result;

  const Eigen::Vector3d line = best_line.cast<double>() * params.inlier_distance_m;
  Plane plane{(line.x() * axis_u + line.y() * axis_v).normalized(), line.z()};
  for (int refinement = 0; refinement <= kRefinements; ++refinement) {
    selectInliers(points, plane, params.inlier_distance_m, result.inliers);
    if (result.inliers.size() < static_cast<std::size_t>(params.min_inliers)) return result;
    if (refinement == kRefinements) break;
    result.rms_m = fitPlane(points, result.inliers, plane);
  }
  if (std::abs(plane.normal.dot(up)) > std::sin(params.max_tilt_deg * kDegree)) return result;
  const double sign = plane.d_m < 0.0 ? -1.0 : 1.0;
  result.normal = sign * plane.normal;
  result.d_m = sign * plane.d_m;
  result.found = result.normal.allFinite() && std::isfinite(result.d_m);
  return result;
}

}  // namespace fail_aware
