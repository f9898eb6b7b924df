// The nodelet manager keeps to itself why a nodelet could not be loaded; here the log has it (a parameter's name and
// rule).
#pragma once

#include <ros/console.h>

#include <exception>
#include <string>

namespace fail_aware {

/// Passes the exception on: the manager must not take the nodelet for loaded.
template <class Load>
void loadOrSayWhy(const std::string& nodelet_name, const Load& load) {
  try {
    load();
  } catch (const std::exception& error) {
    ROS_FATAL("%s is not loaded: %s", nodelet_name.c_str(), error.what());
    throw;
  }
}

}  // namespace fail_aware
