// Corrects a constant error of the head's azimuth: its zero does not point along the lidar's x axis. Not in the paper.
//
// The correction is a rotation about z. It keeps the shape of the scene and rotates the lidar frame of the odometry. An
// error of one degree moves the end of each metre driven straight by 17 mm to the side.
// evaluation/azimuth_calibration.hpp estimates the angle from drives alone. For a head that is mounted at another yaw
// set sensor.lidar_in_base (tf) instead.
//
// The time at which the head passes an azimuth depends on the head's own zero: SensorParameters::correctedTiming()
// returns the timing for corrected points.
// Points: m, lidar frame.
// Cost: about 0.1 ms for 120 000 points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/parameters/check.hpp"

namespace fail_aware {

struct AzimuthCorrectionParams {
  static constexpr double kMax_deg = 10.0;

  double angle_deg = 0.0;  ///< added to each point's azimuth, counter-clockwise about the lidar's z axis; 0: off

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("angle_deg", self.angle_deg, within(-kMax_deg, kMax_deg));
  }
};

void correctAzimuth(const AzimuthCorrectionParams& params, std::vector<Eigen::Vector3f>& points_lidar);

}  // namespace fail_aware
