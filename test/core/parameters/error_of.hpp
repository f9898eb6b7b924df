// What a refusal says, for tests.
#pragma once

#include <string>

#include "core/parameters/check.hpp"

namespace fail_aware {

inline const std::string kNoError = "no error";

/// The ParameterError's text, or kNoError.
template <class Action>
std::string errorOf(Action&& action) {
  try {
    action();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return kNoError;
}

}  // namespace fail_aware
