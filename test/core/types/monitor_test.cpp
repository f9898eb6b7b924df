#include "fail_aware_lidar_odometry/monitor.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

namespace fail_aware::monitor_test {
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
  EXPECT_EQ(reasonText(kReasonTimeFieldRefused | kReasonWeakRoadAhead), "TIME_FIELD_REFUSED|WEAK_ROAD_AHEAD");
  EXPECT_EQ(reasonText(kReasonPointTimesContradicted), "POINT_TIMES_CONTRADICTED");
  EXPECT_EQ(reasonText(kReasonFrozenCloud | (1u << 31)), "FROZEN_CLOUD|BIT_31");
  EXPECT_EQ(reasonText(kReasonNoMeasurement | kReasonPredictionOnly | kReasonPredictionOverruled |
                       kReasonMeasurementsDisagree | kReasonWeakDirection | kReasonSweepIncomplete | kReasonSweepEmpty |
                       kReasonMissingIcpPoint | kReasonMissingIcpPlane | kReasonEtaThreshold | kReasonCovarianceLimit |
                       kReasonTimeJump | kReasonDroppedSweeps),
            "NO_MEASUREMENT|PREDICTION_ONLY|PREDICTION_OVERRULED|MEASUREMENTS_DISAGREE|WEAK_DIRECTION|SWEEP_INCOMPLETE|"
            "SWEEP_EMPTY|MISSING_ICP_POINT|MISSING_ICP_PLANE|ETA_THRESHOLD|COVARIANCE_LIMIT|TIME_JUMP|DROPPED_SWEEPS");
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void expectIs(const TimeToFailure& t, TimeToFailureStatus status, double seconds) {
  EXPECT_EQ(t.status, status) << toString(t.status);
  EXPECT_EQ(t.seconds, seconds);
}

TEST(TimeToFailure, FromSecondsAtItsEdges) {
  expectIs(TimeToFailure::fromSeconds(5.0, 30.0), TimeToFailureStatus::kWithinHorizon, 5.0);
  expectIs(TimeToFailure::fromSeconds(0.0, 30.0), TimeToFailureStatus::kReached, 0.0);
  expectIs(TimeToFailure::fromSeconds(-3.0, 30.0), TimeToFailureStatus::kReached, 0.0);
  expectIs(TimeToFailure::fromSeconds(-kInfinity, 30.0), TimeToFailureStatus::kReached, 0.0);
  expectIs(TimeToFailure::fromSeconds(30.0, 30.0), TimeToFailureStatus::kBeyondHorizon, 30.0);
  expectIs(TimeToFailure::fromSeconds(kInfinity, 30.0), TimeToFailureStatus::kBeyondHorizon, 30.0);
  expectIs(TimeToFailure::fromSeconds(kNan, 30.0), TimeToFailureStatus::kUnknown, -1.0);
  expectIs(TimeToFailure::fromSeconds(1.0, kNan), TimeToFailureStatus::kUnknown, -1.0);
}

TEST(TimeToFailure, CombinationIsTheEarlierOfTheKnown) {
  const TimeToFailure unknown = TimeToFailure::unknown();
  const TimeToFailure reached = TimeToFailure::reached();
  const TimeToFailure five = TimeToFailure::fromSeconds(5.0, 30.0);
  const TimeToFailure eight = TimeToFailure::fromSeconds(8.0, 30.0);
  const TimeToFailure beyond = TimeToFailure::fromSeconds(99.0, 30.0);
  const TimeToFailure thirty_of_sixty = TimeToFailure::fromSeconds(30.0, 60.0);
  const TimeToFailure beyond_sixty = TimeToFailure::fromSeconds(99.0, 60.0);
  expectIs(combine(unknown, unknown), TimeToFailureStatus::kUnknown, -1.0);
  for (const TimeToFailure& known : {reached, five, beyond}) {
    expectIs(combine(unknown, known), known.status, known.seconds);
    expectIs(combine(known, unknown), known.status, known.seconds);
    expectIs(combine(reached, known), TimeToFailureStatus::kReached, 0.0);
  }
  expectIs(combine(eight, five), TimeToFailureStatus::kWithinHorizon, 5.0);
  expectIs(combine(five, beyond), TimeToFailureStatus::kWithinHorizon, 5.0);
  expectIs(combine(beyond, thirty_of_sixty), TimeToFailureStatus::kWithinHorizon, 30.0);
  expectIs(combine(thirty_of_sixty, beyond), TimeToFailureStatus::kWithinHorizon, 30.0);
  expectIs(combine(beyond_sixty, beyond), TimeToFailureStatus::kBeyondHorizon, 30.0);
}

}  // namespace
}  // namespace fail_aware::monitor_test
