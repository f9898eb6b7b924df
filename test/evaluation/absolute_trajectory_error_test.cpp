#include "evaluation/absolute_trajectory_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/io/input_error.hpp"
#include "trajectory_poses.hpp"

namespace fail_aware::absolute_trajectory_error_test {
namespace {

std::vector<Pose> curve() {
  std::vector<Pose> poses;
  for (int i = 0; i < 40; ++i) {
    poses.push_back(at(i, std::sin(0.2 * i), 0.1 * std::cos(0.3 * i), 0.2 * std::cos(0.2 * i)));
  }
  return poses;
}

TEST(AbsoluteTrajectoryError, RigidMotionOfTheWholeIsNoError) {
  const std::vector<Pose> truth = curve();
  const std::vector<Pose> estimate = moved(someMotion(), truth);
  for (const Pose& T : {firstPoseAlignment(truth, estimate), bestAlignment(truth, estimate)}) {
    EXPECT_TRUE(T.isApprox(someMotion().inverse(), 1e-9));
    const AbsoluteTrajectoryError error = absoluteTrajectoryError(truth, estimate, T);
    EXPECT_NEAR(error.max_m, 0.0, 1e-9);
    EXPECT_NEAR(error.yaw_rmse_rad, 0.0, 1e-9);
  }
}

TEST(AbsoluteTrajectoryError, OneStrayPoseByHand) {
  const std::vector<Pose> truth = {at(0, 0), at(1, 0), at(2, 0)};
  const std::vector<Pose> estimate = {at(0, 0), at(1.3, 0), at(2, 0)};
  const AbsoluteTrajectoryError first = absoluteTrajectoryError(truth, estimate, firstPoseAlignment(truth, estimate));
  EXPECT_NEAR(first.rmse_m, 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(first.mean_m, 0.1, 1e-12);
  EXPECT_NEAR(first.max_m, 0.3, 1e-12);
  // the best alignment shifts by the mean, 0.1: errors 0.1, 0.2, 0.1
  const AbsoluteTrajectoryError best = absoluteTrajectoryError(truth, estimate, bestAlignment(truth, estimate));
  EXPECT_NEAR(best.rmse_m, std::sqrt(0.06 / 3.0), 1e-9);
  EXPECT_NEAR(best.mean_m, 0.4 / 3.0, 1e-9);
  EXPECT_NEAR(best.max_m, 0.2, 1e-9);
  EXPECT_NEAR(best.yaw_rmse_rad, 0.0, 1e-9);
  ASSERT_EQ(best.position_error_m.size(), 3u);
  EXPECT_NEAR(best.position_error_m[1], 0.2, 1e-9);
}

TEST(AbsoluteTrajectoryError, ScaleIsNotForgiven) {
  const std::vector<Pose> truth = {at(-1, 0), at(0, 2), at(1, 0), at(0, -2)};
  const std::vector<Pose> estimate = {at(-1.1, 0), at(0, 2.2), at(1.1, 0), at(0, -2.2)};
  const AbsoluteTrajectoryError best = absoluteTrajectoryError(truth, estimate, bestAlignment(truth, estimate));
  EXPECT_NEAR(best.rmse_m, std::sqrt((2 * 0.01 + 2 * 0.04) / 4.0), 1e-9);
}

TEST(AbsoluteTrajectoryError, YawIsThatOfTheMovingFrame) {
  const std::vector<Pose> truth = curve();
  std::vector<Pose> estimate = moved(someMotion(), truth);
  for (std::size_t i = 1; i < estimate.size(); ++i) estimate[i] = estimate[i] * at(0, 0, 0, i % 2 == 0 ? 0.05 : -0.05);
  const AbsoluteTrajectoryError error = absoluteTrajectoryError(truth, estimate, firstPoseAlignment(truth, estimate));
  EXPECT_NEAR(error.rmse_m, 0.0, 1e-9);
  EXPECT_NEAR(error.yaw_rmse_rad, 0.05 * std::sqrt(39.0 / 40.0), 1e-9);
}

TEST(AbsoluteTrajectoryError, BestAlignmentIsNeverAReflection) {
  const std::vector<Pose> truth = {at(1, 0, 0), at(0, 1, 0), at(0, 0, 1), at(0, 0, 0)};
  const std::vector<Pose> mirrored = {at(-1, 0, 0), at(0, 1, 0), at(0, 0, 1), at(0, 0, 0)};
  EXPECT_NEAR(bestAlignment(truth, mirrored).linear().determinant(), 1.0, 1e-9);
}

TEST(AbsoluteTrajectoryError, StandingStillIsFinite) {
  const std::vector<Pose> poses(10, at(4, 5));
  const AbsoluteTrajectoryError error = absoluteTrajectoryError(poses, poses, bestAlignment(poses, poses));
  EXPECT_NEAR(error.rmse_m, 0.0, 1e-9);
  EXPECT_TRUE(std::isfinite(error.yaw_rmse_rad));
}

TEST(AbsoluteTrajectoryError, UnequalCountsAreRefused) {
  const std::vector<Pose> truth = curve();
  EXPECT_THROW(bestAlignment(truth, {truth[0]}), InputError);
  EXPECT_THROW(firstPoseAlignment({}, {}), InputError);
}

}  // namespace
}  // namespace fail_aware::absolute_trajectory_error_test
