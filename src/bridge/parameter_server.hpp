// The parameter server -> parameter structs. The only reader of the server in this package.
//
// `rosparam load` puts a profile's layers (core/io/profile_files.hpp) into profile/, a file of cfg/vehicles into
// vehicle/ and one of cfg/sensors into sensor/ of the graph's namespace. The rules are those for files: an unknown key
// is refused, and vehicle/ and sensor/ must have every key. A key that is missing in profile/ keeps its value in code,
// which is the value of default.yaml and expert.yaml.
// Failure: ParameterError naming namespace, key and rule.
#pragma once

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <optional>
#include <string>
#include <vector>

#include "core/parameters/parameter_map.hpp"
#include "core/pipeline_parameters.hpp"

namespace fail_aware {

/// Nested structs become dotted keys. Lists must contain numbers only.
ParameterMap toParameterMap(const XmlRpc::XmlRpcValue& value);

/// A copy of the server's parameters below `name` of `node`; empty if there are none.
ParameterMap readParameterMap(const ros::NodeHandle& node, const std::string& name);

/// `others`: prefixes of keys in the same namespace that other readers own.
template <class Struct>
void readParameters(const ros::NodeHandle& node, const std::string& name, Struct& parameters,
                    MissingKeys missing_keys = MissingKeys::kRefuse, const std::vector<std::string>& others = {}) {
  const std::string place = name.empty() ? node.getNamespace() : node.resolveName(name);
  try {
    ParameterMap values = readParameterMap(node, name);
    for (const std::string& other : others) {
      auto at = values.lower_bound(other);
      while (at != values.end() && at->first.compare(0, other.size(), other) == 0) at = values.erase(at);
    }
    fromMap(parameters, values, missing_keys);
  } catch (const ParameterError& error) {
    throw ParameterError(place + ": " + error.what());
  }
}

/// The current text `name` of `node`; `otherwise` if there is none.
std::string readText(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise);

/// The current number `name` of `node`, if there is one.
std::optional<double> readNumber(const ros::NodeHandle& node, const std::string& name);

/// profile/, vehicle/ and sensor/ below `node`, validated.
PipelineParameters readPipelineParameters(const ros::NodeHandle& node);

}  // namespace fail_aware
