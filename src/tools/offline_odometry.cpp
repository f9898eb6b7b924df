// offline_odometry: runs the odometry over every sweep of a recorded drive and writes trajectory and statistics.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/integrity/monitor_replay.hpp"
#include "core/io/kitti_directory.hpp"
#include "core/io/profile_files.hpp"
#include "core/odometry_pipeline.hpp"
#include "core/parameters/mounting.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "drive_results.hpp"
#include "first_points.hpp"
#include "json.hpp"
#include "poses_from_outside.hpp"
#include "run_folder.hpp"
#include "tool_support.hpp"
#ifdef FAIL_AWARE_WITH_BAGS
#include "bridge/bag_sweep_source.hpp"
#endif

namespace {

using namespace fail_aware;
constexpr const char* kName = "offline_odometry";
const std::vector<std::string> kFiles = {"trajectory_kitti.txt", "trajectory_tum.txt", "per_sweep.csv",
                                         "monitor_log.csv",      "measurements.csv",   "parameters.yaml"};

struct Options {
  std::string kitti, topic, base_frame = "base_link";
  std::vector<std::string> bags;
  std::vector<double> lidar_in_base;
  std::string output;
  ProfileFiles files;
  std::vector<std::string> parameters, set;
  int threads = 2;
  ScanRange scans;
  double redundant_at_s = 0.0;
  PoseFiles poses;
};

void addOptions(CLI::App& app, Options& options) {
  [[maybe_unused]] CLI::Option* kitti = app.add_option(
      "--kitti", options.kitti,
      "folder with velodyne/NNNNNN.bin, optional times.txt, stamps/NNNNNN.f32, rings/NNNNNN.u16; or of KITTI raw");
#ifdef FAIL_AWARE_WITH_BAGS
  CLI::Option* bag =
      app.add_option("--bag", options.bags,
                     "bag with clouds; may be repeated: the parts of one drive, in the order of their recording. The "
                     "lidar's mounting comes from /tf_static, or from /tf if it is constant there")
          ->take_all()
          ->excludes(kitti);
  app.add_option("--topic", options.topic, "topic of the clouds (default: the bag's only sensor_msgs/PointCloud2)")
      ->needs(bag);
  app.add_option("--base-frame", options.base_frame, "the vehicle's frame in the bag's /tf_static and /tf")
      ->needs(bag)
      ->capture_default_str();
#else
  app.add_option("--bag", options.bags)->group("");  // not in the help, but refused by its cause
#endif
  app.add_option("--lidar-in-base", options.lidar_in_base,
                 "X,Y,Z,ROLL,PITCH,YAW of the lidar in base_link, m and rad; overrides the transforms of a bag and the "
                 "parameter sensor.lidar_in_base")
      ->delimiter(',')
      ->expected(1, 6);
  app.add_option("--output", options.output, "folder for the results; created if it does not exist")->required();
  app.add_option("--profile", options.files.profile, "default, paper, or a yaml file")->capture_default_str();
  app.add_option("--vehicle", options.files.vehicle, "a file of cfg/vehicles, or a yaml file")->capture_default_str();
  app.add_option("--sensor", options.files.sensor, "a file of cfg/sensors, or a yaml file")->capture_default_str();
  app.add_option("--cfg", options.files.cfg, "the package's cfg folder (default: found from the tool's own place)");
  app.add_option("--parameters", options.parameters,
                 "yaml file with some parameters, as the calibrations write it; overrides the profile; may be repeated")
      ->take_all();
  app.add_option("--set", options.set, "key=value, overrides one parameter; may be repeated")->take_all();
  app.add_option("--threads", options.threads, "number of threads for the measurements")
      ->transform(wholeNumber(1, 256))
      ->capture_default_str();
  options.scans.addOptions(app);
  app.add_option("--redundant-at", options.redundant_at_s,
                 "t1: seconds from the first sweep at which the odometry "
                 "begins to serve as the localisation")
      ->check(realNumber(0.0))
      ->capture_default_str();
  app.add_option("--external-poses", options.poses.external,
                 "CSV of external poses (GPS) for the fusion; may be repeated. Columns: stamp,x,y,z,qx,qy,qz,qw,"
                 "sigma_x,sigma_y,sigma_z,sigma_roll,sigma_pitch,sigma_yaw of base_link in odom (s, m, rad); sigmas of "
                 "the rotation 0: not measured")
      ->take_all();
  app.add_option("--pose-tolerance", options.poses.tolerance_s, "largest time between such a pose and its sweep, s")
      ->check(realNumber(0.0))
      ->capture_default_str();
  app.add_option("--set-pose", options.poses.set,
                 "CSV with the same columns: at each stamp base_link is set to the pose; odom moves under it");
}

double maxRssMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

Json levelSummary(const VerticalReference::Report& report) {
  return {{"looks", report.looks},
          {"tilt_deg", report.tilt_deg},
          {"tilt_sigma_deg", report.tilt_sigma_deg},
          {"drift_deg_per_m", report.drift_deg_per_m},
          {"drift_sigma_deg_per_m", report.drift_sigma_deg_per_m},
          {"elevation_deg", report.elevation_deg},
          {"elevation_sigma_deg", report.elevation_sigma_deg},
          {"curvature_deg_per_m", report.curvature_deg_per_m}};
}

/// Unknown values are null.
Json clockSummary(const SweepClock& clock) {
  const auto orNull = [](std::optional<double> value) { return value ? Json(*value) : Json(nullptr); };
  return {{"period_s", orNull(clock.period_s())},
          {"jitter_s", orNull(clock.jitter_s())},
          {"stamps_left_out", clock.outliers()}};
}

/// Whether the command line gives the lidar's mounting. The sensor file does not count: it always contains one.
bool saysWhereLidarSits(const Options& options) {
  const std::string key = "sensor.lidar_in_base";
  const auto sets = [&](const std::string& assignment) { return assignment.rfind(key + '=', 0) == 0; };
  const auto holds = [&](const std::string& file) { return readYaml(file).values.count(key) != 0; };
  return !options.lidar_in_base.empty() || std::any_of(options.set.begin(), options.set.end(), sets) ||
         std::any_of(options.parameters.begin(), options.parameters.end(), holds);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Opens the drive and sets the sensor parameters that the drive contains.
std::unique_ptr<SweepSource> openDrive(const Options& options, SensorParameters& sensor) {
#ifdef FAIL_AWARE_WITH_BAGS
  if (options.kitti.empty() && options.bags.empty()) throw InputError("--kitti or --bag is needed (see --help)");
  const std::filesystem::path kitti(options.kitti);
  std::error_code error;  // what cannot be looked at counts as missing
  if (kitti.extension() == ".bag" && std::filesystem::is_regular_file(kitti, error)) {
    throw InputError(options.kitti + ": is a bag, not a folder: give it with --bag");
  }
  if (!options.bags.empty()) {
    auto bag = std::make_unique<BagSweepSource>(options.bags, options.topic);
    if (bag->topic().rfind("/kitti/", 0) == 0) sensor.timing.useKittiStamps();
    if (saysWhereLidarSits(options)) return bag;
    const BagSweepSource::Mounting mounting = bag->lidarInBase(options.base_frame);
    if (!mounting.T_base_lidar) {
      throw InputError(joined(options.bags) + ": " + mounting.why_not +
                       "; give the lidar's place with --lidar-in-base X,Y,Z,ROLL,PITCH,YAW (m, rad), or the vehicle's "
                       "frame with --base-frame");
    }
    const Vector6d lidar_in_base = vectorFromPose(*mounting.T_base_lidar);
    sensor.lidar_in_base.assign(lidar_in_base.data(), lidar_in_base.data() + 6);
    return bag;
  }
#endif
  if (!options.bags.empty()) throw InputError("this build has no ROS and reads no bags; give a folder with --kitti");
  if (options.kitti.empty()) throw InputError("--kitti is needed (see --help)");
  sensor.timing.useKittiStamps();
  return std::make_unique<KittiSweepSource>(options.kitti);
}

void warn(const std::string& text) { std::cerr << kName << ": warning: " << text << std::endl; }

/// Skips to the run's first scan. The stamp of the drive's first scan, if that is skipped.
std::optional<double> skipTo(std::size_t first, SweepSource& drive) {
  if (first == 0) return std::nullopt;
  Sweep sweep;
  drive.next(sweep);
  drive.skip(first - 1);
  return sweep.stamp_s;
}

/// Returns the stamp of the run's first scan.
double runOver(SweepSource& drive, std::size_t scans, FirstPoints& points, PosesFromOutside& poses,
               double redundant_at_s, OdometryPipeline& pipeline, DriveResults& results) {
  double begin_stamp_s = 0.0;
  Sweep sweep;
  ProgressBar progress(scans);
  for (std::size_t i = 0; i < scans; ++i) {
    const ReadResult read = drive.next(sweep);
    if (i == 0) {
      begin_stamp_s = sweep.stamp_s;
      pipeline.startRedundant(sweep.stamp_s + redundant_at_s - kStartTolerance_s);
    }
    const double stamp_s = sweep.stamp_s;
    const std::size_t points_dropped = sweep.points_dropped;
    if (const std::string fault = points.look(sweep, drive.name()); !fault.empty()) warn(fault);
    poses.offer(stamp_s);
    const SweepResult result = read.status == ReadStatus::kOtherFrame ? pipeline.refuse() : pipeline.step(sweep);
    if (!result.pose_set.refused.empty()) warn("--set-pose: refused: " + result.pose_set.refused);
    poses.note(stamp_s, result.refused_poses);
    results.add(read, drive.name(), stamp_s, points_dropped, result);
    progress.update(i + 1);
  }
  return begin_stamp_s;
}

/// The user put it beside an earlier run, for evaluate_fail_aware. It may be another drive's.
void setAsideFaultsOfAnEarlierRun(const std::filesystem::path& output) {
  const std::filesystem::path faults = output / "faults.csv", aside = output / "faults_of_earlier_run.csv";
  std::error_code error;
  std::filesystem::rename(faults, aside, error);
  if (error) return;  // there is none
  warn(faults.string() + " is of an earlier run and is now " + aside.filename().string() +
       "; copy the one of this drive, if it has one");
}

int run(const Options& options) {
  if (!options.lidar_in_base.empty()) requireMounting("--lidar-in-base", options.lidar_in_base);
  PipelineParameters params = loadPipelineParameters(options.files);
  const std::string stamp_reference = params.sensor.timing.stamp_reference;
  const std::unique_ptr<SweepSource> drive = openDrive(options, params.sensor);
  const bool kitti_stamps = params.sensor.timing.stamp_reference != stamp_reference;  // whatever its times count from
  const std::string drive_name = options.bags.empty() ? options.kitti : joined(options.bags);
  const long last = options.scans.end(drive->size(), drive_name);
  overrideParameters(params, options.parameters, options.set);
  if (!options.lidar_in_base.empty()) params.sensor.lidar_in_base = options.lidar_in_base;
  const bool from_sensor_file = options.bags.empty() && !saysWhereLidarSits(options);
  const std::string placeholder = from_sensor_file ? placeholderFault(params.sensor.lidar_in_base) : "";
  OdometryPipeline pipeline(params, options.threads);
  PosesFromOutside poses(options.poses, pipeline);
  RunFolder folder(options.output, kFiles);  // after all input that may be refused
  DriveResults results(folder.unfinished(), params);
  if (!placeholder.empty()) warn(placeholder + ", or give --lidar-in-base");
  const std::optional<double> skipped_stamp_s = skipTo(static_cast<std::size_t>(options.scans.first), *drive);
  FirstPoints points(params.profile.registration.cloud);
  const double first_stamp_s = runOver(*drive, static_cast<std::size_t>(last - options.scans.first), points, poses,
                                       options.redundant_at_s, pipeline, results);
  for (const std::string& warning : results.warnings()) warn(warning);
  for (const std::string& warning : poses.warnings()) warn(warning);
  if (const std::string contradiction = pipeline.seamContradiction(); !contradiction.empty()) warn(contradiction);
  if (!kitti_stamps && !results.stampFault().empty()) warn(results.stampFault());

  results.write();
  Json summary = results.summary({options.scans.first, drive->size(), skipped_stamp_s.value_or(first_stamp_s)});
  summary["max_rss_mb"] = maxRssMb();
  summary["vertical_reference"] = levelSummary(pipeline.verticalReference().report());
  summary["sweep_clock"] = clockSummary(pipeline.sweepClock());
  summary["threads"] = options.threads;
  summary["profile"] = options.files.profile;
  setAsideFaultsOfAnEarlierRun(options.output);
  summary = folder.finish(std::move(summary));
  std::cout << summary.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
  if (results.withoutAnyPose()) {
    return reportError(kName, "no scan of " + drive_name + " could be used" + points.whyUnusable(), kExitFailed);
  }
  reportVerdict(kName, results.verdict(), callOf("report") + " " + options.output);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Runs the odometry over a recorded drive. Writes trajectory_kitti.txt (lidar frame, first pose identity), "
        "trajectory_tum.txt (base_link), per_sweep.csv, monitor_log.csv and measurements.csv (for "
        "evaluate_fail_aware), summary.json, "
        "parameters.yaml.\n"
        "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    addOptions(app, options);
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
