// Corrects constant errors of the head's angles. Not in the paper.
//
// Elevation: KITTI's Velodyne calibration is known to put every beam 0.205 deg too low (noted by the authors of
// IMLS-SLAM, CT-ICP and KISS-ICP): road seen from 40 m lies 0.1 m below the same road seen from near, and odometry
// drifts in height and pitch. Each point p is rotated by the angle about p x z, which raises its elevation and keeps
// range and azimuth. Points on the z axis have no azimuth: they stay finite and move by at most the angle.
//
// Azimuth: the head's zero does not point along the lidar's x axis. The correction is a rotation about z. It keeps the
// shape of the scene and rotates the lidar frame of the odometry. An error of one degree moves the end of each metre
// driven straight by 17 mm to the side. evaluation/azimuth_calibration.hpp estimates the angle from drives alone. For a
// head that is mounted at another yaw set sensor.lidar_in_base (tf) instead. The time at which the head passes an
// azimuth depends on the head's own zero: SensorParameters::correctedTiming() is the timing for corrected points.
//
// Points: m, lidar frame. Cost: 0.15 and 0.1 ms for 120 000 points.
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

struct AzimuthCorrectionParams {
  static constexpr double kMax_deg = 10.0;
  double angle_deg = 0.0;  ///< added to each point's azimuth, counter-clockwise about the lidar's z axis; 0: off

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("angle_deg", self.angle_deg, within(-kMax_deg, kMax_deg));
  }
};

/// angle_rad: added to each point's elevation.
void correctVerticalAngle(double angle_rad, std::vector<Eigen::Vector3f>& points_lidar);
void correctAzimuth(const AzimuthCorrectionParams& params, std::vector<Eigen::Vector3f>& points_lidar);

}  // namespace fail_aware
