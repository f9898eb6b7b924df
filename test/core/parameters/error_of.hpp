// What a refusal says, for tests.
#pragma once

#include <string>

#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

/// The ParameterError's text, or "no error".
template <class Action>
std::string errorOf(Action&& action) {
  try {
    action();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace fail_aware
