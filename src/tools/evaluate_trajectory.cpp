// Compares an estimated trajectory with the true one: JSON on stdout; with --output also files.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/io/trajectory_io.hpp"
#include "evaluation/absolute_trajectory_error.hpp"
#include "evaluation/drift_by_axis.hpp"
#include "evaluation/kitti_metric.hpp"
#include "evaluation/relative_step_error.hpp"
#include "evaluation/time_to_failure.hpp"
#include "evaluation/trajectory_pair.hpp"
#include "json.hpp"
#include "result_files.hpp"
#include "run_folder.hpp"
#include "tool_support.hpp"

namespace fail_aware {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "evaluate_trajectory";

struct Options {
  std::string ground_truth, estimate, calib, times, output;
  std::vector<double> lengths_m;
  std::optional<int> step;
  double period_s = 0.1;
  FailureEpisode::Params episodes;
};

struct Trajectories {
  std::vector<Pose> truth, estimate;  // lidar frame, pose by pose
  std::vector<double> stamps_s;
};

void declareOptions(CLI::App& app, Options& options) {
  app.add_option("--ground-truth", options.ground_truth, "true poses, KITTI rows (12 numbers)")->required();
  app.add_option(
         "--estimate", options.estimate,
         "estimated poses, KITTI rows, lidar frame: one per true pose; or trajectory_kitti.txt in the folder of a "
         "run of offline_odometry, which says which scans they are")
      ->required();
  app.add_option("--calib", options.calib,
                 "KITTI calib.txt: the ground truth is in the camera frame; its line 'Tr:' converts it to the lidar's");
  app.add_option("--output", options.output,
                 "folder for evaluation.json and trajectory.csv; plot_trajectory draws them");
  app.add_option("--lengths", options.lengths_m,
                 "segment lengths of the KITTI metric in m, comma-separated (default 100,200,...,800; "
                 "5,10,20,40,80 and step 1 if no segment of 100 m fits)")
      ->delimiter(',')
      ->check(positiveNumber());
  app.add_option("--step", options.step, "segments begin at every n-th pose (default 10)")
      ->transform(wholeNumber(1, std::numeric_limits<int>::max()));
  app.add_option("--alert-limit", options.episodes.alert_limit_m, "horizontal error that counts as a failure, m")
      ->check(positiveNumber())
      ->capture_default_str();
  app.add_option("--episode-every", options.episodes.episode_every_s, "time between the starts of episodes, s")
      ->check(positiveNumber())
      ->capture_default_str();
  auto* times = app.add_option("--times", options.times, "stamps of the poses, one a row, s");
  app.add_option("--period", options.period_s, "time between poses if --times is not given, s")
      ->check(positiveNumber())
      ->capture_default_str()
      ->excludes(times);
}

/// If the estimate is the trajectory of a run: the rows of the ground truth that belong to its poses. Otherwise none:
/// the trajectories match row by row.
std::optional<std::vector<std::size_t>> truthRowsOfRun(const Options& options, std::size_t truth_rows) {
  const fs::path estimate = options.estimate, folder = estimate.parent_path();
  std::error_code error;
  if (estimate.filename() != "trajectory_kitti.txt" || !fs::exists(folder / "per_sweep.csv", error))
    return std::nullopt;
  const RunRows rows = runRows(readRunSummary(folder), folder / "summary.json");
  const std::size_t first = firstTruthRow(rows, truth_rows, options.ground_truth, options.estimate);
  std::vector<std::size_t> truth_of_row;
  for (const std::size_t scan : rows.accepted) truth_of_row.push_back(first + scan);
  return truth_of_row;
}

template <class Value>
std::vector<Value> chosen(const std::vector<Value>& values, const std::vector<std::size_t>& rows) {
  std::vector<Value> some;
  some.reserve(rows.size());
  for (const std::size_t row : rows) some.push_back(values[row]);
  return some;
}

Trajectories load(const Options& options) {
  Trajectories in;
  in.truth = readKittiTrajectory(options.ground_truth);
  in.estimate = readKittiTrajectory(options.estimate);
  if (!options.calib.empty()) in.truth = lidarFromCameraTrajectory(in.truth, readLidarToCamera(options.calib));
  const std::size_t all = in.truth.size();
  const std::optional<std::vector<std::size_t>> rows = truthRowsOfRun(options, all);
  if (rows) in.truth = chosen(in.truth, *rows);
  requirePosePairs(in.truth, in.estimate);
  if (movesLikeACamera(in.truth) && !movesLikeACamera(in.estimate)) {
    std::cerr << kName << ": warning: " << options.ground_truth << " " << kMovesLikeACamera
              << ": give --calib calib.txt" << std::endl;
  }
  if (!options.times.empty()) {
    in.stamps_s = readTimes(options.times);
  } else {
    for (std::size_t i = 0; i < all; ++i) in.stamps_s.push_back(static_cast<double>(i) * options.period_s);
  }
  if (rows && in.stamps_s.size() == all) in.stamps_s = chosen(in.stamps_s, *rows);
  return in;
}

/// The metric for the requested lengths. Without a request, and if no usual length fits: the metric for short runs.
std::pair<KittiMetric, KittiMetric::Params> kittiMetricFor(const Trajectories& in, const Options& options) {
  KittiMetric::Params params;
  if (!options.lengths_m.empty()) params.lengths_m = options.lengths_m;
  if (options.step) params.step = *options.step;
  KittiMetric metric = kittiMetric(in.truth, in.estimate, params);
  if (metric.total.segments == 0 && options.lengths_m.empty()) {
    params = KittiMetric::Params::forShortRuns();
    if (options.step) params.step = *options.step;
    metric = kittiMetric(in.truth, in.estimate, params);
  }
  return {metric, params};
}

void addAverage(Json& json, const KittiMetric::Average& average) {
  json["segments"] = average.segments;
  json["t_err_percent"] = average.segments > 0 ? Json(average.t_err_percent) : Json(nullptr);
  json["r_err_deg_per_m"] = average.segments > 0 ? Json(average.r_err_deg_per_m) : Json(nullptr);
}

Json perLengthJson(const KittiMetric& metric, const std::vector<DriftByAxis>& drift) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < metric.per_length.size(); ++i) {
    Json row = {{"length_m", metric.per_length[i].length_m}};
    addAverage(row, metric.per_length[i]);
    for (const auto& [name, value] : {std::pair("along_percent", drift[i].along_percent),
                                      {"across_percent", drift[i].across_percent},
                                      {"up_percent", drift[i].up_percent},
                                      {"roll_deg_per_m", drift[i].roll_deg_per_m},
                                      {"pitch_deg_per_m", drift[i].pitch_deg_per_m},
                                      {"yaw_deg_per_m", drift[i].yaw_deg_per_m}}) {
      row[name] = drift[i].segments > 0 ? Json(value) : Json(nullptr);
    }
    rows.push_back(row);
  }
  return rows;
}

void addAbsoluteError(Json& json, const std::string& prefix, const AbsoluteTrajectoryError& error) {
  json[prefix + "_rmse_m"] = error.rmse_m;
  json[prefix + "_mean_m"] = error.mean_m;
  json[prefix + "_max_m"] = error.max_m;
  json[prefix + "_yaw_rmse_deg"] = error.yaw_rmse_rad / kDegree;
}

/// Sum of the signed turns, left positive: two rounds of a block are 720.
double headingChange(const std::vector<Pose>& poses) {
  double heading_rad = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    heading_rad += rpyFromRotation(poses[i - 1].linear().transpose() * poses[i].linear()).z();
  }
  return heading_rad / kDegree;
}

Json episodesJson(const Trajectories& in, const FailureEpisode::Params& params) {
  const std::vector<FailureEpisode> episodes = failureEpisodes(in.truth, in.estimate, in.stamps_s, params);
  std::size_t failed = 0;
  Json list = Json::array();
  for (const FailureEpisode& episode : episodes) {
    failed += episode.failed ? 1 : 0;
    list.push_back({{"pose", episode.begin},
                    {"begin_s", episode.begin_s},
                    {"failed", episode.failed},
                    {"time_s", episode.time_s}});
  }
  const std::optional<double> median_s = medianTimeToFailure(episodes);
  return {{"alert_limit_m", params.alert_limit_m},
          {"every_s", params.episode_every_s},
          {"total", episodes.size()},
          {"failed", failed},
          {"median_time_to_failure_s", median_s ? Json(*median_s) : Json(nullptr)},
          {"list", list}};
}

Json evaluate(const Trajectories& in, const Options& options, const AbsoluteTrajectoryError& ate,
              const AbsoluteTrajectoryError& ate_aligned) {
  const auto [metric, params] = kittiMetricFor(in, options);
  const RelativeStepError step_error = relativeStepError(in.truth, in.estimate);
  Json json;
  json["poses"] = in.truth.size();
  json["path_length_m"] = distancesAlong(in.truth).back();
  json["estimate_path_length_m"] = distancesAlong(in.estimate).back();
  json["heading_change_deg"] = headingChange(in.truth);
  json["estimate_heading_change_deg"] = headingChange(in.estimate);
  addAverage(json, metric.total);
  json["lengths_m"] = params.lengths_m;
  json["step"] = params.step;
  json["per_length"] = perLengthJson(metric, driftByAxis(in.truth, in.estimate, params));
  addAbsoluteError(json, "ate", ate);
  addAbsoluteError(json, "ate_aligned", ate_aligned);
  json["step_translation_rmse_m"] = step_error.translation_rmse_m;
  json["step_rotation_rmse_deg"] = step_error.rotation_rmse_rad / kDegree;
  json["episodes"] = episodesJson(in, options.episodes);
  return json;
}

/// Positions in the frame of the first pose; the two trajectories coincide there.
void writeCsv(const fs::path& path, const Trajectories& in, const AbsoluteTrajectoryError& ate,
              const AbsoluteTrajectoryError& ate_aligned) {
  std::ofstream file = createFile(path);
  file << "time_s,distance_m,truth_x_m,truth_y_m,truth_z_m,estimate_x_m,estimate_y_m,estimate_z_m,error_m,"
          "error_aligned_m\n";
  const std::vector<double> distances_m = distancesAlong(in.truth);
  const Pose T_start_truth = in.truth.front().inverse();
  const Pose T_start_estimate = in.estimate.front().inverse();
  for (std::size_t i = 0; i < in.truth.size(); ++i) {
    file << std::setprecision(17) << in.stamps_s[i] << std::setprecision(10) << ',' << distances_m[i];
    const Eigen::Vector3d truth = T_start_truth * in.truth[i].translation();
    const Eigen::Vector3d estimate = T_start_estimate * in.estimate[i].translation();
    for (const double value : {truth.x(), truth.y(), truth.z(), estimate.x(), estimate.y(), estimate.z(),
                               ate.position_error_m[i], ate_aligned.position_error_m[i]}) {
      file << ',' << value;
    }
    file << '\n';
  }
  finishFile(file, path);
}

std::string verdict(const Json& json) {
  char text[160];
  const double length_m = json["path_length_m"];
  if (json["segments"] == 0) {
    std::snprintf(text, sizeof(text), "%.1f m are too short for the shortest segment: no error in %%", length_m);
  } else {
    std::snprintf(text, sizeof(text), "off by %.2f %% and %.4f deg/m over %.0f m", json["t_err_percent"].get<double>(),
                  json["r_err_deg_per_m"].get<double>(), length_m);
  }
  const Json& episodes = json["episodes"];
  return text + std::string("; ") + std::to_string(episodes["failed"].get<std::size_t>()) + " of " +
         std::to_string(episodes["total"].get<std::size_t>()) + " episodes pass the alert limit";
}

int run(int argc, char** argv) {
  CLI::App app(
      "Compares an estimated trajectory with the true one: KITTI metric, absolute error, starts whose error passes the "
      "alert limit.\n"
      "Exit codes: 0 done, 1 the work failed, 2 bad usage or input.",
      kName);
  Options options;
  declareOptions(app, options);
  if (!parseArguments(app, argc, argv)) return kExitDone;

  const fs::path folder = options.output;
  if (!folder.empty()) makeResultFolder(folder);
  const Trajectories in = load(options);
  if (const std::string fault = extentFault(in.truth, in.estimate); !fault.empty()) {
    std::cerr << kName << ": warning: " << fault << std::endl;
  }
  const AbsoluteTrajectoryError ate =
      absoluteTrajectoryError(in.truth, in.estimate, firstPoseAlignment(in.truth, in.estimate));
  const AbsoluteTrajectoryError ate_aligned =
      absoluteTrajectoryError(in.truth, in.estimate, bestAlignment(in.truth, in.estimate));
  const Json json = evaluate(in, options, ate, ate_aligned);

  std::cout << json.dump(2) << std::endl;
  if (!std::cout) throw std::runtime_error("stdout: could not be written");
  if (!folder.empty()) {
    writeText(folder / "evaluation.json", json.dump(2) + '\n');
    writeCsv(folder / "trajectory.csv", in, ate, ate_aligned);
  }
  reportVerdict(kName, verdict(json),
                folder.empty() ? "the same with --output DIR, for plot_trajectory"
                               : callOf("plot_trajectory") + " " + options.output);
  return kExitDone;
}

}  // namespace
}  // namespace fail_aware

int main(int argc, char** argv) {
  return fail_aware::runTool("evaluate_trajectory", [&] { return fail_aware::run(argc, argv); });
}
