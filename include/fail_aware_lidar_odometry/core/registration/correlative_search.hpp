// Where in the map a sweep was taken, searched for seen from above: correlative scan matching (Olson, "Real-Time Correlative
// Scan Matching", ICRA 2009; not in the article). What stands above the ground is drawn into a grid around the predicted
// position; every turn and shift within reach of the prediction is tried on a coarse grid, the best ones on a fine one.
// It reaches metres and tens of degrees, where a nearest-point search ends in the next hedge.
//
// Frames: points in the frame of the centre of gravity, poses in odom; z, roll and pitch stay those of the prediction.
// Failure: too little stands in the sweep (false: it cannot be searched for), or too little of it fits anywhere.
// Cost: 20 to 60 ms.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/cloud/voxel_map.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

class CorrelativeSearch {
 public:
  struct Params {
    bool enabled = true;
    double range_m = 60.0;      ///< farthest points used: as the first motion's search
    double max_shift_m = 15.0;  ///< farthest from the prediction, along each axis
    /// largest turn from the prediction, to both sides: more than a car turns in a short gap
    double max_turn_deg = 45.0;
    /// ratio of what stands that must fit (half of it: what lies where nothing was seen)
    double min_ratio = 0.65;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("enabled", self.enabled);
      v("max_shift_m", self.max_shift_m);
    }
    void validate() const;
  };

  struct Found {
    Pose T_odom_cog = Pose::Identity();
    double share = 0.0;  ///< of what stands, that fits: min_ratio ... 1
  };

  /// Throws ParameterError.
  explicit CorrelativeSearch(const Params& params);

  /// `covariance`: of the predicted state (x, y, z, roll, pitch, yaw); how far is searched. False: too little stands.
  bool find(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map, const Pose& T_odom_cog_predicted,
            const Matrix6d& covariance, std::optional<Found>& found) const;

 private:
  Params params_;
};

}  // namespace fail_aware
