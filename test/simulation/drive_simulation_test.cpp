#include "simulation/drive_simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/io/profile_files.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware::drive_simulation_test {
namespace {

DriveSimulation::Params drive(const std::string& scene, double duration_s, int columns = 400) {
  DriveSimulation::Params params;
  params.scene = scene;
  params.duration_s = duration_s;
  params.seed = 3;
  params.drive.start_speed_mps = 12.0;
  params.lidar.columns = columns;
  return params;
}

DriveSimulation::Params perfectDrive(const std::string& scene, double duration_s, int columns) {
  DriveSimulation::Params params = drive(scene, duration_s, columns);
  params.traffic = false;
  params.lidar.range_noise_m = params.lidar.range_bias_m = params.lidar.elevation_error_deg = 0.0;
  return params;
}

std::vector<SimulatedSweep> simulate(const DriveSimulation::Params& params, int threads = 1) {
  DriveSimulation simulation(params, threads);
  std::vector<SimulatedSweep> sweeps(simulation.sweeps());
  for (SimulatedSweep& sweep : sweeps) EXPECT_TRUE(simulation.next(sweep));
  SimulatedSweep more;
  EXPECT_FALSE(simulation.next(more));
  return sweeps;
}

/// Points in the world; `corrected`: each by the pose of its own instant, with a constant twist over the sweep.
std::vector<Eigen::Vector3d> inWorld(const SimulatedSweep& sweep, const Pose& T_base_lidar, bool corrected) {
  const Vector6d half = logSe3(sweep.T_world_base.inverse() * sweep.T_world_base_end);  // of the sweep's motion
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < sweep.sweep.size(); ++i) {
    const double fraction = corrected ? static_cast<double>(sweep.sweep.times_s[i]) / sweep.period_s : 0.5;
    const Pose T = sweep.T_world_base * expSe3((2.0 * fraction - 1.0) * half) * T_base_lidar;
    points.push_back(T * sweep.sweep.points_lidar[i].cast<double>());
  }
  return points;
}

/// Median distance of b's points above the ground from the plane of a's three nearest, as far as these are near.
double medianGap(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  constexpr double kReach_m = 0.6;
  const auto cellOf = [](const Eigen::Vector3d& p, int dx, int dy, int dz) {
    const auto index = [&](int axis, int d) {
      return static_cast<std::int64_t>(std::floor(p[axis] / kReach_m)) + d + (1 << 19);
    };
    return (index(0, dx) << 42) | (index(1, dy) << 21) | index(2, dz);
  };
  std::unordered_map<std::int64_t, std::vector<Eigen::Vector3d>> cells;
  for (const Eigen::Vector3d& p : a) cells[cellOf(p, 0, 0, 0)].push_back(p);
  std::vector<double> gaps;
  for (std::size_t i = 0; i < b.size(); i += 11) {
    std::vector<std::pair<double, Eigen::Vector3d>> near;
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find(cellOf(b[i], n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
      if (found == cells.end()) continue;
      for (const Eigen::Vector3d& p : found->second) near.emplace_back((p - b[i]).norm(), p);
    }
    if (near.size() < 3) continue;
    std::partial_sort(near.begin(), near.begin() + 3, near.end(),
                      [](const auto& x, const auto& y) { return x.first < y.first; });
    const Eigen::Vector3d normal = (near[1].second - near[0].second).cross(near[2].second - near[0].second);
    if (near[2].first > kReach_m || normal.norm() < 1e-3) continue;
    gaps.push_back(std::abs(normal.normalized().dot(b[i] - near[0].second)));
  }
  EXPECT_GT(gaps.size(), 500u);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

TEST(DriveSimulation, BitsDependOnTheSeedOnly) {
  DriveSimulation::Params params = drive("town:20,tunnel", 1.0);
  const auto one = simulate(params, 1), three = simulate(params, 3);
  ASSERT_EQ(one.size(), 10u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].sweep.points_lidar, three[i].sweep.points_lidar);
    EXPECT_EQ(one[i].sweep.intensities, three[i].sweep.intensities);
    EXPECT_EQ(one[i].T_world_lidar.matrix(), three[i].T_world_lidar.matrix());
  }
  params.seed = 4;
  EXPECT_NE(simulate(params)[0].sweep.points_lidar, one[0].sweep.points_lidar);
}

TEST(DriveSimulation, TimesStampsAndAzimuthsAgree) {
  for (const SimulatedSweep& simulated : simulate(drive("country", 0.5))) {
    const Sweep& sweep = simulated.sweep;
    ASSERT_GT(sweep.size(), 10000u);
    ASSERT_EQ(sweep.times_s.size(), sweep.size());
    ASSERT_EQ(sweep.rings.size(), sweep.size());
    ASSERT_EQ(sweep.intensities.size(), sweep.size());
    EXPECT_DOUBLE_EQ(sweep.stamp_s, simulated.begin_s + 0.05);
    EXPECT_TRUE(std::is_sorted(sweep.times_s.begin(), sweep.times_s.end()));
    for (std::size_t i = 0; i < sweep.size(); i += 50) {
      const Eigen::Vector3f& p = sweep.points_lidar[i];
      ASSERT_TRUE(p.allFinite());
      ASSERT_LT(p.norm(), 121.0f);
      const double fraction = 0.5 * (1.0 - std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x())) / M_PI);
      EXPECT_NEAR(static_cast<double>(sweep.times_s[i]), 0.1 * fraction, 1e-6);
    }
  }
}

TEST(DriveSimulation, TruthFitsTheClouds) {
  // two sweeps 0.3 s apart, each point placed by the truth: they lie on the same surfaces, and 10 cm off they do not
  for (const char* scene : {"town", "country"}) {
    const DriveSimulation::Params params = perfectDrive(scene, 0.8, 1200);
    const Pose T_base_lidar = params.T_base_lidar();
    const auto sweeps = simulate(params);
    SimulatedSweep shifted = sweeps[7];
    for (Pose* T : {&shifted.T_world_base, &shifted.T_world_base_end}) T->pretranslate(Eigen::Vector3d(0.1, 0.1, 0.1));
    const auto first = inWorld(sweeps[4], T_base_lidar, true);
    const double gap = medianGap(first, inWorld(sweeps[7], T_base_lidar, true));
    EXPECT_LT(gap, 0.02) << scene;  // the surfaces' roughness
    EXPECT_GT(medianGap(first, inWorld(shifted, T_base_lidar, true)), 3.0 * gap) << scene;
  }
}

TEST(DriveSimulation, TheGroundIsAtBaseLinksHeight) {
  const DriveSimulation::Params params = perfectDrive("country", 1.0, 400);
  for (const SimulatedSweep& sweep : simulate(params)) {
    std::vector<double> heights_m;
    for (const Eigen::Vector3f& p : sweep.sweep.points_lidar) {
      const Eigen::Vector3d in_base = params.T_base_lidar() * p.cast<double>();
      const bool on_road = std::abs(in_base.y()) < 1.5 && std::abs(in_base.x()) > 3.0 && std::abs(in_base.x()) < 8.0;
      if (on_road) heights_m.push_back(in_base.z());
    }
    ASSERT_GT(heights_m.size(), 100u);
    const auto middle = heights_m.begin() + static_cast<std::ptrdiff_t>(heights_m.size() / 2);
    std::nth_element(heights_m.begin(), middle, heights_m.end());
    EXPECT_NEAR(*middle, 0.0, 0.04);
  }
}

TEST(DriveSimulation, WithoutRollingShutterPointsBelongToTheMiddle) {
  DriveSimulation::Params params = perfectDrive("town", 0.8, 1200);
  const Pose T_base_lidar = params.T_base_lidar();
  const auto rolling = simulate(params);
  params.rolling_shutter = false;
  const auto global = simulate(params);
  EXPECT_TRUE(global[3].sweep.times_s.empty());
  EXPECT_EQ(global[3].T_world_lidar.matrix(), rolling[3].T_world_lidar.matrix());
  const auto first = inWorld(global[4], T_base_lidar, false);
  const double good = medianGap(first, inWorld(global[7], T_base_lidar, false));
  EXPECT_LT(good, 0.02);
  EXPECT_GT(medianGap(first, inWorld(rolling[7], T_base_lidar, false)), 1.5 * good);
}

TEST(DriveSimulation, DenseTrafficIsSeen) {
  const DriveSimulation::Params params = drive("open", 0.3);
  DriveSimulation calm(params, 1), dense(params, 1);
  SimulatedSweep without, with;
  ASSERT_TRUE(calm.next(without));
  ASSERT_TRUE(dense.next(with, 12));
  const auto standing = [](const Sweep& sweep) {
    return std::count_if(sweep.points_lidar.begin(), sweep.points_lidar.end(),
                         [](const Eigen::Vector3f& p) { return p.norm() < 25.0f && p.z() > -1.2f; });
  };
  EXPECT_GT(standing(with.sweep), 3000);
  EXPECT_LT(standing(without.sweep), 500);
}

TEST(DriveSimulation, TheMountAndBaseLinkAreThoseOfTheShippedFiles) {
  const PipelineParameters shipped = loadPipelineParameters({FAIL_AWARE_SOURCE_CFG, "default", "passat_b6", "hdl64e"});
  const DriveSimulation::Params params;
  EXPECT_EQ(params.lidar_in_base, shipped.sensor.lidar_in_base);
  const auto& dynamics = shipped.vehicle.dynamics;
  EXPECT_EQ(params.drive.vehicle.cog_to_front_axle_m, dynamics.cog_to_front_axle_m);
  const Eigen::Vector3d half_way(0.5 * (dynamics.cog_to_rear_axle_m - dynamics.cog_to_front_axle_m), 0.0,
                                 dynamics.cog_height_m);
  EXPECT_TRUE(shipped.vehicle.T_base_cog().translation().isApprox(half_way, 1e-12))
      << "where the simulator has base_link";
}

TEST(DriveSimulation, RefusesBadParameters) {
  const auto refused = [](auto&& change) {
    DriveSimulation::Params params;
    change(params);
    EXPECT_THROW(DriveSimulation(params, 1), ParameterError);
  };
  refused([](auto& p) { p.scene = "moon"; });
  refused([](auto& p) { p.duration_s = 0.0; });
  refused([](auto& p) { p.seed = -1; });
  refused([](auto& p) { p.lidar_in_base = {1, 2}; });
  refused([](auto& p) { p.lidar_in_base = {-0.6, 0, 1.73, 0, 0, 90}; });
  refused([](auto& p) { p.lidar.columns = 0; });
  refused([](auto& p) { p.lidar.period_s = 0.1004; });
  refused([](auto& p) { p.drive.start_speed_mps = 100.0; });
  refused([](auto& p) { p.drive.speed.speed_mps = 1000.0; });
  EXPECT_THROW(DriveSimulation(DriveSimulation::Params(), 0), ParameterError);
}

}  // namespace
}  // namespace fail_aware::drive_simulation_test
