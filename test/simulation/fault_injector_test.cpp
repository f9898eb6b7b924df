#include "simulation/fault_injector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace fail_aware::fault_injector_test {
namespace {

SimulatedSweep sweepAt(int i) {
  SimulatedSweep sweep;
  sweep.begin_s = 0.1 * i;
  sweep.sweep.stamp_s = sweep.middle_s();
  sweep.T_world_lidar.translation().x() = i;
  sweep.sweep.points_lidar = {{static_cast<float>(i + 1), 0, 0}, {0, 5, 0}};
  sweep.sweep.rings = {0, 1};
  sweep.sweep.times_s = {0.02f, 0.05f};
  sweep.sweep.intensities = {0.1f, 0.2f};
  return sweep;
}

std::vector<SimulatedSweep> run(const std::vector<std::string>& faults, int count = 30) {
  std::vector<Fault> parsed;
  for (const std::string& text : faults) parsed.push_back(Fault::parse(text));
  FaultInjector injector(1, parsed);
  std::vector<SimulatedSweep> all;
  for (int i = 0; i < count; ++i) {
    for (SimulatedSweep& sweep : injector.apply(sweepAt(i))) all.push_back(std::move(sweep));
  }
  for (SimulatedSweep& sweep : injector.flush()) all.push_back(std::move(sweep));
  return all;
}

std::vector<int> indices(const std::vector<SimulatedSweep>& sweeps) {
  std::vector<int> indices;
  for (const SimulatedSweep& sweep : sweeps) indices.push_back(static_cast<int>(std::lround(sweep.begin_s * 10)));
  return indices;
}

TEST(FaultInjector, WithoutFaultsNothingChanges) {
  const auto sweeps = run({});
  ASSERT_EQ(sweeps.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) {
    const SimulatedSweep expected = sweepAt(static_cast<int>(i));
    EXPECT_EQ(sweeps[i].sweep.points_lidar, expected.sweep.points_lidar);
    EXPECT_EQ(sweeps[i].sweep.stamp_s, expected.sweep.stamp_s);
  }
}

TEST(FaultInjector, DroppedDuplicatedReordered) {
  EXPECT_EQ(indices(run({"dropped:1:0.3"}, 15)), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 14}));
  EXPECT_EQ(indices(run({"duplicated:0.2:0.2"}, 6)), (std::vector<int>{0, 1, 2, 2, 3, 3, 4, 5}));
  EXPECT_EQ(indices(run({"reordered:0.2:0.4"}, 8)), (std::vector<int>{0, 1, 3, 2, 5, 4, 6, 7}));
  EXPECT_EQ(indices(run({"reordered:0.5:9"}, 6)), (std::vector<int>{0, 1, 2, 3, 4, 5}));  // the last waits for none
}

TEST(FaultInjector, TruthStaysAndStampsAreWhatTheFaultMakesThem) {
  const auto frozen = run({"frozen_cloud:1:0.5"});
  for (std::size_t i : {10u, 14u}) {
    EXPECT_EQ(frozen[i].sweep.points_lidar[0].x(), 10.0f);  // those of sweep 9
    EXPECT_NEAR(frozen[i].sweep.stamp_s, 0.1 * static_cast<double>(i) + 0.05, 1e-9);
    EXPECT_EQ(frozen[i].T_world_lidar.translation().x(), static_cast<double>(i));
  }
  EXPECT_EQ(frozen[15].sweep.points_lidar[0].x(), 16.0f);
  const auto jumped = run({"stamp_jump:1:1:-5"});
  EXPECT_NEAR(jumped[9].sweep.stamp_s, 0.95, 1e-9);
  EXPECT_NEAR(jumped[10].sweep.stamp_s, 1.05 - 5.0, 1e-9);
  EXPECT_NEAR(jumped[10].middle_s(), 1.05, 1e-9);
  EXPECT_NEAR(jumped[20].sweep.stamp_s, 2.05, 1e-9);
  const auto jittered = run({"stamp_jitter:1:100:0.01"}, 500);
  EXPECT_EQ(jittered[9].sweep.stamp_s, sweepAt(9).sweep.stamp_s);
  double sum_s2 = 0.0;
  for (int i = 10; i < 500; ++i) {
    const double error_s = jittered[static_cast<std::size_t>(i)].sweep.stamp_s - sweepAt(i).sweep.stamp_s;
    EXPECT_NEAR(error_s, 0.0, 0.035);
    sum_s2 += error_s * error_s;
  }
  EXPECT_NEAR(std::sqrt(sum_s2 / 490.0), 0.01, 0.001);
  EXPECT_TRUE(run({"time_sign:1"})[12].time_sign_wrong);
}

TEST(FaultInjector, FaultsOnPointsAndSeveralAtOnce) {
  const auto sweeps = run({"blanked_sector:1:1:90", "range_cap:1:1:4", "nan:2:0.2", "empty_cloud:2.5:0.2"});
  EXPECT_EQ(sweeps[5].sweep.size(), 2u);
  EXPECT_EQ(sweeps[12].sweep.size(), 0u);
  EXPECT_TRUE(std::isnan(sweeps[20].sweep.points_lidar[0].x()));
  EXPECT_EQ(sweeps[25].sweep.size(), 0u);
  EXPECT_EQ(sweeps[28].sweep.size(), 2u);
}

TEST(FaultInjector, ShareDecidesHowMany) {
  const auto dropped = run({"dropped:0:100:0.4"}, 500);
  EXPECT_NEAR(static_cast<double>(dropped.size()), 300.0, 40.0);
  EXPECT_EQ(indices(dropped), indices(run({"dropped:0:100:0.4"}, 500)));
}

}  // namespace
}  // namespace fail_aware::fault_injector_test
