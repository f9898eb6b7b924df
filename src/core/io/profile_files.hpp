// Finds and reads the parameter files: profile, vehicle and sensor make one PipelineParameters.
//
// A name is either a path to a yaml file (it contains a '/' or ends in .yaml) or the stem of a file in the package's
// cfg/profiles, cfg/vehicles or cfg/sensors. A profile is layers: default.yaml, expert.yaml, and over them its own file,
// which names only what differs. A vehicle's and a sensor's file must name every key. No file may name an unknown key.
#pragma once

#include <string>

#include "core/pipeline_parameters.hpp"

namespace fail_aware {

struct ProfileFiles {
  std::string cfg;  ///< folder with profiles/, vehicles/, sensors/; empty: findCfg()
  std::string profile = "default";
  std::string vehicle = "passat_b6";
  std::string sensor = "hdl64e";
};

/// The cfg folder that belongs to this library: installed with it, or in the source tree that it was built from.
/// Throws InputError if there is none.
std::string findCfg();

/// Throws InputError (no such file; lists what there is) or ParameterError (key, value, rule).
PipelineParameters loadPipelineParameters(const ProfileFiles& files);

}  // namespace fail_aware
