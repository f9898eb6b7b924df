// The reference of the two ICPs: corrected sweeps, placed by the filter's estimates, as one voxel map.
//
// `sweeps` = 1 is the article's registration of consecutive sweeps; 0 keeps everything within `range_m` (local map).
// Cost: one insertion (voxel_map.hpp) a sweep.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

class ReferenceMap {
 public:
  struct Params {
    int sweeps = 0;
    double range_m = 100.0;
    VoxelMap::Params voxels;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("sweeps", self.sweeps, within(0, 1));
      v("range_m", self.range_m, within(0.1, 2000.0));
      v("voxels", self.voxels);
    }
  };

  explicit ReferenceMap(const Params& params);

  void add(const std::vector<Eigen::Vector3f>& points_cog, const Pose& T_odom_cog);
  void clear();
  const VoxelMap& map() const { return map_; }

 private:
  Params params_;
  VoxelMap map_;
  Eigen::Vector3d trimmed_at_odom_ = Eigen::Vector3d::Zero();
};

}  // namespace fail_aware
