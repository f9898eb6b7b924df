#include "core/preprocessing/revolution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fail_aware::revolution_test {
namespace {

struct Turning {
  std::vector<Eigen::Vector3f> points_lidar;
  std::vector<float> times_s;
};

/// `turns` of a head that needs period_s for one; beams look up to 10 deg to the side of where the head does.
Turning turning(double period_s, double turns, double direction = -1.0) {
  Turning cloud;
  constexpr int kColumns = 1800, kBeams = 16;
  for (int column = 0; column < static_cast<int>(kColumns * turns); ++column) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double azimuth_rad = 3.0 + direction * 2.0 * M_PI * column / kColumns + (beam % 5 - 2) * 0.087;
      const double range_m = 5.0 + (column * 7 + beam * 13) % 40;
      cloud.points_lidar.emplace_back(static_cast<float>(range_m * std::cos(azimuth_rad)),
                                      static_cast<float>(range_m * std::sin(azimuth_rad)),
                                      0.1f * static_cast<float>(beam));
      cloud.times_s.push_back(static_cast<float>(period_s * column / kColumns - 0.03));
    }
  }
  return cloud;
}

TEST(Revolution, IsThePeriodOfAWholePartOrDoubleTurn) {
  for (const double period_s : {0.05, 0.1, 0.1033, 0.2}) {
    for (const double turns : {0.5, 1.0, 2.0}) {
      for (const double direction : {-1.0, 1.0}) {
        const Turning cloud = turning(period_s, turns, direction);
        EXPECT_NEAR(revolutionFromTimes(cloud.points_lidar, cloud.times_s), period_s, 0.003 * period_s)
            << period_s << ", " << turns;
      }
    }
  }
}

TEST(Revolution, BearsABlindSectorAndSingleWrongTimes) {
  Turning cloud = turning(0.1, 1.0), seen;
  for (std::size_t i = 0; i < cloud.times_s.size(); ++i) {
    const float yaw = std::atan2(cloud.points_lidar[i].y(), cloud.points_lidar[i].x());
    if (yaw > 0.5f && yaw < 1.5f) continue;
    seen.points_lidar.push_back(cloud.points_lidar[i]);
    seen.times_s.push_back(i % 997 == 0 ? 1e6f : cloud.times_s[i]);
  }
  EXPECT_NEAR(revolutionFromTimes(seen.points_lidar, seen.times_s), 0.1, 0.001);
}

TEST(Revolution, IsUnknownWhereTimesDoNotTurnWithThePoints) {
  Turning cloud = turning(0.1, 1.0);
  EXPECT_EQ(revolutionFromTimes({}, {}), 0.0);
  EXPECT_EQ(revolutionFromTimes(cloud.points_lidar, {0.1f}), 0.0);
  EXPECT_EQ(revolutionFromTimes(cloud.points_lidar, std::vector<float>(cloud.times_s.size(), 0.0f)), 0.0);
  for (std::size_t i = 0; i < cloud.times_s.size(); ++i) {  // a solid-state lidar: all directions at all times
    cloud.times_s[i] = static_cast<float>((i * 7919) % cloud.times_s.size());
  }
  EXPECT_EQ(revolutionFromTimes(cloud.points_lidar, cloud.times_s), 0.0);
}

}  // namespace
}  // namespace fail_aware::revolution_test
