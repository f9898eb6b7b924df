// Time of each kernel on one made-up sweep of full size (64 x 1900 rays in the synthetic street), one thread.
#include <benchmark/benchmark.h>

#include <vector>

#include "../support/synthetic_street.hpp"
#include "core/estimation/measurement_fusion.hpp"
#include "core/estimation/ukf.hpp"
#include "core/map/voxel_map.hpp"
#include "core/odometry_pipeline.hpp"
#include "core/preprocessing/registration_cloud.hpp"
#include "core/preprocessing/sweep_corrector.hpp"
#include "core/preprocessing/voxel_filter.hpp"
#include "core/registration/corner_svd/corner_extraction.hpp"
#include "core/registration/icp_point_to_plane.hpp"
#include "core/registration/icp_point_to_point.hpp"

namespace fail_aware::kernel_benchmark {
namespace {

constexpr int kSweepsInMap = 10;
constexpr double kPeriod_s = 0.1;

/// The tenth sweep of a drive and the map of the nine before it, all placed by truth.
struct Scene {
  Scene() {
    synthetic::Lidar lidar;
    lidar.columns = 1900;
    T_cog_lidar = lidar.T_base_lidar;
    const synthetic::Street street;
    const synthetic::Drive drive;
    RegistrationCloudBuilder builder{RegistrationCloudBuilder::Params()};
    SweepCorrector corrector({}, {}, timing(), {}, {});
    for (int i = 0; i < kSweepsInMap; ++i) {
      const double stamp_s = kPeriod_s * i;
      sweep =
          street.scan([&](double t) { return drive.T_street_base(t); }, stamp_s, static_cast<std::uint32_t>(i), lidar);
      prediction.stamp_s = stamp_s;
      prediction.dt_s = kPeriod_s;
      prediction.T_odom_cog_previous = drive.T_odom_base(stamp_s - kPeriod_s);
      prediction.T_odom_cog = drive.T_odom_base(stamp_s);
      prediction.motion_status = MotionStatus::kObserved;
      corrector.correct(sweep, prediction, T_cog_lidar, corrected);
      builder.build(corrected, T_cog_lidar, cloud);
      if (i + 1 < kSweepsInMap) map.insert(cloud.map_points_cog, prediction.T_odom_cog);
    }
    Vector6d offset = Vector6d::Zero();
    offset << 0.05, 0.03, 0.01, 0.0, 0.002, 0.003;
    T_odom_cog_guess = prediction.T_odom_cog * poseFromVector(offset);
    covariance.diagonal() << 0.0025, 0.0025, 0.0025, 1e-4, 1e-4, 1e-4;
  }

  static SweepTimingParams timing() {
    SweepTimingParams params;
    params.stamp_reference = "mid";
    return params;
  }

  Sweep sweep;
  SweepPrediction prediction;
  CorrectedSweep corrected;
  RegistrationCloud cloud;
  VoxelMap map;
  Pose T_cog_lidar;
  Pose T_odom_cog_guess;
  Matrix6d covariance = Matrix6d::Zero();
};

const Scene& scene() {
  static const Scene scene;
  return scene;
}

void sweepCorrection(benchmark::State& state) {
  SweepCorrector corrector({}, {}, Scene::timing(), {}, {});
  CorrectedSweep corrected;
  Sweep sweep = scene().sweep;
  for (auto _ : state) corrector.correct(sweep, scene().prediction, scene().T_cog_lidar, corrected);
}
BENCHMARK(sweepCorrection)->Unit(benchmark::kMillisecond);

void voxelFilter(benchmark::State& state) {
  VoxelFilter filter;
  for (auto _ : state) benchmark::DoNotOptimize(filter.select(scene().corrected.points_lidar, 0.3, 3.0, 100.0).size());
}
BENCHMARK(voxelFilter)->Unit(benchmark::kMillisecond);

void registrationCloud(benchmark::State& state) {
  RegistrationCloudBuilder builder{RegistrationCloudBuilder::Params()};
  RegistrationCloud cloud;
  for (auto _ : state) builder.build(scene().corrected, scene().T_cog_lidar, cloud);
}
BENCHMARK(registrationCloud)->Unit(benchmark::kMillisecond);

void voxelMapInsert(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    VoxelMap map = scene().map;
    map.reserve(2 * map.size());  // a copy has no room left
    state.ResumeTiming();
    map.insert(scene().cloud.map_points_cog, scene().prediction.T_odom_cog);
  }
}
BENCHMARK(voxelMapInsert)->Unit(benchmark::kMillisecond);

void findNearest(benchmark::State& state) {
  std::size_t i = 0;
  VoxelMap::PointMatch match;
  const std::vector<Eigen::Vector3f>& points = scene().cloud.point_points_cog;
  for (auto _ : state) {
    const Eigen::Vector3d query = scene().T_odom_cog_guess * points[i].cast<double>();
    benchmark::DoNotOptimize(scene().map.findNearest(query, 0.5, match));
    i = (i + 1) % points.size();
  }
}
BENCHMARK(findNearest);

void findPlane(benchmark::State& state) {
  std::size_t i = 0;
  VoxelMap::PlaneMatch match;
  const std::vector<Eigen::Vector3f>& points = scene().cloud.plane_points_cog;
  for (auto _ : state) {
    const Eigen::Vector3d query = scene().T_odom_cog_guess * points[i].cast<double>();
    VoxelMap::Neighborhood neighborhood;
    benchmark::DoNotOptimize(scene().map.findPlane(query, match, neighborhood));
    i = (i + 1) % points.size();
  }
}
BENCHMARK(findPlane);

void multiplexIcp(benchmark::State& state) {
  IcpPointToPoint::Params params;
  params.seeds = static_cast<int>(state.range(0));
  const IcpPointToPoint icp(params);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        icp.align(scene().cloud.point_points_cog, scene().map, scene().T_odom_cog_guess, scene().covariance));
  }
}
BENCHMARK(multiplexIcp)->Arg(1)->Arg(8)->ArgName("seeds")->Unit(benchmark::kMillisecond);

void normalFilteredIcp(benchmark::State& state) {
  const IcpPointToPlane icp{IcpPointToPlane::Params()};
  for (auto _ : state) {
    benchmark::DoNotOptimize(icp.align(scene().cloud.plane_points_cog, scene().map, scene().T_odom_cog_guess, 0.004));
  }
}
BENCHMARK(normalFilteredIcp)->Unit(benchmark::kMillisecond);

void cornerExtraction(benchmark::State& state) {
  CornerExtractor extractor{CornerExtractor::Params()};
  for (auto _ : state) {
    benchmark::DoNotOptimize(extractor.extract(scene().corrected.points_lidar, Eigen::Matrix3d::Identity()).size());
  }
}
BENCHMARK(cornerExtraction)->Unit(benchmark::kMillisecond);

void ukfStep(benchmark::State& state) {
  Ukf ukf;
  ukf.reset(Vector6d::Zero(), scene().covariance);
  for (auto _ : state) {
    ukf.predict([](const Vector6d& x) { return x; }, scene().covariance);
    ukf.correct(Vector6d::Zero(), scene().covariance);
  }
}
BENCHMARK(ukfStep)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fail_aware::kernel_benchmark

BENCHMARK_MAIN();
