// simulate_drive: a simulated drive with a spinning lidar, as a KITTI folder or a bag, with truth and optional faults.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/io/kitti_writer.hpp"
#include "core/io/output_file.hpp"
#include "json.hpp"
#include "simulation/fault_injector.hpp"
#include "simulation/lidar_head.hpp"
#include "simulation/sweep_stamping.hpp"
#include "simulation_options.hpp"
#include "tool_support.hpp"
#ifdef FAIL_AWARE_WITH_BAGS
#include "bridge/velodyne_bag_writer.hpp"
#endif

namespace {

using namespace fail_aware;
namespace fs = std::filesystem;

constexpr const char* kName = "simulate_drive";

struct Options {
  std::string output;
  std::vector<std::string> faults;
  bool no_rolling_shutter = false, no_traffic = false;
  int threads = 1;
  int rate_hz = 10;
  double beam_errors = 1.0;
  DriveSimulation::Params simulation;
};

void addOptions(CLI::App& app, Options& options) {
  DriveSimulation::Params& simulation = options.simulation;
  app.add_option("--output", options.output, "FILE.bag, or a folder for KITTI's layout (new or empty)")->required();
  app.add_option("--scene", simulation.scene,
                 "town, country, highway, tunnel or open; or one after the other, with lengths in m: town:250,tunnel")
      ->capture_default_str();
  app.add_option("--duration", simulation.duration_s, "s")->check(realNumber(0.1, 1e6))->capture_default_str();
  app.add_option("--seed", simulation.seed, "random seed of the world and the drive")
      ->transform(wholeNumber(0, std::numeric_limits<int>::max()))
      ->capture_default_str();
  app.add_option("--fault", options.faults, "KIND[:START[:DURATION[:SEVERITY]]], s; may be repeated; kinds: below")
      ->take_all();
  app.add_option("--speed", simulation.drive.speed.speed_mps, "speed limit in m/s (0: the scene's own)")
      ->check(realNumber(0.0, 60.0))
      ->capture_default_str();
  app.add_option("--start-speed", simulation.drive.start_speed_mps,
                 "m/s (-1: chosen by the scene; standstill in town, else 0.7 of the limit)")
      ->check(realNumber(-1.0, 60.0))
      ->capture_default_str();
  app.add_flag("--no-rolling-shutter", options.no_rolling_shutter,
               "all points from the sweep's middle (and no point times)");
  app.add_option("--head", simulation.lidar.head, "the lidar")
      ->check(CLI::IsMember(lidarHeadNames()))
      ->capture_default_str();
  app.add_option("--rate", options.rate_hz, "revolutions a second: 5, 10 or 20")
      ->check(CLI::IsMember({5, 10, 20}))
      ->capture_default_str();
  app.add_flag("--no-traffic", options.no_traffic, "no other vehicles");
  app.add_option("--beam-errors", options.beam_errors,
                 "factor on the errors of range and elevation that the beams of a head have")
      ->check(realNumber(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "for the ray casting; does not change the result")
      ->transform(wholeNumber(1, 256))
      ->capture_default_str();
}

class Output {
 public:
  virtual ~Output() = default;
  virtual void add(const SimulatedSweep& sweep) = 0;
  virtual void finish() = 0;
};

class KittiOutput : public Output {
 public:
  explicit KittiOutput(const std::string& directory) : writer_(directory) {}
  void add(const SimulatedSweep& sweep) override {
    writer_.add(kittiSweep(sweep), sweep.T_world_lidar, sweep.T_world_base, sweep.middle_s());
  }
  void finish() override { writer_.finish(); }

 private:
  KittiWriter writer_;
};

#ifdef FAIL_AWARE_WITH_BAGS
class BagOutput : public Output {
 public:
  BagOutput(const std::string& path, const Pose& T_base_lidar) : writer_(path, T_base_lidar) {}
  void add(const SimulatedSweep& sweep) override {
    writer_.add(driverSweep(sweep), sweep.T_world_base_end, sweep.begin_s + sweep.period_s);
  }
  void finish() override { writer_.close(); }

 private:
  VelodyneBagWriter writer_;
};
#endif

bool isBag(const std::string& output) { return fs::path(output).extension() == ".bag"; }

std::unique_ptr<Output> openOutput(const Options& options) {
  if (!isBag(options.output)) return std::make_unique<KittiOutput>(options.output);
#ifdef FAIL_AWARE_WITH_BAGS
  return std::make_unique<BagOutput>(options.output, options.simulation.T_base_lidar());
#else
  throw InputError(options.output + ": this build has no ROS and writes no bags; give a folder");
#endif
}

/// A file beside the bag, or in the KITTI folder.
std::string sideFile(const Options& options, const std::string& name) {
  if (!isBag(options.output)) return (fs::path(options.output) / name).string();
  return (fs::path(options.output).replace_extension("").string() + "_" + name);
}

void writeNotes(const Options& options, const std::vector<Fault>& faults, std::size_t sweeps) {
  std::ostringstream table;
  table << "kind,start_s,duration_s,severity\n";
  for (const Fault& fault : faults) {
    table << faultTraits(fault.kind).name << ',' << fault.start_s << ','
          << std::min(fault.duration_s, std::max(0.0, options.simulation.duration_s - fault.start_s)) << ','
          << fault.severity << '\n';
  }
  writeText(sideFile(options, "faults.csv"), table.str());
  Json notes;
  notes["scene"] = options.simulation.scene;
  notes["duration_s"] = options.simulation.duration_s;
  notes["seed"] = options.simulation.seed;
  notes["rolling_shutter"] = options.simulation.rolling_shutter;
  notes["traffic"] = options.simulation.traffic;
  notes["head"] = options.simulation.lidar.head;
  notes["rate_hz"] = options.rate_hz;
  notes["beam_errors"] = options.beam_errors;
  notes["speed_mps"] = options.simulation.drive.speed.speed_mps;
  notes["start_speed_mps"] = options.simulation.drive.start_speed_mps;
  notes["faults"] = options.faults;
  notes["lidar_in_base"] = options.simulation.lidar_in_base;
  notes["sweeps"] = sweeps;
  writeText(sideFile(options, "simulation.json"), notes.dump(2) + "\n");
}

/// The file of cfg/sensors for a head of lidar_head.hpp.
std::string sensorOf(const std::string& head) {
  if (head.rfind("os1", 0) == 0) return "ouster";
  if (head.rfind("pandar", 0) == 0) return "hesai";
  return head == "hdl64e" ? head : "velodyne";
}

/// How to run the odometry on the drive. Of the sensor files only hdl64e.yaml has the simulated lidar's place; a bag
/// has it in /tf_static.
std::string odometryCall(const Options& options) {
  const bool bag = isBag(options.output);
  std::ostringstream call;
  call << callOf("offline_odometry") << (bag ? " --bag " : " --kitti ") << options.output << " --output OUT";
  const std::string sensor = sensorOf(options.simulation.lidar.head);
  if (sensor != "hdl64e") {
    call << " --sensor " << sensor;
    const char* before = " --lidar-in-base ";
    for (const double value : options.simulation.lidar_in_base) {
      if (!bag) call << std::exchange(before, ",") << value;
    }
  }
  if (options.no_rolling_shutter) call << " --set sensor.timing.source=none";
  return call.str();
}

int run(Options& options) {
  options.simulation.rolling_shutter = !options.no_rolling_shutter;
  options.simulation.traffic = !options.no_traffic;
  LidarModel::Params& lidar = options.simulation.lidar;
  lidar.columns = static_cast<int>(std::lround(lidar.columns * 10.0 / options.rate_hz));  // as many pulses a second
  lidar.period_s = 1.0 / options.rate_hz;
  lidar.range_bias_m *= options.beam_errors;
  lidar.elevation_error_deg *= options.beam_errors;
  options.simulation.validate();
  const std::vector<Fault> faults = parseFaults(options.faults, options.simulation.duration_s);
  DriveSimulation simulation(options.simulation, options.threads);
  FaultInjector injector(static_cast<std::uint64_t>(options.simulation.seed), faults);
  const std::unique_ptr<Output> output = openOutput(options);
  std::size_t written = 0;
  const auto write = [&](const std::vector<SimulatedSweep>& arriving) {
    for (const SimulatedSweep& sweep : arriving) output->add(sweep);
    written += arriving.size();
  };
  {
    ProgressBar progress(simulation.sweeps());
    SimulatedSweep sweep;
    for (std::size_t i = 0; simulation.next(sweep, vehiclesAround(faults, simulation.time_s())); ++i) {
      write(injector.apply(std::move(sweep)));
      progress.update(i + 1);
    }
    write(injector.flush());
  }
  if (written == 0) return reportError(kName, "the faults leave no sweep", kExitUsage);
  output->finish();
  writeNotes(options, faults, written);
  std::ostringstream verdict;
  verdict << options.output << ": " << options.simulation.scene << ", " << options.simulation.duration_s << " s, "
          << written << " sweeps, faults: " << faults.size();
  reportVerdict(kName, verdict.str(), odometryCall(options));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Simulates a drive with a spinning lidar through a simulated world. The same arguments give the same bytes.\n"
        "KITTI folder: velodyne/, stamps/, rings/, times.txt (mid-sweep), poses.txt (truth, lidar frame), "
        "ground_truth_tum.txt (truth, base_link), calib.txt, faults.csv, simulation.json.\n"
        "Bag: /velodyne_points (stamp: the sweep's end), /tf_static, /ground_truth/odometry; beside it "
        "FILE_faults.csv, FILE_simulation.json.\n"
        "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    app.footer("Faults: effect; meaning of SEVERITY (default); default duration from START (10 s):\n" + faultHelp());
    Options options;
    addOptions(app, options);
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
