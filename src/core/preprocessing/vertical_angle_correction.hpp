// Corrects a constant error of the beams' elevation angles. Not in the paper.
//
// KITTI's Velodyne calibration is known to put every beam 0.205 deg too low (noted by the authors of IMLS-SLAM, CT-ICP
// and KISS-ICP): road seen from 40 m lies 0.1 m below the same road seen from near, and odometry drifts in height and
// pitch. Each point p (m, sensor frame) is rotated by the angle about p x z, which raises its elevation and keeps range
// and azimuth.
//
// Points on the z axis have no azimuth: they stay finite and move by at most the angle.
// Cost: one square root and one division per point, about 0.15 ms for 120 000 points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/parameters/check.hpp"

namespace fail_aware {

struct VerticalAngleCorrectionParams {
  static constexpr double kMax_deg = 5.0;

  double angle_deg = 0.0;  ///< added to each point's elevation; 0: off; KITTI: 0.205
  /// standard deviation of the error that angle_deg leaves, which the vertical reference finds while driving, and
  /// corrects up to five times this
  double sigma_deg = 0.15;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("angle_deg", self.angle_deg, within(-kMax_deg, kMax_deg));
    v("sigma_deg", self.sigma_deg, within(0.001, kMax_deg));
  }
};

/// angle_rad: added to each point's elevation.
void correctVerticalAngle(double angle_rad, std::vector<Eigen::Vector3f>& points_lidar);

}  // namespace fail_aware
