// The odometry as a library, without ROS: reads a folder of scans in KITTI's layout (DIR/velodyne/*.bin, ten a second)
// and prints for each sweep its stamp, position, standard deviation of the position since t1, state and time to
// failure. t1 is the first sweep whose motion is observed. Stamps of KITTI and of simulate_drive mean the middle of a
// sweep; without point times, `auto` would take them for its end. To build it: examples/minimal_project.
// usage: minimal DIR
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "fail_aware_lidar_odometry/odometry.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: minimal DIR\n"), 2;
  std::error_code error;  // a folder that cannot be read has no scans
  const std::filesystem::directory_iterator folder(std::filesystem::path(argv[1]) / "velodyne", error);
  const std::set<std::filesystem::path> scans(begin(folder), end(folder));  // sorted
  if (scans.empty()) return std::fprintf(stderr, "minimal: error: no scans in %s/velodyne\n", argv[1]), 1;
  fail_aware::Parameters parameters;  // profile default
  parameters.overrides["sensor.timing.stamp_reference"] = "mid";
  fail_aware::Odometry odometry(parameters);
  odometry.startRedundant();
  double stamp_s = 0.0;
  for (const std::filesystem::path& path : scans) {
    fail_aware::Sweep sweep;
    sweep.stamp_s = stamp_s;
    std::ifstream file(path, std::ios::binary);
    for (float p[4]; file.read(reinterpret_cast<char*>(p), sizeof p);)
      sweep.points_lidar.emplace_back(p[0], p[1], p[2]);
    const fail_aware::Result result = odometry.step(std::move(sweep));
    const Eigen::Vector3d position = result.T_odom_base.translation();
    std::printf("%.3f s  x %.3f y %.3f z %.3f m  sigma %.3f %.3f m  %s  %.1f s\n", stamp_s, position.x(), position.y(),
                position.z(), result.monitor.sigma_x_m, result.monitor.sigma_y_m, toString(result.monitor.state),
                result.monitor.time_to_failure.seconds);
    stamp_s += 0.1;
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "minimal: error: %s\n", error.what());
  return 1;
}
