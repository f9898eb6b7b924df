// dynamic_reconfigure of a nodelet: a Tuning struct (tuning.hpp) behind a generated Config with the same names.
//
// At start-up the Config gets the values that the nodelet runs with, whatever the .cfg's defaults are. A request that
// gives an invalid set changes nothing: it is refused in the log, in the diagnostics, and in the reply, which contains
// the old values. A yaml value beyond the .cfg's bounds stays until a request changes it.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>

#include <boost/thread/recursive_mutex.hpp>
#include <functional>
#include <string>
#include <utility>

#include "core/parameters/parameter_map.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware {

template <class Config>
ParameterMap valuesOf(const Config& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  ParameterMap values;
  for (const auto& value : message.bools) values[value.name] = value.value != 0;
  for (const auto& value : message.ints) values[value.name] = static_cast<int>(value.value);
  for (const auto& value : message.doubles) values[value.name] = value.value;
  for (const auto& value : message.strs) values[value.name] = value.value;
  return values;
}

template <class Config, class Tuning>
Config configOf(const Tuning& tuning) {
  const ParameterMap values = toMap(tuning);
  Config config = Config::__getDefault__();
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  for (auto& value : message.bools) value.value = std::get<bool>(values.at(value.name));
  for (auto& value : message.ints) value.value = std::get<int>(values.at(value.name));
  for (auto& value : message.doubles) value.value = std::get<double>(values.at(value.name));
  for (auto& value : message.strs) value.value = std::get<std::string>(values.at(value.name));
  config.__fromMessage__(message);
  return config;
}

/// The set that results from a request. Throws ParameterError.
template <class Config, class Tuning>
Tuning tunedBy(const Config& request, const Tuning& current) {
  Config clamped = configOf<Config>(current);
  clamped.__clamp__();
  const ParameterMap bounded = valuesOf(clamped);
  const ParameterMap mine = toMap(current);
  ParameterMap wanted = valuesOf(request);
  for (auto& [name, value] : wanted) {
    if (value == bounded.at(name)) value = mine.at(name);
  }
  Tuning tuning = current;
  fromMap(tuning, wanted);
  validate(tuning);
  return tuning;
}

template <class Config, class Tuning>
class Reconfiguration {
 public:
  /// `apply` is called with each new set that differs from the last one. Callbacks come from private_node's queue.
  Reconfiguration(const ros::NodeHandle& private_node, const Tuning& current, std::function<void(const Tuning&)> apply)
      : name_(private_node.getNamespace()), current_(current), apply_(std::move(apply)), server_(mutex_, private_node) {
    server_.updateConfig(configOf<Config>(current_));
    server_.setCallback([this](Config& config, std::uint32_t) { onRequest(config); });
  }

  /// Reports why the last request was refused, if it was.
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
    if (!refused_.empty()) status.add("reconfiguration refused", refused_);
  }

 private:
  void onRequest(Config& config) {
    try {
      const Tuning tuning = tunedBy(config, current_);
      if (toMap(tuning) != toMap(current_)) apply_(tuning);
      current_ = tuning;
      refused_.clear();
    } catch (const ParameterError& error) {
      refused_ = error.what();
      ROS_ERROR("%s: reconfiguration refused, nothing is changed: %s", name_.c_str(), error.what());
    }
    config = configOf<Config>(current_);
  }

  std::string name_;
  Tuning current_;
  std::function<void(const Tuning&)> apply_;
  std::string refused_;  ///< reason, if the last request was refused; otherwise empty
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<Config> server_;
};

}  // namespace fail_aware
