#include "core/map/local_map.hpp"

#include <cmath>

namespace fail_aware {

namespace {

// Of 100 m around, with false returns in the air, too: a map that is copied makes the sweep that it meets wait for
// 0.1 s.
constexpr std::size_t kReservedVoxels = std::size_t{1} << 18;
constexpr double kTrimEvery_m = 5.0;        // so that the trimming costs little a sweep
constexpr double kOtherReference_s = 0.02;  // between the sweeps' middles; a driver adds less to a revolution

}  // namespace

LocalMap::LocalMap(const Params& params, const AboveGroundReference::Params& above_ground)
    : params_(params), map_(params.voxels), above_ground_(above_ground) {
  map_.reserve(kReservedVoxels);
}

bool LocalMap::enterOdom(int odom_reset_count) {
  if (odom_reset_count == odom_reset_count_) return false;
  odom_reset_count_ = odom_reset_count;
  clear();
  return true;
}

void LocalMap::insert(const RegistrationCloud& cloud, const Pose& T_odom_cog, double time_s, bool keep_above_ground) {
  only_first_ = empty();
  if (only_first_) {
    first_cloud_ = cloud;
    T_odom_cog_first_ = T_odom_cog;
  }
  add(cloud.map_points_cog, T_odom_cog);
  newest_ = {time_s, T_odom_cog};
  if (keep_above_ground && above_ground_.isDue(T_odom_cog, time_s))
    above_ground_.keep(cloud.map_points_cog, T_odom_cog, time_s);
}

void LocalMap::add(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog) {
  const bool keeps_earlier = params_.sweeps == 0;
  if (!keeps_earlier) map_.clear();
  map_.insert(points_cog, T_odom_cog);
  if (keeps_earlier && (T_odom_cog.translation() - trimmed_at_odom_).norm() > kTrimEvery_m) {
    trimmed_at_odom_ = T_odom_cog.translation();
    map_.removeFartherThan(params_.range_m + kTrimEvery_m, trimmed_at_odom_);
  }
}

void LocalMap::redeskewFirstTo(const Vector6d& twist_cog, double middle_s) {
  if (!only_first_ || first_cloud_.compensated) return;
  RegistrationCloud first = first_cloud_;
  // if the time field of the first sweep failed, its timing had no earlier sweep to follow; all sweeps of a head have
  // the same times relative to their stamps
  const double shift_s = first.middle_s - middle_s;
  first.redeskewBy(twist_cog, std::abs(shift_s) > kOtherReference_s ? shift_s : 0.0);
  clearPoints();
  add(first.map_points_cog, T_odom_cog_first_);
  above_ground_.keep(first.map_points_cog, T_odom_cog_first_, first.stamp_s);
}

void LocalMap::clearPoints() {
  map_.clear();
  trimmed_at_odom_.setZero();
}

void LocalMap::clear() {
  clearPoints();
  above_ground_.clear();
}

void LocalMap::reset() {
  clear();
  only_first_ = false;
}

}  // namespace fail_aware
