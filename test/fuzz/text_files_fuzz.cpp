// Trajectories, times, calibration and the two logs, of any bytes; the logs with any rows below their header, too.
#include <cmath>

#include "core/io/input_error.hpp"
#include "core/io/measurement_log.hpp"
#include "core/io/monitor_log.hpp"
#include "core/io/trajectory_io.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string path = freshFolder() + "/file.txt";
  const int kind = data[0] % 8;
  const std::string header = kind == 6 ? measurementLogHeader() + '\n' : kind == 7 ? monitorLogHeader() + '\n' : "";
  writeFile(path, header + std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  try {
    switch (kind) {
      case 0:
        for (const Pose& T : readKittiTrajectory(path)) promise(T.matrix().allFinite(), "poses are finite");
        break;
      case 2:
        for (const double stamp_s : readTimes(path)) promise(std::isfinite(stamp_s), "stamps are finite");
        break;
      case 3: promise(readLidarToCamera(path).matrix().allFinite(), "the calibration is finite"); break;
      case 4:
      case 6: readMeasurementLog(path); break;
      default: readMonitorLog(path);
    }
  } catch (const InputError&) {
  }
  return 0;
}
