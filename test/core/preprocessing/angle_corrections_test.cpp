#include "core/preprocessing/angle_corrections.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::angle_corrections_test {
namespace {

constexpr double kKittiAngle_deg = 0.205, kKitti_rad = kKittiAngle_deg * kDegree;

TEST(VerticalAngleCorrection, RaisesElevationOnly) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 150; ++i) {  // not a multiple of the block size
    const double azimuth = 0.11 * i - 3.1, elevation = 0.02 * (i % 30) - 0.43, range = 2.0 + 0.7 * i;
    points.push_back((range * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation)))
                         .cast<float>());
  }
  std::vector<Eigen::Vector3f> corrected = points;
  correctVerticalAngle(kKitti_rad, corrected);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>(), q = corrected[i].cast<double>();
    EXPECT_NEAR(std::atan2(q.z(), q.head<2>().norm()) - std::atan2(p.z(), p.head<2>().norm()), kKitti_rad, 1e-6);
    EXPECT_NEAR(std::atan2(q.y(), q.x()), std::atan2(p.y(), p.x()), 1e-6);
    EXPECT_NEAR(q.norm(), p.norm(), 1e-6 * p.norm());
    const Eigen::Vector3d axis = p.cross(Eigen::Vector3d::UnitZ()).normalized();
    EXPECT_LT((Eigen::AngleAxisd(kKitti_rad, axis) * p - q).norm(), 2e-6 * p.norm());
  }
}

TEST(VerticalAngleCorrection, GroundFarAwayIsRaised) {
  std::vector<Eigen::Vector3f> points = {{50.0f, 0.0f, -1.73f}};
  correctVerticalAngle(kKitti_rad, points);
  EXPECT_NEAR(points[0].z(), -1.73 + 50.0 * 0.003578, 1e-3);
}

TEST(VerticalAngleCorrection, ZeroIsOffAndNegativeIsTheInverse) {
  const std::vector<Eigen::Vector3f> points = {{10.0f, -4.0f, 1.0f}, {-3.0f, 0.5f, -1.7f}};
  std::vector<Eigen::Vector3f> moved = points;
  correctVerticalAngle(0.0, moved);
  EXPECT_EQ(moved, points);
  correctVerticalAngle(kKitti_rad, moved);
  correctVerticalAngle(-kKitti_rad, moved);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((moved[i] - points[i]).norm(), 1e-5f);
}

TEST(VerticalAngleCorrection, PointsOnTheAxisStayFiniteAndNear) {
  std::vector<Eigen::Vector3f> points = {
      {0.0f, 0.0f, 5.0f}, {0.0f, 0.0f, -5.0f}, {0.0f, 0.0f, 0.0f}, {1e-8f, -1e-9f, 5.0f}, {1e-25f, 0.0f, 5.0f}};
  const std::vector<Eigen::Vector3f> before = points;
  correctVerticalAngle(kKitti_rad, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(points[i].allFinite());
    EXPECT_LT((points[i] - before[i]).norm(), 0.0036f * 5.0f);
  }
  std::vector<Eigen::Vector3f> none;
  correctVerticalAngle(kKitti_rad, none);
  EXPECT_TRUE(none.empty());
}

TEST(VerticalAngleCorrection, RefusesAbsurdAngles) {
  VerticalAngleCorrectionParams params;
  params.angle_deg = 20.0;
  EXPECT_THROW(validate(params), ParameterError);
  params.angle_deg = std::nan("");
  EXPECT_THROW(validate(params), ParameterError);
}

TEST(AzimuthCorrection, TurnsCounterClockwiseSeenFromAbove) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 150; ++i) {  // not a multiple of the block size
    const double azimuth = 0.11 * i - 3.1, way = 2.0 + 0.7 * i;
    points.emplace_back(static_cast<float>(way * std::cos(azimuth)), static_cast<float>(way * std::sin(azimuth)),
                        0.1f * static_cast<float>(i % 30) - 2.0f);
  }
  std::vector<Eigen::Vector3f> corrected = points;
  correctAzimuth({-0.4}, corrected);
  const Eigen::AngleAxisd turn(-0.4 * kDegree, Eigen::Vector3d::UnitZ());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    EXPECT_LT((turn * p - corrected[i].cast<double>()).norm(), 1e-6 * p.norm());
    EXPECT_EQ(corrected[i].z(), points[i].z());
  }
  std::vector<Eigen::Vector3f> ahead = {{10.0f, 0.0f, 0.0f}};
  correctAzimuth({1.0}, ahead);
  EXPECT_GT(ahead[0].y(), 0.17f);
}

TEST(AzimuthCorrection, ZeroIsOff) {
  const std::vector<Eigen::Vector3f> points = {{10.0f, -4.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
  std::vector<Eigen::Vector3f> same = points;
  correctAzimuth({}, same);
  EXPECT_EQ(same, points);
}

TEST(AzimuthCorrection, RefusesAbsurdAngles) {
  for (const double angle_deg : {-10.1, 10.1, std::nan("")}) {
    EXPECT_THROW(validate(AzimuthCorrectionParams{angle_deg}), ParameterError) << angle_deg;
  }
  EXPECT_NO_THROW(validate(AzimuthCorrectionParams{-10.0}));
}

}  // namespace
}  // namespace fail_aware::angle_corrections_test
