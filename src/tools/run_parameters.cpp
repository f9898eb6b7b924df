#include "run_parameters.hpp"

#include "core/parameters/yaml_parameters.hpp"

namespace fail_aware {

SensorParameters sensorOfRun(const std::filesystem::path& run) {
  PipelineParameters params;
  loadYaml((run / "parameters.yaml").string(), params, MissingKeys::kKeep);
  params.validate();
  return params.sensor;
}

}  // namespace fail_aware
