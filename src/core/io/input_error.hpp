// The error for input that cannot be read or is inconsistent: missing files, malformed lines, counts that disagree.
//
// Thrown only where data enters the program (file readers, tools), never per sweep. The message names the file and, if
// there is one, the line; the tools print it and exit with code 2.
#pragma once

#include <stdexcept>
#include <string>

namespace fail_aware {

class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace fail_aware
