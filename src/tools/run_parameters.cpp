#include "run_parameters.hpp"

#include "core/parameters/validate.hpp"
#include "core/parameters/yaml_parameters.hpp"

namespace fail_aware {

SensorParameters sensorOfRun(const std::filesystem::path& run) {
  PipelineParameters params;
  loadYaml((run / "parameters.yaml").string(), params, MissingKeys::kKeep);
  validate(params);
  return params.sensor;
}

}  // namespace fail_aware
