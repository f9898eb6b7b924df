// Finds the error of the head's azimuth from drives alone: yaml on stdout or in a file.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "core/io/trajectory_io.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"
#include "evaluation/azimuth_calibration.hpp"
#include "result_files.hpp"
#include "run_folder.hpp"
#include "run_parameters.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;
namespace fs = std::filesystem;

constexpr const char* kName = "calibrate_azimuth";
constexpr const char* kKey = "sensor.azimuth.angle_deg";
constexpr double kUsefulSigma_deg = 0.1;
constexpr double kMostBends = 0.7;  // from here on they make its variance 3 times as large, and more

struct Options {
  std::vector<std::string> runs, trajectories;
  std::string output;
};

std::vector<Pose> baseTrajectory(const fs::path& run, const Pose& T_base_lidar) {
  std::vector<Pose> poses = readKittiTrajectory((run / "trajectory_kitti.txt").string());
  for (Pose& T : poses) T = T_base_lidar * T * T_base_lidar.inverse();
  return poses;
}

int run(const Options& options) {
  if (options.runs.empty() == options.trajectories.empty()) {
    throw InputError("--run or --trajectory is needed, and not both (see --help)");
  }
  std::vector<std::vector<Pose>> trajectories;
  for (const std::string& file : options.trajectories) {
    trajectories.push_back(readKittiTrajectory(file));
    if (movesLikeACamera(trajectories.back())) {
      throw InputError(file + ": it " + kMovesLikeACamera + "; those of the lidar are needed");
    }
  }
  SensorParameters sensor;
  for (const fs::path folder : options.runs) {
    readRunSummary(folder);
    const SensorParameters own = sensorOfRun(folder);
    if (trajectories.empty()) sensor = own;
    if (own.azimuth.angle_deg != sensor.azimuth.angle_deg || own.lidar_in_base != sensor.lidar_in_base) {
      throw InputError(folder.string() + ": its " + kKey + " or sensor.lidar_in_base is not that of " +
                       options.runs.front() + ": make all runs with the same");
    }
    trajectories.push_back(baseTrajectory(folder, own.T_base_lidar()));
  }
  const DirectionOfTravel found = directionOfTravel(trajectories);
  char text[200];
  std::snprintf(text, sizeof(text),
                "%d motions, %.0f m: the vehicle travels %+.3f deg off base_link's x axis (positive: to the left, seen "
                "from above), "
                "+- %.3f deg",
                found.motions, found.distance_m, found.direction_deg, found.sigma_deg);
  std::cerr << kName << ": " << text << std::endl;
  if (found.curvature_ratio > kMostBends) {
    std::cerr
        << kName
        << ": warning: nearly all of that may be the curvature of these drives; give some with curvatures to both "
        << "sides, or straight on" << std::endl;
  } else if (found.sigma_deg > kUsefulSigma_deg) {
    std::cerr << kName << ": warning: that is not known to " << kUsefulSigma_deg
              << " deg; give more drives, or longer ones" << std::endl;
  }
  const double lidar_up = sensor.T_base_lidar().linear()(2, 2) < 0.0 ? -1.0 : 1.0;  // or it hangs
  const double angle_deg = std::round(1e3 * (sensor.azimuth.angle_deg - lidar_up * found.direction_deg)) / 1e3 + 0.0;
  if (std::abs(angle_deg) > AzimuthCorrectionParams::kMax_deg) {
    throw InputError("that is more than " + std::string(kKey) + " takes (" +
                     std::to_string(std::lround(AzimuthCorrectionParams::kMax_deg)) +
                     " deg): it is how the lidar is mounted, to be told by tf or sensor.lidar_in_base");
  }
  printAndKeep(formatYaml({{kKey, angle_deg}}), options.output);
  std::cerr << kName << ": next: offline_odometry --parameters "
            << (options.output.empty() ? "FILE (--output FILE keeps it)" : options.output)
            << "; on the vehicle: the same angle in the sensor file or, added to the lidar's yaw, in tf" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Finds sensor.azimuth.angle_deg from runs of offline_odometry, without ground truth: turned by it, the "
        "vehicle goes along base_link's x axis when it goes straight on. Use drives on ordinary roads, as many "
        "curvatures to the left as to the right, on which the odometry was not lost; use what is printed with "
        "--parameters.\n"
        "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    app.add_option("--run", options.runs,
                   "folder that offline_odometry wrote; may be repeated: one lidar, one vehicle");
    app.add_option(
        "--trajectory", options.trajectories,
        "in its place: KITTI rows of the lidar, its x axis ahead; may be repeated. A ground truth tells which "
        "way it says that the vehicle travels");
    app.add_option("--output", options.output, "yaml file with the angle, for --parameters");
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
