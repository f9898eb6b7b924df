// The references of the two ICPs: the local map and what is kept for the above-ground match. The only place that clears
// them, inserts a sweep and knows which one came first and last.
//
// The map belongs to one odom (FilterState::odom_reset_count: odom was moved under the vehicle); in another one it begins anew.
// Sweeps join as FilterState::map_update says; an empty map takes any sweep. As long as it holds one sweep alone that one
// can be deskewed once more, when the first motion is found (motion_initialization.hpp).
// Frames: points of the centre of gravity; poses odom. Cost: reference_map.hpp's; of the first sweep a copy.
#pragma once

#include "fail_aware_lidar_odometry/core/registration/reference_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_cloud.hpp"
#include "fail_aware_lidar_odometry/core/registration/above_ground_reference.hpp"

namespace fail_aware {

class LocalMap {
 public:
  LocalMap(const ReferenceMap::Params& map, const AboveGroundReference::Params& standing);

  /// True: it is another odom, the map began anew.
  bool enterOdom(int epoch);

  /// Empties the map for a restart; it begins anew with the next sweep.
  void clear();
  /// Empties the map without what stands.
  void restart() { reference_.clear(); }

  /// A sweep at its estimate. keep_above_ground: if it is time for it.
  void insert(const RegistrationCloud& cloud, const Pose& T_odom_cog, double time_s, bool keep_above_ground);

  /// The first sweep, if it is alone in the map and did not come compensated, moved for the motion that it was not
  /// deskewed for. middle_s: of the second sweep's times.
  void redeskewFirst(const Vector6d& twist_cog, double middle_s);

  /// Another drive; the number of odom goes on.
  void reset();

  bool empty() const { return map().empty(); }
  const VoxelMap& map() const { return reference_.map(); }
  const AboveGroundReference& standing() const { return above_ground_; }

  struct Sweep {
    double time_s = 0.0;
    Pose T_odom_cog = Pose::Identity();
  };
  /// The sweep that the map began with; stays known when the map is emptied.
  Sweep first() const { return {first_cloud_.stamp_s, T_odom_cog_first_}; }
  /// The newest sweep in the map; likewise.
  const Sweep& newest() const { return newest_; }

 private:
  ReferenceMap reference_;
  AboveGroundReference above_ground_;
  RegistrationCloud first_cloud_;
  Pose T_odom_cog_first_ = Pose::Identity();
  bool only_first_ = false;
  Sweep newest_;
  int odom_reset_count_ = 0;
};

}  // namespace fail_aware
