#include "core/parameters/mounting.hpp"

#include <cmath>

#include "core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kFarthest_m = 100.0, kMaxAngle_rad = 3.15;  // half a turn, rounded up

}  // namespace

void requireMounting(const char* name, const std::vector<double>& x_y_z_roll_pitch_yaw) {
  requireFiniteNumbers(name, x_y_z_roll_pitch_yaw, 6);
  for (std::size_t i = 0; i < 3; ++i) requireWithin(name, x_y_z_roll_pitch_yaw[i], -kFarthest_m, kFarthest_m);
  for (std::size_t i = 3; i < 6; ++i) {
    requireParameter(std::abs(x_y_z_roll_pitch_yaw[i]) <= kMaxAngle_rad, name, x_y_z_roll_pitch_yaw[i],
                     "in [-3.15, 3.15] where it is an angle: rad, not deg");
  }
}

std::string placeholderFault(const std::vector<double>& lidar_in_base) {
  static const std::vector<double> kPlaceholder = {0.0, 0.0, 1.8, 0.0, 0.0, 0.0};
  if (lidar_in_base != kPlaceholder) return "";
  return "lidar_in_base is the placeholder of the shipped sensor files (0, 0, 1.8 m), not your lidar's place: measure "
         "the place and set it in a copy of the sensor file";
}

Pose mountingPose(const std::vector<double>& x_y_z_roll_pitch_yaw) {
  return poseFromVector(Vector6d(x_y_z_roll_pitch_yaw.data()));
}

}  // namespace fail_aware
