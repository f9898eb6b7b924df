#include "fail_aware_lidar_odometry/core/pipeline_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

namespace {

void requireFinite(const char* name, const std::vector<double>& values, std::size_t count) {
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() == count && finite) return;
  throw ParameterError(std::string(name) + ": must be " + std::to_string(count) + " finite numbers, has " +
                       std::to_string(values.size()));
}

// The structs name their fields without a prefix; here the message gets it.
template <class Params>
void validateAs(const char* prefix, const Params& params) {
  try {
    params.validate();
  } catch (const ParameterError& error) {
    throw ParameterError(std::string(prefix) + "." + error.what());
  }
}

}  // namespace

void SensorParameters::validate() const {
  validateAs("timing", timing);
  validateAs("vertical_angle", vertical_angle);
  requireFinite("lidar_in_base", lidar_in_base, 6);
}

Pose SensorParameters::T_base_lidar() const { return poseFromVector(Vector6d(lidar_in_base.data())); }

void VehicleFileParameters::validate() const {
  validateAs("dynamics", dynamics);
  requireFinite("cog_in_base", cog_in_base, 3);
}

Pose VehicleFileParameters::T_base_cog() const {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(cog_in_base.data());
  return T;
}

void RegistrationParameters::validate() const {
  requireParameter(use_point || use_plane || use_corners, "use_point", use_point,
                   "true, or use_plane or use_corners be true");
  validateAs("cloud", cloud);
  validateAs("reference", reference);
  validateAs("initialization", initialization);
  validateAs("point", point);
  validateAs("plane", plane);
  validateAs("corner_extraction", corner_extraction);
  validateAs("corner_reference", corner_reference);
  validateAs("corner_alignment", corner_alignment);
}

void ProfileParameters::validate() const {
  validateAs("sweep_correction", sweep_correction);
  validateAs("model", model);
  validateAs("history", history);
  validateAs("road", road);
  validateAs("ukf", ukf);
  validateAs("filter", filter);
  validateAs("registration", registration);
  validateAs("fusion", fusion);
  validateAs("monitor", monitor);
}

void PipelineParameters::validate() const {
  validateAs("sensor", sensor);
  validateAs("vehicle", vehicle);
  profile.validate();
}

}  // namespace fail_aware
