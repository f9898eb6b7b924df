#include "bridge/parameter_server.hpp"

#include "core/io/profile_files.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware {

namespace {

using XmlRpc::XmlRpcValue;

double numberOf(const std::string& key, XmlRpcValue value) {
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int>(value);
  if (value.getType() == XmlRpcValue::TypeDouble) return static_cast<double>(value);
  throw ParameterKeyError(key, key + ": must be a list of numbers");
}

void collect(const std::string& key, XmlRpcValue value, ParameterMap& map) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean: map[key] = static_cast<bool>(value); return;
    case XmlRpcValue::TypeInt: map[key] = static_cast<int>(value); return;
    case XmlRpcValue::TypeDouble: map[key] = static_cast<double>(value); return;
    case XmlRpcValue::TypeString: map[key] = static_cast<std::string>(value); return;
    case XmlRpcValue::TypeArray: {
      std::vector<double> numbers;
      numbers.reserve(static_cast<std::size_t>(value.size()));
      for (int i = 0; i < value.size(); ++i) numbers.push_back(numberOf(key, value[i]));
      map[key] = numbers;
      return;
    }
    case XmlRpcValue::TypeStruct:
      for (auto& member : value) collect(key.empty() ? member.first : key + '.' + member.first, member.second, map);
      return;
    default: throw ParameterKeyError(key, key + ": is of a type that no parameter has");
  }
}

/// readParameters(); the file of another kind than `part` is named as that.
template <class Struct>
void readPart(const ros::NodeHandle& node, const std::string& part, Struct& parameters, MissingKeys missing_keys) {
  try {
    readParameters(node, part, parameters, missing_keys);
  } catch (const ParameterError&) {
    const std::string kind = kindOf(readParameterMap(node, part));
    if (kind.empty() || kind == part) throw;
    throw ParameterError(node.resolveName(part) + ": is the file of a " + kind + ": give it as " + kind +
                         ":=, not as " + part + ":=");
  }
}

}  // namespace

ParameterMap toParameterMap(const XmlRpcValue& value) {
  ParameterMap map;
  if (!value.valid()) return map;
  if (value.getType() != XmlRpcValue::TypeStruct) throw ParameterError("is a value, not a group of parameters");
  collect("", value, map);
  return map;
}

ParameterMap readParameterMap(const ros::NodeHandle& node, const std::string& name) {
  XmlRpcValue value;
  const std::string place = name.empty() ? node.getNamespace() : node.resolveName(name);
  if (!node.getParam(place, value)) return {};
  return toParameterMap(value);
}

std::string readText(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise) {
  std::string text;
  return node.getParam(name, text) ? text : otherwise;
}

std::optional<double> readNumber(const ros::NodeHandle& node, const std::string& name) {
  double number = 0.0;
  return node.getParam(name, number) ? std::optional<double>(number) : std::nullopt;
}

PipelineParameters readPipelineParameters(const ros::NodeHandle& node) {
  for (const char* part : {"profile", "vehicle", "sensor"}) {
    if (node.hasParam(part)) continue;
    throw ParameterError(node.resolveName(part) + ": not on the parameter server; load a file of cfg/" + part +
                         "s there (launch/odometry.launch does)");
  }
  for (const std::string part : {"vehicle", "sensor"}) {  // as calibrate_azimuth writes them, for offline tools
    if (!node.hasParam("profile/" + part)) continue;
    throw ParameterError(node.resolveName("profile") + ": keys of " + part +
                         " do not belong here: set them in a copy of a file of cfg/" + part + "s, and give " + part +
                         ":=/path/FILE.yaml");
  }
  PipelineParameters parameters;
  readPart(node, "profile", parameters.profile, MissingKeys::kKeep);
  readPart(node, "vehicle", parameters.vehicle, MissingKeys::kRefuse);
  readPart(node, "sensor", parameters.sensor, MissingKeys::kRefuse);
  validate(parameters);
  return parameters;
}

}  // namespace fail_aware
