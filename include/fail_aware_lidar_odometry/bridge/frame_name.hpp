// Removes a leading slash: tf2's frame names have none.
#pragma once

#include <string>

namespace fail_aware {

inline std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

}  // namespace fail_aware
