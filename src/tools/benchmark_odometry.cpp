// benchmark_odometry: time per sweep of the whole odometry compared with scan-to-scan pcl::IterativeClosestPoint on the
// same sweeps in the same run. Times differ between machines and from hour to hour; the ratio stays.
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

#include "core/io/kitti_directory.hpp"
#include "core/io/profile_files.hpp"
#include "core/odometry_pipeline.hpp"
#include "evaluation/quantile.hpp"
#include "json.hpp"
#include "result_files.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;
using Clock = std::chrono::steady_clock;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr const char* kName = "benchmark_odometry";

struct Options {
  std::string kitti, json;
  ProfileFiles files;
  std::vector<std::string> set;
  int threads = 2;
  ScanRange scans;
  bool without_pcl = false;
};

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double residentMb() {
  std::ifstream statm("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

/// Registers each sweep against the previous one; the initial guess is the last motion.
class PclScanToScan {
 public:
  PclScanToScan() {
    icp_.setMaxCorrespondenceDistance(1.0);
    icp_.setMaximumIterations(50);
    icp_.setTransformationEpsilon(1e-6);
    grid_.setLeafSize(0.25F, 0.25F, 0.25F);
  }

  void step(const Sweep& sweep) {
    PclCloud::Ptr all(new PclCloud);
    all->reserve(sweep.points_lidar.size());
    for (const Eigen::Vector3f& point : sweep.points_lidar) all->emplace_back(point.x(), point.y(), point.z());
    PclCloud::Ptr thinned(new PclCloud);
    grid_.setInputCloud(all);
    grid_.filter(*thinned);
    if (previous_ && !thinned->empty() && !previous_->empty()) {
      icp_.setInputSource(thinned);
      icp_.setInputTarget(previous_);
      PclCloud aligned;
      icp_.align(aligned, motion_);
      if (icp_.hasConverged()) motion_ = icp_.getFinalTransformation();
    }
    previous_ = thinned;
  }

 private:
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp_;
  pcl::VoxelGrid<pcl::PointXYZ> grid_;
  PclCloud::Ptr previous_;
  Eigen::Matrix4f motion_ = Eigen::Matrix4f::Identity();
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Json statistics(const std::vector<double>& ms) {
  return {{"mean_ms", mean(ms)},
          {"median_ms", quantile(ms, 0.5)},
          {"p95_ms", quantile(ms, 0.95)},
          {"p99_ms", quantile(ms, 0.99)},
          {"p99_over_mean", quantile(ms, 0.99) / mean(ms)}};
}

void print(const char* title, const Json& s) {
  std::printf("%-44s mean %7.2f ms  median %7.2f  p95 %7.2f  p99 %7.2f  p99/mean %.2f\n", title,
              s["mean_ms"].get<double>(), s["median_ms"].get<double>(), s["p95_ms"].get<double>(),
              s["p99_ms"].get<double>(), s["p99_over_mean"].get<double>());
}

int run(const Options& options) {
  const KittiDirectory directory = KittiDirectory::open(options.kitti);
  const long last = options.scans.end(directory.size(), options.kitti);
  PipelineParameters params = loadPipelineParameters(options.files);
  params.sensor.timing.useKittiStamps();
  overrideParameters(params, {}, options.set);
  std::ofstream json;
  if (!options.json.empty()) json = createFile(options.json);  // the run takes minutes

  OdometryPipeline pipeline(params, options.threads);
  pipeline.startRedundant();
  PclScanToScan pcl_icp;
  std::vector<double> odometry_ms, pcl_ms, resident_mb;
  Sweep sweep;
  {
    ProgressBar progress(static_cast<std::size_t>(last - options.scans.first));
    for (long i = options.scans.first; i < last; ++i) {
      directory.read(static_cast<std::size_t>(i), sweep);
      if (!options.without_pcl) {
        const Clock::time_point begin = Clock::now();
        pcl_icp.step(sweep);
        pcl_ms.push_back(millisecondsSince(begin));
      }
      const Clock::time_point begin = Clock::now();
      pipeline.step(sweep);
      odometry_ms.push_back(millisecondsSince(begin));
      resident_mb.push_back(residentMb());
      progress.update(static_cast<std::size_t>(i - options.scans.first + 1));
    }
  }

  Json result;
  result["sequence"] = options.kitti;
  result["sweeps"] = odometry_ms.size();
  result["threads"] = options.threads;
  result["odometry"] = statistics(odometry_ms);
  std::printf("%zu sweeps, %d threads\n", odometry_ms.size(), options.threads);
  print("odometry, all stages", result["odometry"]);
  if (!pcl_ms.empty()) {
    result["pcl_icp"] = statistics(pcl_ms);
    result["ratio_of_means"] = mean(odometry_ms) / mean(pcl_ms);
    print("pcl::IterativeClosestPoint, scan to scan", result["pcl_icp"]);
    std::printf("ratio of the means %.3f\n", result["ratio_of_means"].get<double>());
  }
  constexpr std::size_t kParts = 4;
  for (std::size_t k = 0; k < kParts && odometry_ms.size() >= kParts; ++k) {
    const std::size_t begin = k * odometry_ms.size() / kParts, end = (k + 1) * odometry_ms.size() / kParts;
    const std::vector<double> part(odometry_ms.begin() + static_cast<std::ptrdiff_t>(begin),
                                   odometry_ms.begin() + static_cast<std::ptrdiff_t>(end));
    result["quarters"].push_back({{"mean_ms", mean(part)}, {"resident_mb", resident_mb[end - 1]}});
    std::printf("quarter %zu: mean %.2f ms, %.0f MB resident at its end\n", k + 1, mean(part), resident_mb[end - 1]);
  }
  if (!options.json.empty()) {
    json << result.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
    finishFile(json, options.json);
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    CLI::App app(
        "Times the odometry (all stages, reading of files left out) and pcl::IterativeClosestPoint, scan to scan "
        "(VoxelGrid leaf 0.25 m, correspondences up to 1.0 m, 50 iterations, epsilon 1e-6, constant-velocity "
        "guess), on the same sweeps by turns.\nExit codes: 0 done, 1 the work failed, 2 bad usage or input.",
        kName);
    Options options;
    app.add_option("--kitti", options.kitti, "folder with velodyne/NNNNNN.bin")->required();
    app.add_option("--profile", options.files.profile, "default, paper, or a yaml file")->capture_default_str();
    app.add_option("--vehicle", options.files.vehicle, "a file of cfg/vehicles, or a yaml file")->capture_default_str();
    app.add_option("--sensor", options.files.sensor, "a file of cfg/sensors, or a yaml file")->capture_default_str();
    app.add_option("--cfg", options.files.cfg, "the package's cfg folder (default: found from the tool's own place)");
    app.add_option("--set", options.set, "key=value, overrides one parameter; may be repeated")->take_all();
    app.add_option("--threads", options.threads, "of the odometry")
        ->transform(wholeNumber(1, 256))
        ->capture_default_str();
    options.scans.addOptions(app);
    app.add_flag("--without-pcl", options.without_pcl, "the odometry alone");
    app.add_option("--json", options.json, "file for the figures");
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
