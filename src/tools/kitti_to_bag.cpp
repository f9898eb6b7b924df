// kitti_to_bag: a drive in KITTI's folder layout -> a bag in kitti2bag's layout.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <string>

#include "bridge/kitti_bag_writer.hpp"
#include "core/io/kitti_directory.hpp"
#include "core/io/profile_files.hpp"
#include "core/io/trajectory_io.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;
namespace fs = std::filesystem;

constexpr const char* kName = "kitti_to_bag";
constexpr double kClockTime_s = 1e8;                // larger stamps are from a clock, smaller ones from a stopwatch
constexpr double kStopwatchStart_s = 1317000000.0;  // late September 2011, when KITTI was recorded
constexpr double kLatest_s = 4294967295.0;          // end of ros::Time's range

struct Options {
  std::string directory, bag;
  ProfileFiles files;
  double period_s = 0.1;
  std::optional<double> start_s;
  ScanRange scans;
  bool point_times = false, with_tf = false;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("directory", options.directory,
                 "velodyne/NNNNNN.bin or velodyne_points/data/NNNNNNNNNN.bin; optional "
                 "times.txt, stamps/NNNNNN.f32, rings/NNNNNN.u16, and poses_velodyne.txt or poses.txt (with calib.txt: "
                 "the camera's)")
      ->required();
  app.add_option("bag", options.bag, "the file to write")->required();
  app.add_flag("--point-times", options.point_times, "a field `time` (s from the sweep's start) from stamps/");
  app.add_flag("--with-tf", options.with_tf,
               "the true pose also as /tf world -> base_link, as kitti2bag does; the "
               "odometry must then not publish odom -> base_link");
  app.add_option("--period", options.period_s, "s between scans if there is no times.txt")
      ->check(positiveNumber())
      ->capture_default_str();
  app.add_option("--start", options.start_s, "s added to the stamps (default: 1317000000 if they begin near zero)")
      ->check(realNumber(-kLatest_s, kLatest_s));
  app.add_option("--sensor", options.files.sensor,
                 "a file of cfg/sensors, or a yaml file: its lidar_in_base becomes "
                 "base_link -> velo_link")
      ->capture_default_str();
  app.add_option("--cfg", options.files.cfg, "the package's cfg folder (default: found from the tool's own place)");
  options.scans.addOptions(app);
}

ros::Time bagTime(double stamp_s) {
  const double whole_s = std::floor(stamp_s);
  const long nanoseconds = std::lround((stamp_s - whole_s) * 1e9);
  return ros::Time(static_cast<std::uint32_t>(whole_s), 0) + ros::Duration(0, static_cast<std::int32_t>(nanoseconds));
}

/// Seconds to add to the stamps, so that a bag can store all of them.
double startOf(const Options& options, const std::vector<double>& stamps_s) {
  const double start_s = options.start_s.value_or(stamps_s.front() < kClockTime_s ? kStopwatchStart_s : 0.0);
  if (!(stamps_s.front() + start_s >= 1.0) || !(stamps_s.back() + start_s <= kLatest_s)) {
    throw InputError("--start " + std::to_string(start_s) +
                     ": the resulting stamps must be between 1 s and 4294967295 s");
  }
  return start_s;
}

/// The beams of a simulated drive are where their file says; KITTI's are 0.205 deg too low.
bool isSimulated(const std::string& directory) {
  return std::filesystem::exists(std::filesystem::path(directory) / "simulation.json");
}

int run(const Options& options) {
  const KittiDirectory directory = KittiDirectory::open(options.directory, options.period_s);
  const long last = options.scans.end(directory.size(), options.directory);
  if (options.point_times && !directory.hasPointTimes()) {
    throw InputError("--point-times: " + options.directory + " has no folder stamps/");
  }
  const KittiGroundTruth truth = readKittiGroundTruth(options.directory, directory.size());
  if (options.with_tf && truth.source.empty()) {
    throw InputError("--with-tf: " + options.directory + " has no poses.txt or poses_velodyne.txt");
  }
  const std::vector<double>& stamps_s = directory.stamps();
  if (std::adjacent_find(stamps_s.begin(), stamps_s.end(), std::greater_equal<>()) != stamps_s.end()) {
    throw InputError(options.directory + "/times.txt: does not increase; a bag is in the order of time");
  }
  const double start_s = startOf(options, stamps_s);
  const Pose T_base_lidar = loadPipelineParameters(options.files).sensor.T_base_lidar();

  KittiBagWriter writer(options.bag, {T_base_lidar, options.point_times, options.with_tf});
  std::size_t bad_scans = 0, points = 0, warnings = 0;
  Sweep sweep;
  {
    ProgressBar progress(static_cast<std::size_t>(last - options.scans.first));
    for (long i = options.scans.first; i < last; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const ReadResult read = directory.read(index, sweep);
      if (read.status != ReadStatus::kOk && ++warnings <= kBadScansNamed) {
        std::cerr << kName << ": warning: " << read.message
                  << (read.hasPoints() ? "" : "; written as a cloud without points") << std::endl;
      }
      if (!read.hasPoints()) ++bad_scans;
      points += sweep.size();
      std::optional<Pose> T_world_base;
      if (!truth.poses.empty()) T_world_base = T_base_lidar * truth.poses[index] * T_base_lidar.inverse();
      writer.add(bagTime(sweep.stamp_s + start_s), sweep, T_world_base);
      progress.update(static_cast<std::size_t>(i - options.scans.first + 1));
    }
  }
  writer.close();
  if (warnings > kBadScansNamed) {
    std::cerr << kName << ": warning: " << warnings - kBadScansNamed << " more such scans" << std::endl;
  }
  std::cout << options.bag << ": " << last - options.scans.first << " sweeps (" << bad_scans << " without points), "
            << points << " points, ground truth: " << (truth.source.empty() ? "none" : truth.source) << std::endl;
  if (bad_scans == static_cast<std::size_t>(last - options.scans.first)) {
    return reportError(kName, "no scan of " + options.directory + " could be used", kExitFailed);
  }
  std::cerr << kName << ": next: roslaunch fail_aware_lidar_odometry kitti_replay.launch bag:="
            << std::filesystem::absolute(options.bag).string()
            << (isSimulated(options.directory) ? " vertical_angle_deg:=0" : "") << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Writes a drive in KITTI's folder layout as a bag with the topics, fields and frames of kitti2bag: "
        "/kitti/velo/pointcloud, /tf_static, and the true pose as /kitti/ground_truth.\n"
        "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    addOptions(app, options);
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
