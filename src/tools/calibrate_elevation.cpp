// Puts together what drives tell of the beams' elevation: yaml on stdout or in a file.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"
#include "evaluation/elevation_calibration.hpp"
#include "result_files.hpp"
#include "run_folder.hpp"
#include "run_parameters.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;
namespace fs = std::filesystem;

constexpr const char* kName = "calibrate_elevation";
constexpr double kUsefulSigma_deg = 0.1;

struct Options {
  std::vector<std::string> runs;
  std::string output;
};

/// Nothing if the run did not find the elevation.
std::optional<ElevationEstimate> estimateOf(const fs::path& run) {
  const Json summary = readRunSummary(run);
  const VerticalAngleCorrectionParams began_with = sensorOfRun(run).vertical_angle;
  const Json found = summary.value("vertical_reference", Json());
  if (!found.is_object() || found.value("looks", 0) == 0 || !found.contains("elevation_deg") ||
      !found.contains("elevation_sigma_deg")) {
    throw InputError(run.string() +
                     ": it does not tell the beams' elevation: run offline_odometry again, with "
                     "vertical_reference.enabled true, on a drive with some way");
  }
  const ElevationEstimate posterior{found.at("elevation_deg").get<double>(),
                                    found.at("elevation_sigma_deg").get<double>()};
  std::optional<ElevationEstimate> own = withoutPrior(posterior, began_with.sigma_deg);
  if (own) own->angle_deg += began_with.angle_deg;
  return own;
}

double rounded(double value_deg) { return std::round(1e3 * value_deg) / 1e3 + 0.0; }

int run(const Options& options) {
  std::vector<ElevationEstimate> drives;
  for (const fs::path folder : options.runs) {
    char text[120] = "warning: hardly better known than its sigma_deg says; this run is left out";
    if (const std::optional<ElevationEstimate> drive = estimateOf(folder)) {
      drives.push_back(*drive);
      std::snprintf(text, sizeof(text), "%+.3f deg, +- %.3f deg", drive->angle_deg, drive->sigma_deg);
    }
    std::cerr << kName << ": " << folder.string() << ": " << text << std::endl;
  }
  const ElevationEstimate mean = meanElevation(drives);
  if (std::abs(mean.angle_deg) > VerticalAngleCorrectionParams::kMax_deg) {
    throw InputError("that is more than sensor.vertical_angle.angle_deg takes (" +
                     std::to_string(std::lround(VerticalAngleCorrectionParams::kMax_deg)) + " deg)");
  }
  char text[160];
  std::snprintf(
      text, sizeof(text),
      "together: %+.3f deg, +- %.3f deg; to the +- of each run %g deg are added, by which the scenery changes it",
      mean.angle_deg, mean.sigma_deg, kScenerySigma_deg);
  std::cerr << kName << ": " << text << std::endl;
  if (mean.sigma_deg > kUsefulSigma_deg) {
    std::cerr << kName << ": warning: that is not known to " << kUsefulSigma_deg
              << " deg; give more drives, or longer ones, between houses" << std::endl;
  }
  printAndKeep(formatYaml({{"sensor.vertical_angle.angle_deg", rounded(mean.angle_deg)},
                           {"sensor.vertical_angle.sigma_deg", std::max(0.001, rounded(mean.sigma_deg))}}),
               options.output);
  std::cerr << kName << ": next: offline_odometry --parameters "
            << (options.output.empty() ? "FILE (--output FILE keeps it)" : options.output)
            << "; on the vehicle: the same two numbers in the sensor file" << std::endl;
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Finds sensor.vertical_angle.angle_deg and sigma_deg from runs of offline_odometry, without ground truth: the "
        "error that the elevations of all beams have in common, as the vertical reference found it at the end of each "
        "run. A drive that begins with it does not drift in pitch and height while it finds it anew. Use drives of "
        "some hundred metres, between houses, walls or trunks.\n"
        "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    app.add_option("--run", options.runs, "folder that offline_odometry wrote; may be repeated: one lidar")->required();
    app.add_option("--output", options.output, "yaml file with the two numbers, for --parameters");
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
