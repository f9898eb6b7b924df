// Yaml of any bytes -> parameters: refused by name, or a set that keeps its rules.
#include "core/parameters/parameter_map.hpp"
#include "core/parameters/validate.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const YamlParameters yaml = parseYaml(std::string(reinterpret_cast<const char*>(data), size), "input");
    PipelineParameters parameters;
    fromMap(parameters, yaml.values, MissingKeys::kKeep);
    validate(parameters);
    // What was taken reads back to itself.
    PipelineParameters again;
    fromMap(again, parseYaml(formatYaml(toList(parameters)), "output").values, MissingKeys::kRefuse);
    promise(formatYaml(toList(again)) == formatYaml(toList(parameters)), "parameters read back to themselves");
  } catch (const ParameterError& error) {
    promise(error.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
