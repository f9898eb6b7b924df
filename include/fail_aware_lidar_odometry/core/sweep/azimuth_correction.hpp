// Corrects a constant error of the head's azimuth: its zero does not point where the lidar's x axis should.
//
// A rotation about z: what is matched keeps its shape, and the lidar frame in which the odometry speaks is turned. Off by
// one degree, each metre driven straight on ends 17 mm to the side. From drives alone it is found by
// evaluation/azimuth_calibration.hpp. A head that is mounted at another yaw is for sensor.lidar_in_base (tf), not this.
//
// The instant at which the head passes an azimuth is told by its own zero: SensorParameters::correctedTiming() gives
// the timing for corrected points. Cost: about 0.1 ms for 120 000 points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

struct AzimuthCorrectionParams {
  static constexpr double kMax_deg = 10.0;

  double angle_deg = 0.0;  ///< added to each point's azimuth, counter-clockwise about the lidar's z axis; 0: off

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("angle_deg", self.angle_deg);
  }
  void validate() const { requireWithin("angle_deg", angle_deg, -kMax_deg, kMax_deg); }
};

void correctAzimuth(const AzimuthCorrectionParams& params, std::vector<Eigen::Vector3f>& points_lidar);

}  // namespace fail_aware
