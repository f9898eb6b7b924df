#include "core/preprocessing/rings_by_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"

namespace fail_aware::rings_by_order_test {
namespace {

struct Scan {
  std::vector<Eigen::Vector3f> points_lidar;
  std::vector<std::uint16_t> rings;

  void add(double azimuth_deg, int ring) {
    const double elevation_rad = (-24.0 + 0.4 * ring) * kDegree, azimuth_rad = azimuth_deg * kDegree;
    const double level_m = 20.0 * std::cos(elevation_rad);
    points_lidar.emplace_back(static_cast<float>(level_m * std::cos(azimuth_rad)),
                              static_cast<float>(level_m * std::sin(azimuth_rad)),
                              static_cast<float>(20.0 * std::sin(elevation_rad)));
    rings.push_back(static_cast<std::uint16_t>(ring));
  }
};

/// The order of KITTI's files; at the rear the azimuth steps back by `turn_deg`. Not every beam sees something
/// everywhere.
Scan kittiScan(double turn_deg) {
  Scan scan;
  for (int ring = 63; ring >= 0; --ring) {
    const double first_deg = ring % 7 == 3 ? 40.0 : 0.1, last_deg = ring % 5 == 2 ? 250.0 : 359.9;
    for (double deg = first_deg; deg < 180.0 + 0.5 * turn_deg; deg += 0.7) scan.add(deg, ring);
    for (double deg = 180.0 - 0.5 * turn_deg; deg < last_deg; deg += 0.7) scan.add(deg, ring);
  }
  return scan;
}

TEST(RingsByOrder, AreCountedBeamByBeam) {
  for (const double turn_deg : {0.0, 3.0, 6.0}) {
    const Scan scan = kittiScan(turn_deg);
    EXPECT_EQ(ringsByOrder(scan.points_lidar), scan.rings) << turn_deg;
  }
}

TEST(RingsByOrder, AzimuthsAboutStraightAheadMayComeInAnyOrder) {
  Scan scan;
  for (int ring = 63; ring >= 0; --ring) {
    for (const double deg : {359.95, 0.05, 359.9, 0.1, 90.0, 180.0, 270.0, 359.8}) scan.add(deg, ring);
  }
  // The first point of a beam, straight ahead but on the right, cannot be told from the last one of the beam before.
  const std::vector<std::uint16_t> rings = ringsByOrder(scan.points_lidar);
  ASSERT_EQ(rings.size(), scan.rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (i % 8 == 0) continue;
    EXPECT_EQ(rings[i], scan.rings[i]) << i;
  }
}

TEST(RingsByOrder, AnotherOrderHasNone) {
  EXPECT_TRUE(ringsByOrder({}).empty());
  Scan scan = kittiScan(2.0);
  Scan fewer;
  for (std::size_t i = 0; i < scan.points_lidar.size(); ++i) {
    if (scan.rings[i] != 40) fewer.points_lidar.push_back(scan.points_lidar[i]);
  }
  EXPECT_TRUE(ringsByOrder(fewer.points_lidar).empty()) << "a beam is missing";
  fewer = scan;
  for (double deg = 0.0; deg < 360.0; deg += 1.0) fewer.add(deg, -1);
  EXPECT_TRUE(ringsByOrder(fewer.points_lidar).empty()) << "a beam too many";
  std::reverse(scan.points_lidar.begin(), scan.points_lidar.end());
  EXPECT_TRUE(ringsByOrder(scan.points_lidar).empty()) << "clockwise from the lowest";

  Scan columns;
  for (double deg = 0.0; deg < 360.0; deg += 1.0) {
    for (int ring = 0; ring < 64; ++ring) columns.add(deg, ring);
  }
  EXPECT_TRUE(ringsByOrder(columns.points_lidar).empty()) << "column by column";

  Scan rising;
  for (int ring = 0; ring < 64; ++ring) {
    for (double deg = 0.0; deg < 360.0; deg += 1.0) rising.add(deg, ring);
  }
  EXPECT_TRUE(ringsByOrder(rising.points_lidar).empty()) << "the lowest beam first";
}

}  // namespace
}  // namespace fail_aware::rings_by_order_test
