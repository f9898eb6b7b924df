#include "fail_aware_lidar_odometry/core/pipeline_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/parameters/validate_nested.hpp"

namespace fail_aware {

namespace {

constexpr double kMaxAngle_rad = 6.3;  // once around

void requireFinite(const char* name, const std::vector<double>& values, std::size_t count) {
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() == count && finite) return;
  throw ParameterError(std::string(name) + ": must be " + std::to_string(count) + " finite numbers, has " +
                       std::to_string(values.size()));
}

}  // namespace

void SensorParameters::validate() const {
  validateNested(*this);
  requireFinite("lidar_in_base", lidar_in_base, 6);
  for (std::size_t i = 0; i < 3; ++i) requireWithin("lidar_in_base", lidar_in_base[i], -100.0, 100.0);
  for (std::size_t i = 3; i < 6; ++i) {
    requireParameter(std::abs(lidar_in_base[i]) <= kMaxAngle_rad, "lidar_in_base", lidar_in_base[i],
                     "in [-6.3, 6.3] where it is an angle: rad, not deg");
  }
}

Pose SensorParameters::T_base_lidar() const { return poseFromVector(Vector6d(lidar_in_base.data())); }

SweepTimingParams SensorParameters::correctedTiming() const {
  SweepTimingParams corrected = timing;
  if (azimuth.angle_deg != 0.0) {
    corrected.start_azimuth_deg = std::remainder(timing.start_azimuth_deg + azimuth.angle_deg, 360.0);
  }
  return corrected;
}

void VehicleFileParameters::validate() const {
  validateNested(*this);
  requireFinite("cog_in_base", cog_in_base, 3);
}

Pose VehicleFileParameters::T_base_cog() const {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(cog_in_base.data());
  return T;
}

void ProfileParameters::validate() const { validateNested(*this); }

void PipelineParameters::validate() const {
  validateAs("sensor.", sensor);
  validateAs("vehicle.", vehicle);
  profile.validate();
}

}  // namespace fail_aware
