// The odometry as a library, without ROS: reads a folder of scans in KITTI's layout and prints for each sweep its stamp,
// position, standard deviation of the position since t1, state and time to failure. t1 is the first sweep whose
// motion is observed.
// usage: minimal DIR
#include <cmath>
#include <cstdio>
#include <exception>

#include "fail_aware_lidar_odometry/core/io/kitti_directory.hpp"
#include "fail_aware_lidar_odometry/core/io/profile_files.hpp"
#include "fail_aware_lidar_odometry/core/odometry_pipeline.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: minimal DIR\n"), 2;
  const fail_aware::KittiDirectory drive = fail_aware::KittiDirectory::open(argv[1]);
  fail_aware::OdometryPipeline odometry(fail_aware::loadPipelineParameters({}), 2);  // profile default, 2 threads
  odometry.startRedundant();
  for (std::size_t i = 0; i < drive.size(); ++i) {
    fail_aware::Sweep sweep;
    drive.read(i, sweep);  // a scan that cannot be read is an empty sweep: the vehicle model carries the pose
    const fail_aware::SweepResult result = odometry.step(sweep);
    const Eigen::Vector3d position = result.T_odom_base.translation();
    std::printf("%.3f s  x %.3f y %.3f z %.3f m  sigma %.3f %.3f m  %s  %.1f s\n", drive.stamps()[i], position.x(),
                position.y(), position.z(), result.monitor.sigma_x_m, result.monitor.sigma_y_m,
                fail_aware::toString(result.monitor.state), result.monitor.time_to_failure.seconds);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "minimal: error: %s\n", error.what());
  return 1;
}
