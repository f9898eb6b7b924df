// A sweep after the motion correction (preprocessing/correction.hpp): every point is where the sensor would have seen
// it at the sweep's stamp.
// Points: m, sensor frame.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace fail_aware {

struct CorrectedSweep {
  double stamp_s = 0.0;                       ///< s; after the sweep clock: SweepPrediction::time_s()
  std::vector<Eigen::Vector3f> points_lidar;  ///< m, sensor frame at the stamp
  std::vector<float> times_s;                 ///< s relative to the stamp; empty: no timing
  std::vector<std::uint16_t> rings;           ///< as in Sweep; empty: unknown

  void clear() {
    points_lidar.clear();
    times_s.clear();
    rings.clear();
  }
};

}  // namespace fail_aware
