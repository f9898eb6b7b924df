// A folder in KITTI's layout of any bytes -> sweeps.
#include <cmath>

#include "core/io/input_error.hpp"
#include "core/io/kitti_directory.hpp"
#include "fuzz_input.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const std::string folder = freshFolder();
  const bool raw = input.flag();
  const std::string scans = folder + (raw ? "/velodyne_points/data" : "/velodyne");
  std::filesystem::create_directories(scans);
  if (input.flag()) writeFile(folder + (raw ? "/velodyne_points/timestamps.txt" : "/times.txt"), input.text(200));
  if (input.flag()) {
    std::filesystem::create_directories(folder + "/stamps");
    writeFile(folder + "/stamps/000000.f32", input.text(200));
  }
  if (input.flag()) {
    std::filesystem::create_directories(folder + "/rings");
    writeFile(folder + "/rings/000000.u16", input.text(200));
  }
  writeFile(scans + "/000000.bin", input.rest());
  try {
    const KittiDirectory directory = KittiDirectory::open(folder);
    for (std::size_t i = 0; i < directory.size(); ++i) {
      Sweep sweep;
      const ReadResult result = directory.read(i, sweep);
      promise(result.hasPoints() == !sweep.points_lidar.empty(), "points if and only if the status says so");
      promise(std::isfinite(sweep.stamp_s), "a stamp is finite");
      for (const auto& point : sweep.points_lidar) promise(point.allFinite(), "points are finite");
    }
  } catch (const InputError&) {
  }
  return 0;
}
