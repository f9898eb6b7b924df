// Checks a nodelet's private namespace. It may contain: the nodelet's own parameters; those that can change at run
// time, which dynamic_reconfigure stores there; and ROS's. Anything else is refused.
#pragma once

#include <ros/ros.h>

#include <string>
#include <vector>

#include "bridge/parameter_server.hpp"

namespace fail_aware {

/// For a nodelet without its own parameters.
struct NoOwnParams {
  template <class Self, class Visitor>
  static void visit(Self& /*self*/, Visitor&& /*v*/) {}
};

/// The Tuning of a nodelet without parameters that change at run time.
using NoTuning = NoOwnParams;

/// Reads `own`; missing keys keep their values. `groups`: prefixes of keys that the nodelet reads itself.
/// Throws ParameterError.
template <class Own, class Tuning>
void readPrivateParameters(const ros::NodeHandle& private_node, Own& own, const Tuning& tuning,
                           std::vector<std::string> groups = {}) {
  for (const char* of_ros : {"diagnostic_period", "diagnostic_updater_use_fqn", "num_worker_threads"}) {
    groups.emplace_back(of_ros);
  }
  const ParameterMap owned = toMap(own);
  for (const auto& [name, value] : toMap(tuning)) {
    if (owned.count(name) == 0) groups.push_back(name);
  }
  readParameters(private_node, "", own, MissingKeys::kKeep, groups);
}

/// Warns of values in the private namespace that can change at run time and are ignored: left from an earlier run, or
/// written there instead of into the profile. Call this before dynamic_reconfigure writes there.
template <class Own, class Tuning>
void warnOfOtherValues(const ros::NodeHandle& private_node, const Own& own, const Tuning& tuning) {
  const ParameterMap here = readParameterMap(private_node, ""), owned = toMap(own);
  for (const auto& [name, value] : toMap(tuning)) {
    const auto other = here.find(name);
    if (owned.count(name) != 0 || other == here.end() || other->second == value) continue;
    ROS_WARN("%s/%s: the profile's value counts, not what stands here, which is another",
             private_node.getNamespace().c_str(), name.c_str());
  }
}

}  // namespace fail_aware
