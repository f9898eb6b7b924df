#include "core/estimation/vehicle/road_plane.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/geometry/rotation.hpp"

namespace fail_aware::road_plane_test {
namespace {

Vector6d standing(const RoadPlane& road, double yaw) {
  Vector6d state;
  state << 0.0, 0.0, 0.0, road.rollPitch(yaw), yaw;
  return state;
}

RoadPlane plane(double slope_x, double slope_y) {
  RoadPlane road;
  road.valid = true;
  road.slope << slope_x, slope_y;
  return road;
}

TEST(RoadPlane, RollAndPitchStandOnThePlane) {
  const RoadPlane road = plane(0.1, -0.05);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, 0.05, 1.0).normalized();
  for (double yaw = -3.0; yaw < 3.1; yaw += 0.5) {
    const Eigen::Vector2d roll_pitch = road.rollPitch(yaw);
    EXPECT_LT((rotationFromRpy(roll_pitch[0], roll_pitch[1], yaw).col(2) - normal).norm(), 1e-12);
  }
  EXPECT_LT(plane(0.1, 0.0).rollPitch(0.0)[1], 0.0) << "uphill is nose up, negative pitch";
}

TEST(RoadPlane, TurningOnASlopeChangesNothing) {
  RoadPlaneEstimator estimator{VehicleParameters()};
  const RoadPlane truth = plane(0.12, 0.03);
  for (int i = 0; i < 50; ++i) estimator.update(0.1 * i, standing(truth, 0.1 * i), MotionDerivatives());
  EXPECT_LT((estimator.plane().slope - truth.slope).norm(), 1e-12);
  EXPECT_LT(estimator.plane().slope_rate_per_s.norm(), 1e-12);
}

TEST(RoadPlane, FollowsASteadilyChangingSlopeWithoutLag) {
  RoadPlaneEstimator estimator{VehicleParameters()};
  double t = 0.0;
  for (int i = 0; i < 100; ++i) {
    t += i % 3 == 0 ? 0.15 : 0.08;
    estimator.update(t, standing(plane(0.02 * t, 0.0), 0.0), MotionDerivatives());
  }
  EXPECT_NEAR(estimator.plane().slope.x(), 0.02 * t, 1e-4);
  EXPECT_NEAR(estimator.plane().slope_rate_per_s.x(), 0.02, 1e-3);
}

TEST(RoadPlane, SteadyBrakingAndCorneringAreNotTakenForASlope) {
  const VehicleParameters vehicle;
  RoadPlaneEstimator estimator{vehicle};
  MotionDerivatives motion;
  motion.valid = true;
  motion.velocity_body_mps.x() = 10.0;
  motion.acceleration_body_mps2.x() = -5.0;
  motion.rpy_rates_rad_s.z() = 0.3;
  const Eigen::Vector2d resting = restingRollPitch(rollAxis(vehicle), pitchAxis(vehicle), motion);
  EXPECT_GT(resting[0], 0.0) << "a left turn leans to the right";
  EXPECT_GT(resting[1], 0.0) << "braking is nose down";
  Vector6d state = Vector6d::Zero();
  state.segment<2>(3) = resting;
  for (int i = 0; i < 30; ++i) estimator.update(0.1 * i, state, motion);
  EXPECT_LT(estimator.plane().slope.norm(), 1e-12);
}

TEST(RoadPlane, IgnoresWhatItCannotUse) {
  RoadPlaneEstimator estimator{VehicleParameters()};
  Vector6d state = Vector6d::Zero();
  estimator.update(1.0, state, MotionDerivatives());
  state[4] = 0.1;
  estimator.update(1.0, state, MotionDerivatives());
  state[4] = 1.3;
  estimator.update(1.1, state, MotionDerivatives());
  state[4] = std::numeric_limits<double>::quiet_NaN();
  estimator.update(1.2, state, MotionDerivatives());
  EXPECT_TRUE(estimator.plane().valid);
  EXPECT_TRUE(estimator.plane().slope.isZero()) << "of the first estimate alone";
  estimator.clear();
  EXPECT_FALSE(estimator.plane().valid);
}

TEST(RoadPlane, TurnsWithOdom) {
  RoadPlaneEstimator estimator{VehicleParameters()}, expected = estimator;
  const double turn_rad = 0.7;
  for (int i = 0; i < 20; ++i) {
    const double pitch = -0.05 - 0.002 * i, yaw = 0.4;
    Vector6d state = Vector6d::Zero();
    state.tail<3>() << 0.03, pitch, yaw;
    estimator.update(0.1 * i, state, MotionDerivatives());
    state[5] += turn_rad;
    expected.update(0.1 * i, state, MotionDerivatives());
  }
  estimator.turn(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  EXPECT_LT((estimator.plane().slope - expected.plane().slope).norm(), 1e-12);
  EXPECT_LT((estimator.plane().slope_rate_per_s - expected.plane().slope_rate_per_s).norm(), 1e-12);
  estimator.turn(Eigen::AngleAxisd(1.4, Eigen::Vector3d::UnitX()).toRotationMatrix());
  EXPECT_FALSE(estimator.plane().valid) << "a wall is no road";
}

}  // namespace
}  // namespace fail_aware::road_plane_test
