// The references of the two ICPs: the local map and the points for the above-ground match. The only class that clears
// the references, inserts sweeps and knows the first and the last inserted sweep.
//
// The map belongs to one odom frame (FilterState::odom_reset_count counts the resets of odom); after a reset of odom
// the map starts empty. FilterState::map_update decides which sweeps are inserted; an empty map takes any sweep. While
// the map holds only its first sweep, that sweep can be deskewed again when the first motion is found
// (motion_initialization.hpp).
// Frames: points in the frame of the centre of gravity; poses in odom.
// Cost: one insertion (voxel_map.hpp) a sweep, and one copy of the first sweep.
#pragma once

#include "core/map/above_ground_reference.hpp"
#include "core/map/voxel_map.hpp"
#include "core/parameters/check.hpp"
#include "core/preprocessing/registration_cloud.hpp"

namespace fail_aware {

class LocalMap {
 public:
  struct Params {
    int sweeps = 0;  ///< 1: the last one alone, as in the article; 0: everything within range_m
    double range_m = 100.0;
    VoxelMap::Params voxels;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("sweeps", self.sweeps, within(0, 1));
      v("range_m", self.range_m, within(0.1, 2000.0));
      v("voxels", self.voxels);
    }
  };

  LocalMap(const Params& params, const AboveGroundReference::Params& above_ground);

  /// True: odom was reset and the map was cleared.
  bool enterOdom(int odom_reset_count);

  /// Empties the map for a restart; the next sweep becomes the first one.
  void clear();
  /// Empties the map but keeps the above-ground points.
  void clearPoints();

  /// Inserts a sweep at its estimate. keep_above_ground: also keep its above-ground points, if they are due.
  void insert(const RegistrationCloud& cloud, const Pose& T_odom_cog, double time_s, bool keep_above_ground);

  /// Deskews the first sweep for the motion that was unknown, if it is alone in the map and was not compensated.
  /// middle_s: middle of the second sweep's times.
  void redeskewFirstTo(const Vector6d& twist_cog, double middle_s);

  /// For a new drive; the reset count of odom is kept.
  void reset();

  bool empty() const { return map_.empty(); }
  const VoxelMap& map() const { return map_; }
  const AboveGroundReference& aboveGround() const { return above_ground_; }

  struct Sweep {
    double time_s = 0.0;
    Pose T_odom_cog = Pose::Identity();
  };
  /// The first sweep in the map; remains known after the map is emptied.
  Sweep first() const { return {first_cloud_.stamp_s, T_odom_cog_first_}; }
  /// The newest sweep in the map; likewise.
  const Sweep& newest() const { return newest_; }

 private:
  void add(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog);

  Params params_;
  VoxelMap map_;
  Eigen::Vector3d trimmed_at_odom_ = Eigen::Vector3d::Zero();
  AboveGroundReference above_ground_;
  RegistrationCloud first_cloud_;
  Pose T_odom_cog_first_ = Pose::Identity();
  bool only_first_ = false;
  Sweep newest_;
  int odom_reset_count_ = 0;
};

}  // namespace fail_aware
