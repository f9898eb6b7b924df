// Changes a profile's parameters from the command line: files that name some keys, then single keys.
#pragma once

#include <string>
#include <vector>

#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"

namespace fail_aware {

/// Applies `files` (yaml) in order, then `assignments` (key=value); the last value counts. Validates. Throws
/// ParameterError.
inline void overrideParameters(PipelineParameters& params, const std::vector<std::string>& files,
                               const std::vector<std::string>& assignments) {
  for (const std::string& file : files) loadYaml(file, params, MissingKeys::kKeep);
  for (const std::string& assignment : assignments) setParameter(params, assignment);
  params.validate();
}

}  // namespace fail_aware
