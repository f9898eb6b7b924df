// The parameters that an offline_odometry run was made with.
#pragma once

#include <filesystem>

#include "core/pipeline_parameters.hpp"

namespace fail_aware {

/// Of the run's lidar: from parameters.yaml in its folder. Keys that the file lacks (an older version) have their
/// default values. Throws InputError for values that are out of range.
SensorParameters sensorOfRun(const std::filesystem::path& run);

}  // namespace fail_aware
