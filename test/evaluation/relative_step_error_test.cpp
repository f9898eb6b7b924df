#include "evaluation/relative_step_error.hpp"

#include <gtest/gtest.h>

#include "core/io/input_error.hpp"
#include "trajectory_poses.hpp"

namespace fail_aware::relative_step_error_test {
namespace {

TEST(RelativeStepError, OneBadStepByHand) {
  const std::vector<Pose> truth = {at(0, 0), at(1, 0), at(2, 0), at(3, 0), at(4, 0)};
  std::vector<Pose> estimate = truth;
  // the second step is 0.2 m too long and ends turned by 0.1 rad; all others are right
  for (std::size_t i = 2; i < 5; ++i) estimate[i] = at(2.2, 0, 0, 0.1) * at(static_cast<double>(i) - 2.0, 0);
  const RelativeStepError error = relativeStepError(truth, moved(someMotion(), estimate));
  EXPECT_NEAR(error.translation_rmse_m, 0.2 / 2.0, 1e-9);
  EXPECT_NEAR(error.rotation_rmse_rad, 0.1 / 2.0, 1e-9);
}

TEST(RelativeStepError, NeedsAStepAndEqualCounts) {
  EXPECT_THROW(relativeStepError({at(0, 0)}, {at(0, 0)}), InputError);
  EXPECT_THROW(relativeStepError({at(0, 0), at(1, 0)}, {at(0, 0)}), InputError);
}

}  // namespace
}  // namespace fail_aware::relative_step_error_test
