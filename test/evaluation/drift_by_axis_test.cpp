#include "evaluation/drift_by_axis.hpp"

#include <gtest/gtest.h>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/io/input_error.hpp"

namespace fail_aware::drift_by_axis_test {
namespace {

constexpr double kHeading = 0.7;  // rad: of the whole drive, in the trajectories' frame

/// 201 poses, 1 m apart; `drift`: x y z of the vehicle's axes in m and roll pitch yaw in rad, a metre.
std::vector<Pose> drive(const Vector6d& drift) {
  std::vector<Pose> poses;
  Pose T = Pose::Identity();
  T.linear() = rotationFromRpy(0.0, 0.0, kHeading);
  Pose step = Pose::Identity();
  step.translation() = Eigen::Vector3d(1.0 + 1e-12, 0.0, 0.0) + drift.head<3>();
  step.linear() = rotationFromRpy(drift[3], drift[4], drift[5]);
  for (int i = 0; i <= 200; ++i, T = T * step) poses.push_back(T);
  return poses;
}

DriftByAxis over100m(const Vector6d& drift) {
  KittiMetric::Params params;
  params.lengths_m = {100.0};
  return driftByAxis(drive(Vector6d::Zero()), drive(drift), params).front();
}

TEST(DriftByAxis, TranslationsAreThoseOfTheSegmentsFirstPose) {
  Vector6d drift = Vector6d::Zero();
  drift.head<3>() << -0.01, 0.02, -0.03;
  const DriftByAxis error = over100m(drift);
  EXPECT_EQ(error.segments, 11u);
  EXPECT_NEAR(error.along_percent, 1.0, 1e-9);
  EXPECT_NEAR(error.across_percent, 2.0, 1e-9);
  EXPECT_NEAR(error.up_percent, 3.0, 1e-9);
  EXPECT_NEAR(error.pitch_deg_per_m, 0.0, 1e-12);
}

TEST(DriftByAxis, EachRotationHasItsOwnAngle) {
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d drift = Vector6d::Zero();
    drift[3 + axis] = -0.002 * kDegree;
    const DriftByAxis error = over100m(drift);
    const double angles[] = {error.roll_deg_per_m, error.pitch_deg_per_m, error.yaw_deg_per_m};
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(angles[i], i == axis ? 0.002 : 0.0, 1e-9) << axis << i;
  }
}

TEST(DriftByAxis, PitchMovesItUpAndYawAcross) {
  Vector6d pitch = Vector6d::Zero(), yaw = Vector6d::Zero();
  pitch[4] = yaw[5] = 0.002 * kDegree;
  EXPECT_NEAR(over100m(pitch).up_percent, 0.5 * 0.2 * kDegree * 100.0, 0.01);
  EXPECT_NEAR(over100m(yaw).across_percent, 0.5 * 0.2 * kDegree * 100.0, 0.01);
}

TEST(DriftByAxis, TooShortIsNoSegment) {
  const std::vector<DriftByAxis> errors = driftByAxis(drive(Vector6d::Zero()), drive(Vector6d::Zero()));
  ASSERT_EQ(errors.size(), 8u);
  EXPECT_EQ(errors[7].segments, 0u);
  EXPECT_EQ(errors[7].up_percent, 0.0);
  EXPECT_THROW(driftByAxis(drive(Vector6d::Zero()), {}), InputError);
}

}  // namespace
}  // namespace fail_aware::drift_by_axis_test
