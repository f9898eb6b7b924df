#include "simulation/lidar_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "simulation/lidar_head.hpp"
#include "simulation/random.hpp"

namespace fail_aware::lidar_model_test {
namespace {

LidarModel::Params perfect() {
  LidarModel::Params params;
  params.range_noise_m = params.range_bias_m = params.elevation_error_deg = params.dropout = 0.0;
  return params;
}

RayHit hitAt(float range_m, Material material, float incidence_cos = 1.0f) {
  return {range_m, incidence_cos, material};
}

std::vector<double> elevationsDeg(const LidarModel& lidar, double azimuth_rad) {
  std::vector<Eigen::Vector3f> directions(lidar.beams());
  lidar.pointing(azimuth_rad, directions.data());
  std::vector<double> elevations;
  for (const Eigen::Vector3f& d : directions) {
    elevations.push_back(std::asin(static_cast<double>(d.z())) / kDegree);
    EXPECT_NEAR(std::atan2(d.y(), d.x()), azimuth_rad, 1e-5);
  }
  return elevations;
}

TEST(LidarModel, TurnsClockwiseFromTheRearInOnePeriod) {
  const LidarModel lidar(1, perfect());
  const int columns = lidar.params().columns;
  EXPECT_NEAR(lidar.azimuth(0), M_PI, 0.002);
  EXPECT_NEAR(lidar.azimuth(columns / 4), 0.5 * M_PI, 0.003);  // left, then ahead, then right
  EXPECT_NEAR(lidar.azimuth(columns / 2), 0.0, 0.003);
  EXPECT_NEAR(lidar.azimuth(3 * columns / 4), -0.5 * M_PI, 0.003);
  for (int column : {0, 500, 2082}) {
    EXPECT_NEAR(lidar.columnTime(column) / 0.1, 0.5 * (1.0 - lidar.azimuth(column) / M_PI), 1e-12);
  }
}

TEST(LidarModel, HasTheBeamsOfAnHdl64e) {
  const std::vector<double> elevations = elevationsDeg(LidarModel(1, perfect()), 0.3);
  ASSERT_EQ(elevations.size(), 64u);
  EXPECT_NEAR(elevations[0], -24.33, 1e-3);
  EXPECT_NEAR(elevations[31], -8.83, 1e-3);
  EXPECT_NEAR(elevations[32], 2.0 - 31.0 / 3.0, 1e-3);
  EXPECT_NEAR(elevations[63], 2.0, 1e-3);
  for (std::size_t i = 1; i < 64; ++i) EXPECT_GT(elevations[i], elevations[i - 1]);
}

TEST(LidarModel, HasTheBeamsOfOtherHeads) {
  struct Head {
    const char* name;
    std::size_t beams;
    double lowest_deg, highest_deg, least_step_deg;
  };
  const Head heads[] = {{"hdl32e", 32, -30.67, 10.67, 1.333},
                        {"vlp32c", 32, -25.0, 15.0, 1.0 / 3.0},
                        {"vlp16", 16, -15.0, 15.0, 2.0},
                        {"os1_64", 64, -22.5, 22.5, 45.0 / 63.0},
                        {"os1_128", 128, -22.5, 22.5, 45.0 / 127.0},
                        {"pandar64", 64, -25.0, 15.0, 1.0 / 6.0}};
  ASSERT_EQ(std::size(heads) + 1, lidarHeadNames().size()) << "and hdl64e";
  for (const Head& head : heads) {
    SCOPED_TRACE(head.name);
    LidarModel::Params params = perfect();
    params.head = head.name;
    const std::vector<double> elevations = elevationsDeg(LidarModel(1, params), 0.3);
    ASSERT_EQ(elevations.size(), head.beams);
    EXPECT_NEAR(elevations.front(), head.lowest_deg, 1e-3);
    EXPECT_NEAR(elevations.back(), head.highest_deg, 1e-3);
    double least_step_deg = 90.0;
    for (std::size_t i = 1; i < elevations.size(); ++i)
      least_step_deg = std::min(least_step_deg, elevations[i] - elevations[i - 1]);
    EXPECT_NEAR(least_step_deg, head.least_step_deg, 2e-3);
  }
  LidarModel::Params params = perfect();
  params.head = "another";
  EXPECT_THROW(LidarModel(1, params), ParameterError);
}

TEST(LidarModel, NoiseHasItsSize) {
  LidarModel::Params params = perfect();
  params.range_noise_m = 0.03;
  const LidarModel lidar(1, params);
  double sum = 0.0, sum2 = 0.0;
  int count = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto echo = lidar.measure(10, 0.0, hitAt(20.0f, Material::kMetal), combineKeys(3, i));
    if (!echo) continue;
    const double error = static_cast<double>(echo->point_lidar.norm()) - 20.0;
    sum += error;
    sum2 += error * error;
    ++count;
  }
  EXPECT_NEAR(count / 20000.0, 1.0 - static_cast<double>(properties(Material::kMetal).dropout), 0.01);
  EXPECT_NEAR(sum / count, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(sum2 / count), std::hypot(0.03, 0.003), 0.001);
}

TEST(LidarModel, BeamErrorsAreConstantAndOfTheHead) {
  LidarModel::Params params = perfect();
  params.range_bias_m = 0.05;
  params.elevation_error_deg = 0.2;
  const LidarModel a(1, params), b(2, params);
  const RayHit hit = hitAt(20.0f, Material::kWall);
  const auto real = elevationsDeg(a, 0.0), nominal = elevationsDeg(LidarModel(1, perfect()), 0.0);
  double bias2 = 0.0, elevation2 = 0.0, difference = 0.0;
  for (std::size_t beam = 0; beam < 64; ++beam) {
    const auto first = a.measure(beam, 0.0, hit, 7), again = a.measure(beam, 0.0, hit, 7);
    const auto other = b.measure(beam, 0.0, hit, 7);
    ASSERT_TRUE(first && again && other);
    EXPECT_EQ(first->point_lidar, again->point_lidar);
    const auto range = static_cast<double>(first->point_lidar.norm());
    bias2 += std::pow(range - 20.0, 2);
    difference += std::abs(range - static_cast<double>(other->point_lidar.norm()));
    // reported along the nominal beam, whatever it really hit
    EXPECT_NEAR(std::asin(static_cast<double>(first->point_lidar.z()) / range) / kDegree, nominal[beam], 1e-3);
    elevation2 += std::pow(real[beam] - nominal[beam], 2);
  }
  EXPECT_NEAR(std::sqrt(bias2 / 64), 0.05, 0.015);
  EXPECT_NEAR(std::sqrt(elevation2 / 64), 0.2, 0.06);
  EXPECT_GT(difference, 0.5);
}

TEST(LidarModel, WeakReturnsAreLost) {
  const LidarModel lidar(1, perfect());
  const auto seen = [&](const RayHit& hit) {
    int count = 0;
    for (std::uint64_t i = 0; i < 200; ++i) count += lidar.measure(40, 0.0, hit, combineKeys(9, i)).has_value();
    return count / 200.0;
  };
  EXPECT_EQ(seen(hitAt(30.0f, Material::kAsphalt, 0.06f)), 1.0);
  EXPECT_EQ(seen(hitAt(90.0f, Material::kAsphalt, 0.02f)), 0.0);
  EXPECT_EQ(seen(hitAt(110.0f, Material::kSign)), 1.0);
  EXPECT_EQ(seen(hitAt(0.5f, Material::kWall)), 0.0);  // nearer than it can measure
  EXPECT_EQ(seen(RayHit()), 0.0);
}

}  // namespace
}  // namespace fail_aware::lidar_model_test
