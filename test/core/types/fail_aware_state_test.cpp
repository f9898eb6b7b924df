#include "fail_aware_lidar_odometry/monitor.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fail_aware {
namespace {

TEST(FailAwareState, EveryStateHasItsOwnName) {
  std::set<std::string> names;
  for (const FailAwareState state : {FailAwareState::kUnknown, FailAwareState::kOk, FailAwareState::kDegraded,
                                     FailAwareState::kFailing, FailAwareState::kFailed}) {
    names.insert(toString(state));
  }
  EXPECT_EQ(names, (std::set<std::string>{"UNKNOWN", "OK", "DEGRADED", "FAILING", "FAILED"}));
}

TEST(ReasonText, NamesJoined) {
  EXPECT_EQ(reasonText(0), "");
  EXPECT_EQ(reasonText(kReasonStale), "STALE");
  EXPECT_EQ(reasonText(kReasonStale | kReasonMissingCorners | kReasonLowVisibility),
            "STALE|MISSING_CORNERS|LOW_VISIBILITY");
  EXPECT_EQ(reasonText(kReasonTimeFieldRefused), "TIME_FIELD_REFUSED");
  EXPECT_EQ(reasonText(kReasonFrozenCloud | (1u << 31)), "FROZEN_CLOUD|BIT_31");
  EXPECT_EQ(reasonText(kReasonNoMeasurement | kReasonPredictionOnly | kReasonPredictionOverruled |
                       kReasonMeasurementsDisagree | kReasonWeakDirection | kReasonSweepIncomplete | kReasonSweepEmpty |
                       kReasonMissingIcpPoint | kReasonMissingIcpPlane | kReasonEtaThreshold | kReasonCovarianceLimit |
                       kReasonTimeJump | kReasonDroppedSweeps),
            "NO_MEASUREMENT|PREDICTION_ONLY|PREDICTION_OVERRULED|MEASUREMENTS_DISAGREE|WEAK_DIRECTION|SWEEP_INCOMPLETE|"
            "SWEEP_EMPTY|MISSING_ICP_POINT|MISSING_ICP_PLANE|ETA_THRESHOLD|COVARIANCE_LIMIT|TIME_JUMP|DROPPED_SWEEPS");
}

}  // namespace
}  // namespace fail_aware
