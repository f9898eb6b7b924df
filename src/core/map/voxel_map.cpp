#include "core/map/voxel_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr float kNowhere = 1e18f;  // m, coordinate of an unused slot: its distance is finite and beyond any limit
constexpr double kUpright = 0.8;   // cosine of a post's largest tilt; a single scan line, also thin, lies flatter

/// False for a point that is not finite, or that has no voxel: |v| >= 1e9.
bool isInReach(const Eigen::Vector3d& scaled) { return scaled.squaredNorm() < 1e18; }

}  // namespace

void VoxelMap::Params::checkRules() const { requireWithin("max_samples", max_samples, min_plane_samples, 1e6); }

VoxelMap::VoxelMap(const Params& params) : params_(params), inverse_size_(1.0 / params.voxel_size_m) {
  slots_ = (static_cast<std::size_t>(params_.max_points) + kLane - 1) / kLane * kLane;
}

void VoxelMap::reserve(std::size_t voxels) {
  voxels_.reserve(voxels);
  points_.reserve(voxels * 3 * slots_);
  point_counts_.reserve(voxels);
  planes_.reserve(voxels);
}

std::uint32_t VoxelMap::findOrAdd(const Eigen::Vector3i& at) {
  const VoxelKey key = packVoxel(at.x(), at.y(), at.z());
  const auto [it, added] = index_.try_emplace(key, static_cast<std::uint32_t>(voxels_.size()));
  if (added) {
    Voxel voxel;
    voxel.key = key;
    voxel.at = at;
    voxels_.push_back(voxel);
    points_.resize(points_.size() + 3 * slots_, kNowhere);
    point_counts_.push_back(0);
    planes_.emplace_back();
  }
  return it->second;
}

void VoxelMap::insert(const std::vector<Eigen::Vector3f>& points, const Pose& T_odom_points) {
  const auto max_samples = static_cast<float>(params_.max_samples);
  const Eigen::Matrix3d R = T_odom_points.linear();
  const Eigen::Vector3d t = T_odom_points.translation();
  touched_.clear();
  const auto placed = [&](std::size_t k) -> Eigen::Vector3d { return R * points[k].cast<double>() + t; };
  // first where each belongs, so that what is there can be fetched before it is needed
  voxel_of_.resize(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d scaled = placed(k) * inverse_size_;
    voxel_of_[k] = isInReach(scaled) ? findOrAdd({fastFloor(scaled.x()), fastFloor(scaled.y()), fastFloor(scaled.z())})
                                     : Neighborhood::kNone;
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k + kPrefetchAhead < points.size() && voxel_of_[k + kPrefetchAhead] != Neighborhood::kNone) {
      prefetch(&voxels_[voxel_of_[k + kPrefetchAhead]], 1);
      prefetch(&points_[3 * slots_ * voxel_of_[k + kPrefetchAhead]], 3 * slots_);
    }
    const std::uint32_t i = voxel_of_[k];
    if (i == Neighborhood::kNone) continue;
    const Eigen::Vector3d p = placed(k);
    Voxel& voxel = voxels_[i];
    if (voxel.statistics.n >= max_samples) continue;
    const Eigen::Vector3f local = (p - centreOf(voxel.at)).cast<float>();
    if (voxel.statistics.n == 0.0f) planes_[i].first_view = (p - t).head<2>().normalized().cast<float>();
    voxel.statistics.add(local);
    if (!voxel.touched) {
      voxel.touched = true;
      touched_.push_back(i);
    }
    keepPoint(i, local);
  }
  refitPlanes();
}

void VoxelMap::keepPoint(std::uint32_t i, const Eigen::Vector3f& local) {
  const std::size_t count = point_counts_[i];
  if (count >= static_cast<std::size_t>(params_.max_points)) return;
  const auto spacing2 = static_cast<float>(params_.min_point_spacing_m * params_.min_point_spacing_m);
  float* const xs = &points_[3 * slots_ * i];
  float *const ys = xs + slots_, *const zs = ys + slots_;
  for (std::size_t kept = 0; kept < count; ++kept) {
    if ((Eigen::Vector3f(xs[kept], ys[kept], zs[kept]) - local).squaredNorm() < spacing2) return;
  }
  xs[count] = local.x();
  ys[count] = local.y();
  zs[count] = local.z();
  ++point_counts_[i];
}

void VoxelMap::refitPlanes() {
  for (const std::uint32_t i : touched_) {
    Voxel& voxel = voxels_[i];
    voxel.touched = false;
    Statistics& s = voxel.statistics;
    const bool full = s.n >= static_cast<float>(params_.max_samples);
    if (s.n >= static_cast<float>(params_.min_plane_samples) && (s.n >= 1.25f * s.fitted_n || full)) {
      fitPlane(s, planes_[i]);
      s.fitted_n = s.n;
    }
  }
}

void VoxelMap::fitPlane(const Statistics& s, PlanePatch& patch) const {
  const Eigen::Vector3f mean = s.sum / s.n;
  const Eigen::Matrix3f C = s.squares / s.n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(C.cast<double>());
  const Eigen::Vector3d& lambda = solver.eigenvalues();
  const double smallest = std::max(lambda[0], 1e-6);
  const bool plane = smallest <= params_.max_plane_sigma_m * params_.max_plane_sigma_m &&
                     lambda[1] >= params_.min_plane_flatness * smallest;
  patch.samples = plane ? s.n : 0.0f;
  patch.mean = mean;
  patch.normal = solver.eigenvectors().col(0).cast<float>();
  patch.variance = static_cast<float>(smallest);
  patch.tangent = solver.eigenvectors().col(1).cast<float>();
  patch.spread = static_cast<float>(std::max(lambda[1], 1e-6));
  const double apart = std::max(lambda[1] - smallest, 1e-9);
  patch.normal_variance = static_cast<float>(std::min(1.0, smallest * lambda[1] / (s.n * apart * apart)));
  patch.post = !plane && lambda[1] <= params_.max_plane_sigma_m * params_.max_plane_sigma_m &&
               lambda[2] >= params_.min_plane_flatness * lambda[1] && std::abs(solver.eigenvectors()(2, 2)) >= kUpright;
}

void VoxelMap::removeFartherThan(double range_m, const Eigen::Vector3d& position_odom) {
  const double range2 = range_m * range_m;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    if ((centreOf(voxels_[i].at) - position_odom).squaredNorm() > range2) continue;
    if (kept != i) {
      voxels_[kept] = voxels_[i];
      point_counts_[kept] = point_counts_[i];
      planes_[kept] = planes_[i];
      std::copy_n(points_.begin() + static_cast<std::ptrdiff_t>(i * 3 * slots_), 3 * slots_,
                  points_.begin() + static_cast<std::ptrdiff_t>(kept * 3 * slots_));
    }
    ++kept;
  }
  if (kept == voxels_.size()) return;
  voxels_.resize(kept);
  points_.resize(kept * 3 * slots_);
  point_counts_.resize(kept);
  planes_.resize(kept);
  index_.clear();
  for (std::size_t i = 0; i < kept; ++i) index_.emplace(voxels_[i].key, static_cast<std::uint32_t>(i));
}

void VoxelMap::clear() {
  index_.clear();
  voxels_.clear();
  points_.clear();
  point_counts_.clear();
  planes_.clear();
}

std::uint32_t VoxelMap::lookUp(std::uint32_t place, Neighborhood& neighborhood) const {
  std::uint32_t& voxel = neighborhood.voxels_[place];
  if (voxel == Neighborhood::kUnknown) {
    const Eigen::Vector3i at = neighborhood.at(place);
    const auto it = index_.find(packVoxel(at.x(), at.y(), at.z()));
    voxel = it == index_.end() ? Neighborhood::kNone : it->second;
  }
  return voxel;
}

bool VoxelMap::findPlane(const Eigen::Vector3d& query_odom, PlaneMatch& match, Neighborhood& neighborhood) const {
  const Eigen::Vector3d scaled = query_odom * inverse_size_;
  if (!isInReach(scaled)) return false;
  neighborhood.moveTo(scaled);
  const std::uint32_t own = neighborhood.own_;
  const auto consider = [&](std::uint32_t place) {
    const std::uint32_t i = lookUp(place, neighborhood);
    if (i == Neighborhood::kNone) return false;
    const PlanePatch& plane = planes_[i];
    if (plane.samples <= 0.0f) return false;
    const Eigen::Vector3f offset = (query_odom - centreOf(neighborhood.at(place))).cast<float>() - plane.mean;
    match = {&plane, plane.normal.dot(offset), plane.tangent.dot(offset)};
    return true;
  };
  if (consider(own)) return true;
  // neighbours across the nearest face of each axis, nearest first
  const Eigen::Vector3d f = scaled.array() - (neighborhood.at(own).cast<double>().array() + 0.5);
  unsigned order[3] = {0, 1, 2};
  const auto nearer = [&](unsigned a, unsigned b) { return std::abs(f[a]) > std::abs(f[b]); };
  if (nearer(order[1], order[0])) std::swap(order[0], order[1]);
  if (nearer(order[2], order[1])) std::swap(order[1], order[2]);
  if (nearer(order[1], order[0])) std::swap(order[0], order[1]);
  for (const unsigned axis : order) {
    if (consider(own ^ (1u << axis))) return true;
  }
  return false;
}

bool VoxelMap::findNearest(const Eigen::Vector3d& query_odom, double max_distance_m, PointMatch& match) const {
  Neighborhood neighborhood;
  return findNearest(query_odom, max_distance_m, match, neighborhood);
}

bool VoxelMap::findNearest(const Eigen::Vector3d& query_odom, double max_distance_m, PointMatch& match,
                           Neighborhood& neighborhood) const {
  const Eigen::Vector3d scaled = query_odom * inverse_size_;
  if (!isInReach(scaled)) return false;
  neighborhood.moveTo(scaled);
  const std::uint32_t own = neighborhood.own_;
  // how far away the voxels across the faces begin, along each axis
  const Eigen::Vector3d gap_m = params_.voxel_size_m * (scaled - neighborhood.corner_.cast<double>());
  const Eigen::Vector3f gap2_m2 = gap_m.cwiseAbs2().cast<float>();
  using Lane = Eigen::Array<float, static_cast<int>(kLane), 1>;
  const auto lane = [](const float* values) { return Eigen::Map<const Lane>(values); };
  float best = static_cast<float>(max_distance_m * max_distance_m);
  bool found = false;
  for (const unsigned across : {0u, 1u, 2u, 4u, 3u, 5u, 6u, 7u}) {  // bits: the axes across whose face the voxel lies
    const float gap2 = ((across & 1u) != 0 ? gap2_m2.x() : 0.0f) + ((across & 2u) != 0 ? gap2_m2.y() : 0.0f) +
                       ((across & 4u) != 0 ? gap2_m2.z() : 0.0f);
    if (gap2 >= best) continue;
    const std::uint32_t place = own ^ across;
    const std::uint32_t i = lookUp(place, neighborhood);
    if (i == Neighborhood::kNone) continue;
    const Eigen::Vector3f local = (query_odom - centreOf(neighborhood.at(place))).cast<float>();
    const float* const x = &points_[3 * slots_ * i];
    const float *const y = x + slots_, *const z = y + slots_;
    static_assert(kMaxPoints % kLane == 0);
    std::array<float, kMaxPoints> distances2;
    Lane least = Lane::Constant(best);
    for (std::size_t k = 0; k < slots_; k += kLane) {  // unused ones are nowhere
      const Lane dx = lane(x + k) - local.x(), dy = lane(y + k) - local.y(), dz = lane(z + k) - local.z();
      const Lane d2 = dx * dx + (dy * dy + dz * dz);
      least = least.min(d2);
      Eigen::Map<Lane>(distances2.data() + k) = d2;
    }
    const float nearest2 = least.minCoeff();
    if (!(nearest2 < best)) continue;
    std::size_t k = 0;
    while (distances2[k] != nearest2) ++k;
    best = nearest2;
    match.offset_m = Eigen::Vector3f(x[k], y[k], z[k]) - local;
    match.distance2_m2 = best;
    match.voxel = i;
    found = true;
  }
  return found;
}

std::vector<Eigen::Vector3d> VoxelMap::points() const {
  std::vector<Eigen::Vector3d> all;
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    const float* const x = &points_[3 * slots_ * i];
    for (std::size_t k = 0; k < point_counts_[i]; ++k) {
      all.push_back(centreOf(voxels_[i].at) + Eigen::Vector3f(x[k], x[k + slots_], x[k + 2 * slots_]).cast<double>());
    }
  }
  return all;
}

}  // namespace fail_aware
