// What a sweep could not see: a range image of the things that stand in it (not in the paper).
//
// A vehicle that travels along takes its shadow with it. What is seen beside the shadow's edge meets nothing where the
// edge was before, although it stands there; without this image that would speak for a standstill
// (motion_initialization.hpp).
// Frame: one for the points and the lidar's position, m. Failure: none; without points nothing is hidden.
// Cost: about 1 ms to build, 20 ns a question.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/map/above_ground_points.hpp"

namespace fail_aware {

class OcclusionImage {
 public:
  OcclusionImage() = default;
  /// `things`: points above the ground; ground would hide what stands farther away in the same direction.
  OcclusionImage(const AboveGroundPoints& things, const Eigen::Vector3d& lidar_position_m);

  /// Whether something stands between the lidar and `point`, by more than 1 m in front of it.
  bool hides(const Eigen::Vector3d& point) const;

 private:
  struct Direction {
    std::size_t pixel;
    double range_m;
  };
  Direction directionOf(const Eigen::Vector3d& point) const;

  Eigen::Vector3d lidar_position_m_ = Eigen::Vector3d::Zero();
  std::vector<float> nearest_m_;  ///< by pixel; empty: nothing is hidden
};

}  // namespace fail_aware
