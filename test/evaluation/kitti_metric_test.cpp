#include "evaluation/kitti_metric.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/io/input_error.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware::kitti_metric_test {
namespace {

// A hair over 1 m, so that 100 steps exceed 100 m and the segment is as long as its name says.
constexpr double kStep_m = 1.0 + 1e-12;

Pose at(double x, double y = 0.0, double yaw_rad = 0.0) {
  Pose T = Pose::Identity();
  T.translation() << x, y, 0.0;
  T.linear() = rotationFromRpy(0.0, 0.0, yaw_rad);
  return T;
}

std::vector<Pose> alongX(const std::vector<double>& xs) {
  std::vector<Pose> poses;
  for (const double x : xs) poses.push_back(at(x));
  return poses;
}

std::vector<Pose> straight(int poses, double step_m) {
  std::vector<double> xs;
  for (int i = 0; i < poses; ++i) xs.push_back(i * step_m);
  return alongX(xs);
}

TEST(KittiMetric, OnePercentOfScaleIsOnePercent) {
  const KittiMetric metric = kittiMetric(straight(1001, kStep_m), straight(1001, 1.01 * kStep_m));
  EXPECT_NEAR(metric.total.t_err_percent, 1.0, 1e-9);
  EXPECT_NEAR(metric.total.r_err_deg_per_m, 0.0, 1e-12);
  ASSERT_EQ(metric.per_length.size(), 8u);
  std::size_t segments = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    // starts 0, 10, ... with start + 100 (k + 1) <= 1000
    EXPECT_EQ(metric.per_length[k].segments, 101 - 10 * (k + 1));
    EXPECT_NEAR(metric.per_length[k].t_err_percent, 1.0, 1e-9);
    segments += metric.per_length[k].segments;
  }
  EXPECT_EQ(metric.total.segments, segments);
}

TEST(KittiMetric, ErrorIsDividedByTheNominalLength) {
  // 1 m steps: the first distance that exceeds 100 m is 101 m
  const KittiMetric metric = kittiMetric(straight(102, 1.0), straight(102, 1.01));
  EXPECT_EQ(metric.total.segments, 1u);
  EXPECT_NEAR(metric.total.t_err_percent, 1.01, 1e-9);
}

TEST(KittiMetric, ConstantHeadingRateErrorHasAClosedForm) {
  const double turn_rad = 1e-3;  // the estimate turns so much after every step, the truth not at all
  std::vector<Pose> estimate = {Pose::Identity()};
  while (estimate.size() < 301) estimate.push_back(estimate.back() * at(kStep_m, 0.0, turn_rad));
  const KittiMetric metric = kittiMetric(straight(301, kStep_m), estimate);

  for (const int length : {100, 200, 300}) {
    const std::complex<double> i(0.0, 1.0);
    const std::complex<double> end = (std::exp(i * (turn_rad * length)) - 1.0) / (std::exp(i * turn_rad) - 1.0);
    const KittiMetric::Average& average = metric.per_length[static_cast<std::size_t>(length / 100 - 1)];
    EXPECT_NEAR(average.t_err_percent, 100.0 * std::abs(end - double(length)) / length, 1e-8);
    EXPECT_NEAR(average.r_err_deg_per_m, turn_rad / kDegree, 1e-9);
  }
  EXPECT_EQ(metric.per_length[3].segments, 0u);
}

TEST(KittiMetric, SegmentEndsAtTheFirstPoseThatExceedsTheLength) {
  const std::vector<double> distances_m = {0, 2, 5, 5, 9, 10};
  EXPECT_EQ(segmentEnd(distances_m, 0, 5.0), 4u);            // 5 does not exceed 5
  EXPECT_EQ(segmentEnd(distances_m, 0, 4.9), 2u);            // the first of the two at 5
  EXPECT_EQ(segmentEnd(distances_m, 1, 5.0), 4u);            // 9 > 7
  EXPECT_EQ(segmentEnd(distances_m, 2, 4.5), 5u);            // 10 > 9.5
  EXPECT_EQ(segmentEnd(distances_m, 2, 5.0), std::nullopt);  // 10 does not exceed 10
  EXPECT_EQ(segmentEnd(distances_m, 5, 0.5), std::nullopt);
}

TEST(KittiMetric, SegmentsCountedByHand) {
  // from 0: 3 m ends at 5 (error 0.1), from 2 at 9 (0), from 5 at 9 (-0.1); 6 m: from 0 at 9 (0), from 2 at 9 (0)
  const std::vector<Pose> truth = alongX({0, 2, 5, 9});
  const std::vector<Pose> estimate = alongX({0, 2, 5.1, 9});
  const KittiMetric metric = kittiMetric(truth, estimate, {{3, 6}, 1});
  ASSERT_EQ(metric.per_length.size(), 2u);
  EXPECT_EQ(metric.per_length[0].segments, 3u);
  EXPECT_EQ(metric.per_length[1].segments, 2u);
  EXPECT_NEAR(metric.per_length[0].t_err_percent, 100.0 * (0.1 + 0.1) / 3 / 3, 1e-9);
  EXPECT_NEAR(metric.per_length[1].t_err_percent, 0.0, 1e-9);
  EXPECT_NEAR(metric.total.t_err_percent, 100.0 * (0.1 + 0.1) / 3 / 5,
              1e-9);  // a segment, not a length, is what counts
}

TEST(KittiMetric, StartsAreEveryStepthPose) {
  const KittiMetric metric = kittiMetric(straight(21, 1.0), straight(21, 1.0), {{4.5}, 7});
  EXPECT_EQ(metric.total.segments, 3u);  // 0, 7, 14; from 14 it ends at 19
}

TEST(KittiMetric, CreepWhileStandingStill) {
  // 50 m of driving, 20 poses of standing, 50 m of driving; the estimate creeps 3 mm a pose while standing
  std::vector<double> true_x, estimated_x;
  for (int i = 0; i <= 120; ++i) {
    const int standing = std::min(std::max(i - 50, 0), 20);
    true_x.push_back(i - standing);
    estimated_x.push_back(i - standing + 0.003 * standing);
  }
  const KittiMetric metric = kittiMetric(alongX(true_x), alongX(estimated_x), {{5}, 1});
  EXPECT_EQ(metric.total.segments, 115u);  // up to the start at 94 m, the 115th pose
  // the five starts at 45..49 m see all of the creep; the start after k of 20 standing poses sees 20 - k of it
  const double sum = (5 * 0.06 + 0.003 * 210) / 5.0;
  EXPECT_NEAR(metric.total.t_err_percent, 100.0 * sum / 115.0, 1e-9);
}

TEST(KittiMetric, StandingStillAllTheTimeHasNoSegments) {
  const std::vector<Pose> poses(50, at(3.0));
  const KittiMetric metric = kittiMetric(poses, poses, KittiMetric::Params::forShortRuns());
  EXPECT_EQ(metric.total.segments, 0u);
  EXPECT_EQ(metric.total.t_err_percent, 0.0);
}

TEST(KittiMetric, RunShorterThanOneHundredMetres) {
  const std::vector<Pose> truth = straight(91, kStep_m);
  const std::vector<Pose> estimate = straight(91, 0.98 * kStep_m);
  EXPECT_EQ(kittiMetric(truth, estimate).total.segments, 0u);
  const KittiMetric metric = kittiMetric(truth, estimate, KittiMetric::Params::forShortRuns());
  EXPECT_EQ(metric.total.segments, 86u + 81u + 71u + 51u + 11u);
  EXPECT_NEAR(metric.total.t_err_percent, 2.0, 1e-9);
}

TEST(KittiMetric, DoesNotDependOnWhereTheTrajectoriesBegin) {
  std::vector<Pose> truth, estimate;
  for (int i = 0; i < 200; ++i) {
    truth.push_back(at(i, 5.0 * std::sin(0.05 * i), 0.25 * std::cos(0.05 * i)));
    estimate.push_back(at(1.02 * i, 5.1 * std::sin(0.05 * i), 0.26 * std::cos(0.05 * i)));
  }
  const KittiMetric before = kittiMetric(truth, estimate);
  for (Pose& T : truth) T = at(7, -3, 2.0) * T;
  for (Pose& T : estimate) T = at(-100, 50, -1.0) * T;
  const KittiMetric after = kittiMetric(truth, estimate);
  EXPECT_GT(before.total.t_err_percent, 1.0);
  EXPECT_NEAR(after.total.t_err_percent, before.total.t_err_percent, 1e-9);
  EXPECT_NEAR(after.total.r_err_deg_per_m, before.total.r_err_deg_per_m, 1e-9);
}

TEST(KittiMetric, UnequalCountsAreRefusedWithBoth) {
  try {
    kittiMetric(straight(271, 1.0), straight(270, 1.0));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("271"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("270"), std::string::npos);
  }
  EXPECT_THROW(kittiMetric(straight(1, 1.0), straight(1, 1.0)), InputError);
}

TEST(KittiMetric, BadParametersAreRefused) {
  const std::vector<Pose> poses = straight(3, 1.0);
  EXPECT_THROW(kittiMetric(poses, poses, {{}, 1}), ParameterError);
  EXPECT_THROW(kittiMetric(poses, poses, {{1.0, 0.0}, 1}), ParameterError);
  EXPECT_THROW(kittiMetric(poses, poses, {{NAN}, 1}), ParameterError);
  EXPECT_THROW(kittiMetric(poses, poses, {{1.0}, 0}), ParameterError);
}

}  // namespace
}  // namespace fail_aware::kitti_metric_test
