#include "simulation/sweep_stamping.hpp"

#include <gtest/gtest.h>

namespace fail_aware::sweep_stamping_test {
namespace {

SimulatedSweep simulated() {
  SimulatedSweep sweep;
  sweep.begin_s = 4.0;
  sweep.sweep.stamp_s = 4.05;
  sweep.sweep.points_lidar = {{1, 0, 0}, {2, 0, 0}};
  sweep.sweep.times_s = {0.02f, 0.09f};
  sweep.sweep.intensities = {0.5f, 1.0f};
  return sweep;
}

TEST(SweepStamping, KittiHasTheMiddleAndTimesFromTheStart) {
  const Sweep sweep = kittiSweep(simulated());
  EXPECT_EQ(sweep.stamp_s, 4.05);
  EXPECT_EQ(sweep.times_s, (std::vector<float>{0.02f, 0.09f}));
}

TEST(SweepStamping, DriverHasTheEndAndTimesBeforeIt) {
  const Sweep sweep = driverSweep(simulated());
  EXPECT_DOUBLE_EQ(sweep.stamp_s, 4.1);
  EXPECT_NEAR(sweep.times_s[0], -0.08f, 1e-6f);
  EXPECT_NEAR(sweep.times_s[1], -0.01f, 1e-6f);
  EXPECT_FLOAT_EQ(sweep.intensities[1], 255.0f);
}

TEST(SweepStamping, WrongSignTurnsEveryTime) {
  SimulatedSweep wrong = simulated();
  wrong.time_sign_wrong = true;
  EXPECT_EQ(kittiSweep(wrong).times_s[1], -0.09f);
  EXPECT_NEAR(driverSweep(wrong).times_s[0], 0.08f, 1e-6f);
  EXPECT_EQ(driverSweep(wrong).stamp_s, driverSweep(simulated()).stamp_s);
}

}  // namespace
}  // namespace fail_aware::sweep_stamping_test
