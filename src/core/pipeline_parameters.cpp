#include "fail_aware_lidar_odometry/core/pipeline_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/parameters/parameter_map.hpp"

namespace fail_aware {

namespace {

void requireFinite(const char* name, const std::vector<double>& values, std::size_t count) {
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() == count && finite) return;
  throw ParameterError(std::string(name) + ": must be " + std::to_string(count) + " finite numbers, has " +
                       std::to_string(values.size()));
}

// The structs name their fields without a prefix; here the message gets it. Innermost first: a struct that checks its
// nested structs without naming them finds nothing wrong with them any more.
template <class Params>
void validateAs(const std::string& prefix, const Params& params) {
  Params::visit(params, [&](const char* name, const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (!detail::is_parameter_value<Field>) validateAs(prefix + name + '.', field);
  });
  try {
    params.validate();
  } catch (const ParameterError& error) {
    throw ParameterError(prefix + error.what());
  }
}

template <class Params>
void validateNested(const Params& params) {
  Params::visit(params, [](const char* name, const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (!detail::is_parameter_value<Field>) validateAs(std::string(name) + '.', field);
  });
}

}  // namespace

void SensorParameters::validate() const {
  validateNested(*this);
  requireFinite("lidar_in_base", lidar_in_base, 6);
}

Pose SensorParameters::T_base_lidar() const { return poseFromVector(Vector6d(lidar_in_base.data())); }

void VehicleFileParameters::validate() const {
  validateNested(*this);
  requireFinite("cog_in_base", cog_in_base, 3);
}

Pose VehicleFileParameters::T_base_cog() const {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(cog_in_base.data());
  return T;
}

void RegistrationParameters::validate() const {
  requireParameter(use_point || use_plane, "use_point", use_point,
                   "true, or use_plane be true (corners alone cannot find the first motion)");
  validateNested(*this);
}

void ProfileParameters::validate() const { validateNested(*this); }

void PipelineParameters::validate() const {
  validateAs("sensor.", sensor);
  validateAs("vehicle.", vehicle);
  profile.validate();
}

}  // namespace fail_aware
