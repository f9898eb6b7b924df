#include "synthetic_drive.hpp"

#include <cmath>

namespace fail_aware {

CorrectedSweep SyntheticDrive::sweep(double stamp_s, unsigned seed) const {
  constexpr double kPeriod_s = 0.1;
  CorrectedSweep sweep;
  sweep.stamp_s = stamp_s;
  const auto timeOf = [](const Eigen::Vector3d& p) { return kPeriod_s * std::atan2(p.y(), p.x()) / (2.0 * M_PI); };
  const auto add = [&](const Eigen::Vector3d& point_lidar, double time_s) {
    sweep.points_lidar.push_back(point_lidar.cast<float>());
    sweep.times_s.push_back(static_cast<float>(time_s));
  };
  const Pose T_lidar_odom = (pose(stamp_s) * T_cog_lidar).inverse();
  for (const Eigen::Vector3d& p : sampleScene(scene, points_per_m2, 0.01, seed)) {
    const Eigen::Vector3d at_stamp = T_lidar_odom * p;
    if (at_stamp.norm() > max_range_m) continue;
    const double time_s = timeOf(at_stamp);
    add((pose(stamp_s + time_s) * T_cog_lidar).inverse() * p, time_s);
  }
  if (car_ahead) {
    const Scene car = {wall(9.0, -0.9, 9.0, 0.9, 1.5), wall(9.0, -0.9, 13.0, -0.9, 1.5),
                       wall(9.0, 0.9, 13.0, 0.9, 1.5)};
    for (const Eigen::Vector3d& p : sampleScene(car, 150.0, 0.01, seed + 1000)) {
      const Eigen::Vector3d in_lidar = T_cog_lidar.inverse() * p;
      add(in_lidar, timeOf(in_lidar));
    }
  }
  if (ground_rings) {
    const double z = kGround_m - T_cog_lidar.translation().z();
    for (double radius = 3.5; radius < 30.0; radius *= 1.12) {
      for (double azimuth = -M_PI; azimuth < M_PI; azimuth += 0.01) {
        const Eigen::Vector3d p(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
        add(p, timeOf(p));
      }
    }
  }
  return sweep;
}

}  // namespace fail_aware
