// Parameter structs <-> yaml files (cfg/profiles, cfg/vehicles, cfg/sensors; the file that a run saves).
//
// Nested maps become dotted keys. A file must mean the same to `rosparam load` and to this reader, so everything that
// the two read differently is refused: numbers without a dot or a signed exponent (1e-3: write 1.0e-3), hexadecimal,
// octal and sexagesimal numbers, NaN, dotted or duplicate keys, several documents.
// Failure: ParameterError "FILE:LINE: key: what is wrong" (without LINE if there is none).
#pragma once

#include <string>

#include "core/parameters/parameter_map.hpp"

namespace fail_aware {

struct YamlParameters {
  std::string source;  ///< file name, for messages
  ParameterMap values;
  std::map<std::string, int> lines;  ///< key -> line, counted from 1
};

/// `source` names the text in messages.
YamlParameters parseYaml(const std::string& text, const std::string& source);
YamlParameters readYaml(const std::string& path);

/// `error` with the place of its key in front.
ParameterError located(const YamlParameters& yaml, const ParameterKeyError& error);

/// Reads `path` into `parameters`, which stays unchanged on failure. The caller validates after reading all files.
template <class Struct>
void loadYaml(const std::string& path, Struct& parameters, MissingKeys missing_keys = MissingKeys::kRefuse) {
  const YamlParameters yaml = readYaml(path);
  try {
    fromMap(parameters, yaml.values, missing_keys);
  } catch (const ParameterKeyError& error) {
    throw located(yaml, error);
  }
}

/// Yaml text in the list's order that parseYaml and rosparam read back as the same values.
std::string formatYaml(const ParameterList& list);

/// Throws ParameterError when `path` cannot be written.
void writeYaml(const std::string& path, const ParameterList& list);

template <class Struct>
void saveYaml(const std::string& path, const Struct& parameters) {
  writeYaml(path, toList(parameters));
}

}  // namespace fail_aware
