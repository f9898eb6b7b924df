#include "fail_aware_lidar_odometry/core/cloud/voxel_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr float kNowhere = 1e18f;  // a coordinate of what is no point, m; its distance is finite and beyond any limit
constexpr double kUpright = 0.8;   // cosine of a post's tilt; a single scan line, thin too, lies flatter

/// False for what is not finite or has no voxel: |v| >= 1e9.
bool isInReach(const Eigen::Vector3d& scaled) { return scaled.squaredNorm() < 1e18; }

}  // namespace

void VoxelMap::Params::validate() const {
  requireWithin("voxel_size_m", voxel_size_m, 0.01, 100.0);
  requireWithin("max_points", max_points, 1, kMaxPoints);
  requireNotNegative("min_point_spacing_m", min_point_spacing_m);
  requireWithin("min_plane_samples", min_plane_samples, 3, 1e6);
  requireWithin("max_samples", max_samples, min_plane_samples, 1e6);
  requirePositive("max_plane_sigma_m", max_plane_sigma_m);
  requireWithin("min_plane_flatness", min_plane_flatness, 1.0, 1e6);
}

VoxelMap::VoxelMap(const Params& params) : params_(params), inverse_size_(1.0 / params.voxel_size_m) {
  params_.validate();
  slots_ = (static_cast<std::size_t>(params_.max_points) + kLane - 1) / kLane * kLane;
}

void VoxelMap::reserve(std::size_t voxels) {
  voxels_.reserve(voxels);
  points_.reserve(voxels * 3 * slots_);
  point_counts_.reserve(voxels);
}

std::uint32_t VoxelMap::findOrAdd(std::int32_t x, std::int32_t y, std::int32_t z) {
  const VoxelKey key = packVoxel(x, y, z);
  const auto [it, added] = index_.try_emplace(key, static_cast<std::uint32_t>(voxels_.size()));
  if (added) {
    Voxel voxel;
    voxel.key = key;
    voxel.x = x;
    voxel.y = y;
    voxel.z = z;
    voxels_.push_back(voxel);
    points_.resize(points_.size() + 3 * slots_, kNowhere);
    point_counts_.push_back(0);
  }
  return it->second;
}

void VoxelMap::insert(const std::vector<Eigen::Vector3f>& points, const Pose& T_odom_points) {
  const auto max_points = static_cast<std::size_t>(params_.max_points);
  const auto spacing2 = static_cast<float>(params_.min_point_spacing_m * params_.min_point_spacing_m);
  const auto max_samples = static_cast<float>(params_.max_samples);
  const Eigen::Matrix3d R = T_odom_points.linear();
  const Eigen::Vector3d t = T_odom_points.translation();
  touched_.clear();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d p = R * point.cast<double>() + t;
    const Eigen::Vector3d scaled = p * inverse_size_;
    if (!isInReach(scaled)) continue;
    const std::int32_t x = fastFloor(scaled.x()), y = fastFloor(scaled.y()), z = fastFloor(scaled.z());
    const std::uint32_t i = findOrAdd(x, y, z);
    Voxel& voxel = voxels_[i];
    Statistics& s = voxel.statistics;
    if (s.n >= max_samples) continue;
    const Eigen::Vector3f local = (p - centreOf(voxel)).cast<float>();
    s.n += 1.0f;
    s.sum += local;
    s.xx += local.x() * local.x();
    s.xy += local.x() * local.y();
    s.xz += local.x() * local.z();
    s.yy += local.y() * local.y();
    s.yz += local.y() * local.z();
    s.zz += local.z() * local.z();
    if (!voxel.touched) {
      voxel.touched = true;
      touched_.push_back(i);
    }
    const std::size_t count = point_counts_[i];
    if (count < max_points) {
      float* const xs = &points_[3 * slots_ * i];
      float *const ys = xs + slots_, *const zs = ys + slots_;
      bool spaced = true;
      for (std::size_t k = 0; k < count && spaced; ++k) {
        spaced = (Eigen::Vector3f(xs[k], ys[k], zs[k]) - local).squaredNorm() >= spacing2;
      }
      if (spaced) {
        xs[count] = local.x();
        ys[count] = local.y();
        zs[count] = local.z();
        ++point_counts_[i];
      }
    }
  }
  for (const std::uint32_t i : touched_) {
    Voxel& voxel = voxels_[i];
    voxel.touched = false;
    const Statistics& s = voxel.statistics;
    if (s.n >= static_cast<float>(params_.min_plane_samples) && (s.n >= 1.25f * s.fitted_n || s.n >= max_samples)) {
      fitPlane(voxel);
    }
  }
}

void VoxelMap::fitPlane(Voxel& voxel) const {
  Statistics& s = voxel.statistics;
  s.fitted_n = s.n;
  const Eigen::Vector3f mean = s.sum / s.n;
  Eigen::Matrix3f C;
  C(0, 0) = s.xx / s.n - mean.x() * mean.x();
  C(1, 0) = s.xy / s.n - mean.x() * mean.y();
  C(2, 0) = s.xz / s.n - mean.x() * mean.z();
  C(1, 1) = s.yy / s.n - mean.y() * mean.y();
  C(2, 1) = s.yz / s.n - mean.y() * mean.z();
  C(2, 2) = s.zz / s.n - mean.z() * mean.z();
  C(0, 1) = C(1, 0);
  C(0, 2) = C(2, 0);
  C(1, 2) = C(2, 1);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(C.cast<double>());
  const Eigen::Vector3d& lambda = solver.eigenvalues();
  const double smallest = std::max(lambda[0], 1e-6);
  const bool plane = smallest <= params_.max_plane_sigma_m * params_.max_plane_sigma_m &&
                     lambda[1] >= params_.min_plane_flatness * smallest;
  voxel.plane.samples = plane ? s.n : 0.0f;
  voxel.plane.mean = mean;
  voxel.plane.normal = solver.eigenvectors().col(0).cast<float>();
  voxel.plane.variance = static_cast<float>(smallest);
  voxel.plane.post = !plane && lambda[1] <= params_.max_plane_sigma_m * params_.max_plane_sigma_m &&
                     lambda[2] >= params_.min_plane_flatness * lambda[1] &&
                     std::abs(solver.eigenvectors()(2, 2)) >= kUpright;
}

void VoxelMap::removeFartherThan(double range_m, const Eigen::Vector3d& position_odom) {
  const double range2 = range_m * range_m;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    if ((centreOf(voxels_[i]) - position_odom).squaredNorm() > range2) continue;
    if (kept != i) {
      voxels_[kept] = voxels_[i];
      point_counts_[kept] = point_counts_[i];
      std::copy_n(points_.begin() + static_cast<std::ptrdiff_t>(i * 3 * slots_), 3 * slots_,
                  points_.begin() + static_cast<std::ptrdiff_t>(kept * 3 * slots_));
    }
    ++kept;
  }
  if (kept == voxels_.size()) return;
  voxels_.resize(kept);
  points_.resize(kept * 3 * slots_);
  point_counts_.resize(kept);
  index_.clear();
  for (std::size_t i = 0; i < kept; ++i) index_.emplace(voxels_[i].key, static_cast<std::uint32_t>(i));
}

void VoxelMap::clear() {
  index_.clear();
  voxels_.clear();
  points_.clear();
  point_counts_.clear();
}

bool VoxelMap::findPlane(const Eigen::Vector3d& query_odom, PlaneMatch& match) const {
  const Eigen::Vector3d scaled = query_odom * inverse_size_;
  if (!isInReach(scaled)) return false;
  const std::int32_t x = fastFloor(scaled.x()), y = fastFloor(scaled.y()), z = fastFloor(scaled.z());
  const auto consider = [&](std::int32_t vx, std::int32_t vy, std::int32_t vz) {
    const auto it = index_.find(packVoxel(vx, vy, vz));
    if (it == index_.end()) return false;
    const Voxel& voxel = voxels_[it->second];
    if (voxel.plane.samples <= 0.0f) return false;
    const Eigen::Vector3f local = (query_odom - centreOf(voxel)).cast<float>();
    match.normal = voxel.plane.normal;
    match.distance_m = voxel.plane.normal.dot(local - voxel.plane.mean);
    match.variance = voxel.plane.variance;
    match.samples = voxel.plane.samples;
    match.voxel = it->second;
    return true;
  };
  if (consider(x, y, z)) return true;
  // neighbours across the nearest face of each axis, nearest first
  const Eigen::Vector3d f = scaled - Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
  int order[3] = {0, 1, 2};
  const auto nearer = [&](int a, int b) { return std::abs(f[a]) > std::abs(f[b]); };
  if (nearer(order[1], order[0])) std::swap(order[0], order[1]);
  if (nearer(order[2], order[1])) std::swap(order[1], order[2]);
  if (nearer(order[1], order[0])) std::swap(order[0], order[1]);
  for (const int axis : order) {
    const int step = f[axis] > 0.0 ? 1 : -1;
    if (consider(x + (axis == 0 ? step : 0), y + (axis == 1 ? step : 0), z + (axis == 2 ? step : 0))) return true;
  }
  return false;
}

bool VoxelMap::findNearest(const Eigen::Vector3d& query_odom, double max_distance_m, PointMatch& match) const {
  const Eigen::Vector3d scaled = query_odom * inverse_size_;
  if (!isInReach(scaled)) return false;
  // the eight voxels around the corner of the grid nearest to the query, its own first; `gap2_m2`: how far away the
  // others begin, along each axis, squared
  Eigen::Vector3f gap2_m2;
  std::int32_t cell[3][2];  // axis; the query's own, the other
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t upper = fastFloor(scaled[axis] + 0.5);
    const double beyond = scaled[axis] - static_cast<double>(upper), gap_m = params_.voxel_size_m * beyond;
    const bool own_is_upper = beyond >= 0.0;
    cell[axis][0] = own_is_upper ? upper : upper - 1;
    cell[axis][1] = own_is_upper ? upper - 1 : upper;
    gap2_m2[axis] = static_cast<float>(gap_m * gap_m);
  }
  using Lane = Eigen::Array<float, static_cast<int>(kLane), 1>;
  const auto lane = [](const float* values) { return Eigen::Map<const Lane>(values); };
  float best = static_cast<float>(max_distance_m * max_distance_m);
  bool found = false;
  for (const int far : {0, 1, 2, 4, 3, 5, 6, 7}) {  // bits: the axes across whose face the voxel lies
    const bool far_x = (far & 1) != 0, far_y = (far & 2) != 0, far_z = (far & 4) != 0;
    const float gap2 = (far_x ? gap2_m2.x() : 0.0f) + (far_y ? gap2_m2.y() : 0.0f) + (far_z ? gap2_m2.z() : 0.0f);
    if (gap2 >= best) continue;
    const std::int32_t vx = cell[0][far_x], vy = cell[1][far_y], vz = cell[2][far_z];
    const auto it = index_.find(packVoxel(vx, vy, vz));
    if (it == index_.end()) continue;
    const Eigen::Vector3f local = (query_odom - centreOf(vx, vy, vz)).cast<float>();
    const float* const x = &points_[3 * slots_ * it->second];
    const float *const y = x + slots_, *const z = y + slots_;
    const std::size_t count = point_counts_[it->second];
    for (std::size_t k = 0; k < count; k += kLane) {
      const Lane dx = lane(x + k) - local.x(), dy = lane(y + k) - local.y(), dz = lane(z + k) - local.z();
      const Lane d2 = dx * dx + (dy * dy + dz * dz);
      if (!(d2.minCoeff() < best)) continue;
      Eigen::Index nearest = 0;
      best = d2.minCoeff(&nearest);
      match.offset_m = {dx[nearest], dy[nearest], dz[nearest]};
      match.distance2_m2 = best;
      match.voxel = it->second;
      found = true;
    }
  }
  return found;
}

std::vector<Eigen::Vector3d> VoxelMap::points() const {
  std::vector<Eigen::Vector3d> all;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    const float* const x = &points_[3 * slots_ * i];
    for (std::size_t k = 0; k < point_counts_[i]; ++k) {
      all.push_back(centreOf(voxels_[i]) + Eigen::Vector3f(x[k], x[k + slots_], x[k + 2 * slots_]).cast<double>());
    }
  }
  return all;
}

}  // namespace fail_aware
