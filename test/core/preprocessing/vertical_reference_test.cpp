#include "core/preprocessing/vertical_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {
namespace {

/// Sensor frame, level sensor: walls ahead, behind and beside, and poles; each leans by `lean_rad` away from the
/// sensor.
std::vector<Eigen::Vector3f> street(std::mt19937& random, double lean_rad = 0.0) {
  std::normal_distribution<double> noise(0.0, 0.01);
  std::uniform_real_distribution<double> place(-20.0, 20.0);
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](Eigen::Vector3d p) {
    const Eigen::Vector2d away = p.head<2>().normalized();
    p.head<2>() += lean_rad * p.z() * away;
    points.push_back((p + Eigen::Vector3d(noise(random), noise(random), 0.0)).cast<float>());
  };
  for (int wall = 0; wall < 12; ++wall) {
    const double x = place(random), y = place(random);
    const bool frontal = wall % 2 == 0;
    for (double along = 0.0; along < 4.0; along += 0.1) {
      for (double z = -1.1; z < 0.5; z += 0.15) {
        add(frontal ? Eigen::Vector3d(x, y + along, z) : Eigen::Vector3d(x + along, y, z));
      }
    }
  }
  for (int pole = 0; pole < 6; ++pole) {
    const double x = place(random), y = place(random);
    for (double z = -1.1; z < 0.8; z += 0.05) add({x, y, z});
  }
  return points;
}

Pose tilted(double x, double pitch_rad) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation().x() = x;
  return T;
}

struct Drive {
  double pitch_error_rad = 0.0;
  double worst_late_rad = 0.0;
};

/// The vehicle stays level; the odometry's pitch drifts, less by what it makes of the sweeps' bend.
Drive drive(VerticalReference& level, int metres, double drift_deg_per_m, double response, double lean_rad = 0.0) {
  std::mt19937 random(7);
  Drive result;
  for (int i = 0; i < metres; ++i) {
    result.pitch_error_rad += (drift_deg_per_m - response * level.report().curvature_deg_per_m) * kDegree;
    level.observe(street(random, lean_rad), tilted(i, result.pitch_error_rad));
    if (i > metres / 2) result.worst_late_rad = std::max(result.worst_late_rad, std::abs(result.pitch_error_rad));
  }
  return result;
}

TEST(VerticalReference, MeasuresDriftAndTilt) {
  LevelKeepingParams params;
  params.max_curvature_deg_per_m = 0.0;
  params.tilt_walk_deg = 0.005;
  params.sigma_place_deg = 0.0;  // this street has none
  VerticalReference level(params);
  const Drive result = drive(level, 200, 0.004, 0.0);
  EXPECT_GT(level.report().surfaces, 5u);
  EXPECT_GT(level.report().lines, 2u);
  EXPECT_NEAR(level.report().drift_deg_per_m, 0.004, 0.001);
  EXPECT_NEAR(level.report().tilt_deg, result.pitch_error_rad / kDegree, 0.1);
  EXPECT_LT(level.report().drift_sigma_deg_per_m, 0.001);
}

TEST(VerticalReference, BendEndsTheDrift) {
  VerticalReference level;
  const double response = LevelKeepingParams().response;
  const Drive result = drive(level, 300, 0.004, response);
  EXPECT_LT(result.worst_late_rad, 0.25 * kDegree);  // 1.2 deg without
  EXPECT_NEAR(response * level.report().curvature_deg_per_m, 0.004, 0.0015);
}

TEST(VerticalReference, ALeanOfEverythingIsNoTilt) {
  VerticalReference level;
  const Drive result = drive(level, 200, 0.0, 1.0, 1.0 * kDegree);
  EXPECT_LT(result.worst_late_rad, 0.1 * kDegree);
}

TEST(VerticalReference, WhatStandsAtOnePlaceMayLeanAlike) {
  const auto driftSigma = [](double sigma_place_deg) {
    LevelKeepingParams params;
    params.sigma_place_deg = sigma_place_deg;
    VerticalReference level(params);
    drive(level, 60, 0.004, 0.0);
    return level.report().drift_sigma_deg_per_m;
  };
  EXPECT_GT(driftSigma(0.5), 1.3 * driftSigma(0.0));
}

TEST(VerticalReference, LowAndThickColumnsCountLittle) {
  // after half of the way low rough banks, ahead and behind, lean by 2 deg beside upright walls
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.025);
  LevelKeepingParams params;
  params.max_curvature_deg_per_m = 0.0;
  VerticalReference level(params);
  for (int i = 0; i < 100; ++i) {
    std::vector<Eigen::Vector3f> points = street(random);
    for (double y = -15.0; i >= 50 && y < 15.0; y += 0.1) {
      for (double z = -1.1; z < -0.3; z += 0.15) {
        for (const double x : {-18.0, 18.0}) {
          points.push_back(Eigen::Vector3d(x + std::tan(2.0 * kDegree) * z + noise(random), y, z).cast<float>());
        }
      }
    }
    level.observe(points, tilted(i, 0.0));
  }
  EXPECT_NEAR(level.report().tilt_deg, 0.0, 0.1);
  EXPECT_NEAR(level.report().drift_deg_per_m, 0.0, 0.001);
}

TEST(VerticalReference, NothingUprightChangesNothing) {
  VerticalReference level;
  std::vector<Eigen::Vector3f> ground;
  for (float x = -30.0f; x < 30.0f; x += 0.5f) {
    for (float y = -30.0f; y < 30.0f; y += 0.5f) ground.emplace_back(x, y, -1.7f);
  }
  for (int i = 0; i < 100; ++i) level.observe(ground, tilted(i, 1e-4 * i));
  EXPECT_GT(level.report().looks, 20u);
  EXPECT_EQ(level.report().curvature_deg_per_m, 0.0);
  std::vector<Eigen::Vector3f> points = ground;
  level.apply(points);
  EXPECT_EQ(points, ground);
}

TEST(VerticalReference, BendIsBoundedAndRaisesWhatIsFar) {
  LevelKeepingParams params;
  params.max_curvature_deg_per_m = 0.002;
  VerticalReference level(params);
  drive(level, 200, 0.02, 0.0);
  EXPECT_DOUBLE_EQ(level.report().curvature_deg_per_m, 0.002);
  std::vector<Eigen::Vector3f> points = {{10.0f, 0.0f, -1.0f}, {0.0f, -40.0f, 0.0f}, {80.0f, 0.0f, 2.0f}};
  level.apply(points);
  const double curvature = 0.002 * kDegree;
  EXPECT_NEAR(points[0].z(), -1.0 + 0.5 * curvature * 100.0, 1e-5);
  EXPECT_NEAR(points[1].z(), 0.5 * curvature * 1600.0, 1e-5);
  EXPECT_NEAR(points[2].z(), 2.0 + 0.5 * curvature * 80.0 * 40.0, 1e-5);
}

TEST(VerticalReference, ResetBeginsAnew) {
  VerticalReference once, again;
  drive(again, 200, 0.004, 1.0);
  again.reset();
  EXPECT_EQ(again.report().looks, 0u);
  drive(once, 100, 0.004, 1.0);
  drive(again, 100, 0.004, 1.0);
  EXPECT_EQ(once.report().curvature_deg_per_m, again.report().curvature_deg_per_m);
  EXPECT_EQ(once.report().tilt_deg, again.report().tilt_deg);
}

/// A pose that is set from outside: the vehicle jumps in odom, its heading is another, and it stands otherwise there.
TEST(VerticalReference, AnotherOdomIsNoWayAndNoTilt) {
  VerticalReference level;
  drive(level, 200, 0.004, 1.0);
  const VerticalReference::Report before = level.report();
  std::mt19937 random(11);
  const auto inOdom = [](int metre) {
    Pose T = tilted(metre, 2.0 * kDegree);
    T = Pose(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ())) * T;
    T.translation() += Eigen::Vector3d(5000.0, -300.0, 40.0);
    return T;
  };
  level.observe(street(random), inOdom(0), 1);
  EXPECT_NEAR(level.report().tilt_deg, 0.0, 1e-9);
  EXPECT_NEAR(level.report().drift_deg_per_m, before.drift_deg_per_m, 1e-9) << "that is the sensor's";
  EXPECT_NEAR(level.report().drift_sigma_deg_per_m, before.drift_sigma_deg_per_m, 1e-9);
  for (int i = 1; i <= 60; ++i) {
    level.observe(street(random), inOdom(i), 1);
    EXPECT_NEAR(level.report().curvature_deg_per_m, before.curvature_deg_per_m, 0.0015) << i;
  }
}

TEST(VerticalReference, BadInputIsHarmless) {
  VerticalReference level;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 20; ++i) {
    level.observe({{nan, 0.0f, 0.0f}, {1e30f, 1.0f, 0.0f}, {0.0f, 0.0f, 0.0f}}, tilted(i, 0.0));
    level.observe({}, tilted(i, 0.0));
  }
  Pose bad = tilted(20.0, 0.0);
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  level.observe({}, bad);
  EXPECT_EQ(level.report().curvature_deg_per_m, 0.0);
}

TEST(VerticalReference, RefusesBadParameters) {
  LevelKeepingParams params;
  params.max_range_m = params.min_range_m;
  EXPECT_THROW(VerticalReference{params}, ParameterError);
  params = LevelKeepingParams();
  params.correlation_inflation = 0.5;
  EXPECT_THROW(VerticalReference{params}, ParameterError);
  params = LevelKeepingParams();
  params.response = 0.0;
  EXPECT_THROW(VerticalReference{params}, ParameterError);
}

}  // namespace
}  // namespace fail_aware
