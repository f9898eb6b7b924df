#include "core/registration/corner_svd/ransac_plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::ransac_plane_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

class Noise {
 public:
  explicit Noise(std::uint32_t seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(static_cast<std::uint32_t>(generator_())) / 4294967296.0;
  }
  double normal(double sigma) {  // sum of twelve uniforms
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sigma * sum;
  }

 private:
  std::mt19937 generator_;
};

// A wall through `middle`, 6 m long and 3 m high, noise along its normal.
void addWall(Points& points, int count, const Eigen::Vector3d& normal, const Eigen::Vector3d& middle, double sigma_m,
             Noise& noise) {
  const Eigen::Vector3d along = kUp.cross(normal).normalized(), rise = normal.cross(along);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = middle + noise.uniform(-3, 3) * along + noise.uniform(-1.5, 1.5) * rise;
    points.push_back((p + noise.normal(sigma_m) * normal).cast<float>());
  }
}

void addClutter(Points& points, int count, const Eigen::Vector3d& middle, Noise& noise) {
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d offset(noise.uniform(-3, 3), noise.uniform(-3, 3), noise.uniform(-1.5, 1.5));
    points.push_back((middle + offset).cast<float>());
  }
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::acos(std::min(1.0, a.dot(b))); }

TEST(RansacPlane, FindsAWallAmongFortyPercentOutliers) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Noise noise(seed);
    const Eigen::Vector3d normal = rotationFromRpy(0, 0, noise.uniform(-3, 3)).col(0), middle(12, -20, 1);
    Points points;
    addWall(points, 600, normal, middle, 0.02, noise);
    addClutter(points, 400, middle, noise);
    std::shuffle(points.begin(), points.end(), std::mt19937(seed));
    const RansacPlane plane = ransacPlane(points, kUp, {}, seed);
    ASSERT_TRUE(plane.found);
    EXPECT_LT(std::min(angleBetween(plane.normal, normal), angleBetween(plane.normal, -normal)), 0.5 * 3.14159 / 180);
    EXPECT_NEAR(plane.normal.dot(middle) + plane.d_m, 0.0, 0.01);
    EXPECT_GE(plane.inliers.size(), 595u);
    EXPECT_LE(plane.inliers.size(), 660u);
    EXPECT_NEAR(plane.rms_m, 0.023, 0.006);
    EXPECT_GE(plane.d_m, 0.0) << "the normal must point to the origin";
    EXPECT_LT(plane.iterations, 100);
  }
}

TEST(RansacPlane, SameSeedSameResult) {
  Noise noise(3);
  Points points;
  addWall(points, 300, Eigen::Vector3d::UnitX(), {5, 5, 0}, 0.03, noise);
  addClutter(points, 300, {5, 5, 0}, noise);
  const RansacPlane a = ransacPlane(points, kUp, {}, 7), b = ransacPlane(points, kUp, {}, 7);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.iterations, b.iterations);
}

TEST(RansacPlane, WithoutEarlyStopAllIterationsRun) {
  Noise noise(4);
  Points points;
  addWall(points, 500, Eigen::Vector3d::UnitX(), {5, 5, 0}, 0.02, noise);
  RansacPlane::Params params;
  params.stop_early = false;
  EXPECT_EQ(ransacPlane(points, kUp, params, 1).iterations, params.iterations);
  params.stop_early = true;
  EXPECT_LT(ransacPlane(points, kUp, params, 1).iterations, 30);
}

TEST(RansacPlane, UpNeedNotBeZ) {
  Noise noise(5);
  const Eigen::Matrix3d R = rotationFromRpy(0.15, -0.2, 0.3);
  Points level, points;
  addWall(level, 500, Eigen::Vector3d(0.6, 0.8, 0), {5, 5, 0}, 0.01, noise);
  for (const Eigen::Vector3f& p : level) points.push_back(R.cast<float>() * p);
  RansacPlane::Params params;
  params.max_tilt_deg = 2.0;
  const RansacPlane plane = ransacPlane(points, R.col(2), params, 1);
  ASSERT_TRUE(plane.found);
  EXPECT_NEAR(std::abs(plane.normal.dot(R * Eigen::Vector3d(0.6, 0.8, 0))), 1.0, 1e-4);
}

TEST(RansacPlane, ATiltedWallIsFoundUpToTheTolerance) {
  for (const double tilt_deg : {4.0, 8.0}) {
    Noise noise(6);
    Points points;
    const Eigen::Vector3d normal = rotationFromRpy(0, -tilt_deg * 3.14159265 / 180, 0).col(0);
    addWall(points, 800, normal, {10, 0, 0}, 0.01, noise);
    RansacPlane::Params params;
    params.inlier_distance_m = 0.3;
    params.max_tilt_deg = 6.0;
    EXPECT_EQ(ransacPlane(points, kUp, params, 1).found, tilt_deg < 6.0) << tilt_deg;
  }
}

TEST(RansacPlane, NoPlaneInTooFewPointsNorInAPole) {
  Noise noise(7);
  Points points;
  addWall(points, 59, Eigen::Vector3d::UnitX(), {5, 5, 0}, 0.01, noise);
  EXPECT_FALSE(ransacPlane(points, kUp, {}, 1).found);
  EXPECT_FALSE(ransacPlane({}, kUp, {}, 1).found);
  Points pole;
  for (int i = 0; i < 300; ++i) pole.emplace_back(4.0F, 4.0F, static_cast<float>(noise.uniform(0, 3)));
  EXPECT_FALSE(ransacPlane(pole, kUp, {}, 1).found);
}

TEST(RansacPlane, BadParametersAreNamed) {
  RansacPlane::Params params;
  params.max_sample_points = 9;
  try {
    validate(params);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("max_sample_points"), std::string::npos);
  }
}

}  // namespace
}  // namespace fail_aware::ransac_plane_test
