// Finds and reads the parameter files: profile, vehicle and sensor give one PipelineParameters.
//
// A name is either a path to a yaml file (it contains a '/' or ends in .yaml) or the stem of a file in the package's
// cfg/profiles, cfg/vehicles or cfg/sensors. A profile has layers: default.yaml, expert.yaml, and on top its own file,
// which names only what differs. A vehicle file and a sensor file must name every key. Unknown keys are refused. Other
// files and single keys may override them.
#pragma once

#include <string>
#include <vector>

#include "core/parameters/parameter_map.hpp"
#include "core/pipeline_parameters.hpp"

namespace fail_aware {

struct ProfileFiles {
  std::string cfg;  ///< folder with profiles/, vehicles/, sensors/; empty: findCfg()
  std::string profile = "default";
  std::string vehicle = "passat_b6";
  std::string sensor = "hdl64e";
};

/// The cfg folder of this library: the installed one, or that of the source tree that the library was built from.
/// Throws InputError if there is none.
std::string findCfg();

/// Throws InputError (file not found; lists the available ones) or ParameterError (key, value, rule).
PipelineParameters loadPipelineParameters(const ProfileFiles& files);

/// "sensor" or "vehicle" if these are all keys of such a file; otherwise empty.
std::string kindOf(const ParameterMap& values);

/// Applies `files` (yaml files that may name only some keys) in order, then `assignments` (key=value); the last value
/// counts. Validates. Throws ParameterError.
void overrideParameters(PipelineParameters& params, const std::vector<std::string>& files,
                        const std::vector<std::string>& assignments);

}  // namespace fail_aware
