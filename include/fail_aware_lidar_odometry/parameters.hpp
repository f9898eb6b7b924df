// The odometry's parameters: files of the package or your own, and single keys over them. doc/parameters.md lists the
// keys.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace fail_aware {

/// A name is the stem of a file of the package (cfg/profiles, cfg/vehicles, cfg/sensors) or the path of a yaml file.
struct Parameters {
  std::string profile = "default";
  std::string vehicle = "passat_b6";
  std::string sensor = "hdl64e";
  std::vector<std::string> files{};  ///< yaml files with some keys each, as the calibrations write them
  /// Key -> value as text, the last word: {"sensor.timing.source", "none"},
  /// {"sensor.lidar_in_base", "[0, 0, 1.7, 0, 0, 0]"}
  std::map<std::string, std::string> overrides{};
  std::string
      cfg{};  ///< the folder with profiles/, vehicles/, sensors/; empty: the one that is installed with the library
};

}  // namespace fail_aware
