#include "core/registration/corner_svd/corner_svd.hpp"

#include <gtest/gtest.h>

#include "../../../support/synthetic_street.hpp"

namespace fail_aware::corner_svd_test {
namespace {

/// With the corners of one sweep in the reference.
CornerSvd withReference() {
  CornerExtractor::Params extraction;
  extraction.min_points_near_corner = 5;  // the street's lidar has a tenth of the columns of a real one
  CornerSvd corners(extraction, CornerReference::Params(), CornerAlignment());
  synthetic::Lidar lidar;
  lidar.rolling_shutter = false;
  lidar.columns = 1000;
  CorrectedSweep sweep;
  sweep.points_lidar =
      synthetic::Street().scan([](double) -> Pose { return Pose::Identity(); }, 0.0, 1, lidar).points_lidar;
  SweepPrediction prediction;
  prediction.motion_status = MotionStatus::kObserved;
  corners.measure(sweep, prediction, lidar.T_base_lidar);
  FilterState state;
  state.map_update = MapUpdate::kInsert;
  corners.place(state);
  return corners;
}

TEST(CornerSvd, SkippedSweepKeepsTheReference) {
  CornerSvd corners = withReference();
  ASSERT_FALSE(corners.referenceOdom().empty());
  FilterState state;
  state.map_update = MapUpdate::kInsert;
  corners.skip(state);
  EXPECT_FALSE(corners.referenceOdom().empty());
}

TEST(CornerSvd, RestartOnASkippedSweepClearsTheReference) {
  CornerSvd corners = withReference();
  FilterState state;
  state.map_update = MapUpdate::kRestart;
  corners.skip(state);
  EXPECT_TRUE(corners.referenceOdom().empty());
}

TEST(CornerSvd, AnotherOdomOnASkippedSweepClearsTheReference) {
  CornerSvd corners = withReference();
  FilterState state;
  state.odom_reset_count = 1;
  corners.skip(state);
  EXPECT_TRUE(corners.referenceOdom().empty());
}

}  // namespace
}  // namespace fail_aware::corner_svd_test
