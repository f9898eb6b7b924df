// The arguments of a simulated drive, shared by the tools that write it and that publish it.
#pragma once

#include <string>
#include <vector>

#include "core/io/input_error.hpp"
#include "simulation/drive_simulation.hpp"
#include "simulation/fault.hpp"

namespace fail_aware {

/// Throws what Fault::parse throws, and InputError for a fault that begins after the drive.
inline std::vector<Fault> parseFaults(const std::vector<std::string>& texts, double drive_s) {
  std::vector<Fault> faults;
  faults.reserve(texts.size());
  for (const std::string& text : texts) {
    faults.push_back(Fault::parse(text));
    if (faults.back().start_s >= drive_s) throw InputError("fault " + text + " would begin after the drive");
  }
  return faults;
}

}  // namespace fail_aware
