#include "core/integrity/failure_state.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "../parameters/error_of.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::failure_state_test {
namespace {

using State = FailAwareState;

constexpr FailureThresholds kThresholds{2.0, 3.0, 10.0};

State stateAt(double seconds, std::uint32_t reasons = 0, double speed_mps = 0.0) {
  const TimeToFailure time = TimeToFailure::fromSeconds(seconds, 60.0);
  return stateFor(time, time, kThresholds, reasons, speed_mps);
}

State unknownWith(std::uint32_t reasons) {
  return stateFor(TimeToFailure::unknown(), TimeToFailure::unknown(), FailureThresholds(), reasons, 10.0);
}

TEST(StateFor, ExactlyAtTheBoundaries) {
  EXPECT_EQ(stateAt(0.0), State::kFailed);
  EXPECT_EQ(stateAt(std::numeric_limits<double>::min()), State::kFailing);
  EXPECT_EQ(stateAt(3.0), State::kFailing);
  EXPECT_EQ(stateAt(std::nextafter(3.0, 4.0)), State::kDegraded);
  EXPECT_EQ(stateAt(10.0), State::kDegraded);
  EXPECT_EQ(stateAt(std::nextafter(10.0, 11.0)), State::kOk);
  EXPECT_EQ(stateAt(1000.0), State::kOk);
  EXPECT_EQ(unknownWith(0), State::kUnknown);
}

TEST(StateFor, AStopFromThePresentSpeedMustFitInTheTimeThatIsLeft) {
  EXPECT_EQ(stateAt(3.0, 0, 6.0), State::kFailing) << "a stop of 3 s";
  EXPECT_EQ(stateAt(std::nextafter(3.0, 4.0), 0, 6.0), State::kDegraded);
  EXPECT_EQ(stateAt(12.5, 0, 25.0), State::kFailing) << "a stop of 12.5 s";
  EXPECT_EQ(stateAt(std::nextafter(12.5, 13.0), 0, 25.0), State::kDegraded);
  EXPECT_EQ(stateAt(25.0, 0, 25.0), State::kDegraded) << "twice as long";
  EXPECT_EQ(stateAt(std::nextafter(25.0, 26.0), 0, 25.0), State::kOk);
  EXPECT_EQ(stateAt(12.5, 0, -25.0), State::kFailing) << "reversing";
}

TEST(StateFor, NoFailureBeforeTheHorizonIsOkAtAnySpeed) {
  EXPECT_EQ(stateAt(60.0, 0, 200.0), State::kOk);
  EXPECT_EQ(stateAt(59.0, 0, 200.0), State::kFailing);
}

TEST(StateFor, FailedActsOnTheAlarmsTimeAllElseOnTheFailures) {
  const auto state = [](double alarm_s, double failure_s) {
    return stateFor(TimeToFailure::fromSeconds(alarm_s, 60.0), TimeToFailure::fromSeconds(failure_s, 60.0), kThresholds,
                    0, 0.0);
  };
  EXPECT_EQ(state(20.0, 11.0), State::kOk);
  EXPECT_EQ(state(20.0, 10.0), State::kDegraded);
  EXPECT_EQ(state(20.0, 3.0), State::kFailing);
  EXPECT_EQ(state(20.0, 0.0), State::kFailing) << "possible by now, not probable";
  EXPECT_EQ(state(0.0, 0.0), State::kFailed);
}

TEST(StateFor, Reasons) {
  EXPECT_EQ(stateAt(50.0, kReasonStale), State::kFailed);
  EXPECT_EQ(unknownWith(kReasonStale), State::kFailed);
  EXPECT_EQ(stateAt(50.0, kReasonFrozenCloud), State::kFailing);
  EXPECT_EQ(stateAt(0.0, kReasonFrozenCloud), State::kFailed);
  EXPECT_EQ(unknownWith(kReasonFrozenCloud), State::kFailing);
  EXPECT_EQ(stateAt(50.0, kReasonPredictionOnly), State::kDegraded);
  EXPECT_EQ(stateAt(50.0, kReasonTimeFieldRefused), State::kDegraded);
  EXPECT_EQ(stateAt(50.0, kReasonPointTimesContradicted), State::kDegraded);
  EXPECT_EQ(stateAt(2.0, kReasonPredictionOnly), State::kFailing);
  EXPECT_EQ(unknownWith(kReasonPredictionOnly), State::kUnknown);
  EXPECT_EQ(stateAt(50.0, kReasonMissingCorners | kReasonEtaThreshold | kReasonCovarianceLimit), State::kOk);
  EXPECT_EQ(stateAt(50.0, kReasonWeakRoadAhead), State::kOk) << "the time tells what it costs";
}

TEST(StateHysteresis, WorseAtOnceBetterOnlyAfterARow) {
  StateHysteresis hysteresis(3);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kOk);
  EXPECT_EQ(hysteresis.update(State::kFailing), State::kFailing);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kFailing);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kFailing);
  EXPECT_EQ(hysteresis.update(State::kFailing), State::kFailing);  // the row begins anew
  EXPECT_EQ(hysteresis.update(State::kOk), State::kFailing);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kFailing);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kOk);
  EXPECT_EQ(hysteresis.update(State::kFailed), State::kFailed);
}

TEST(StateHysteresis, RecoversToTheWorstOfTheRow) {
  StateHysteresis hysteresis(3);
  hysteresis.update(State::kFailed);
  hysteresis.update(State::kOk);
  hysteresis.update(State::kDegraded);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kDegraded);
  hysteresis.update(State::kOk);
  hysteresis.update(State::kOk);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kOk);
}

TEST(StateHysteresis, Unknown) {
  StateHysteresis hysteresis(2);
  EXPECT_EQ(hysteresis.update(State::kFailed), State::kFailed);   // unknown is left at once
  EXPECT_EQ(hysteresis.update(State::kUnknown), State::kFailed);  // but does not hide a failure at once
  EXPECT_EQ(hysteresis.update(State::kUnknown), State::kUnknown);
  EXPECT_EQ(hysteresis.update(State::kOk), State::kOk);
  EXPECT_EQ(hysteresis.update(State::kUnknown), State::kUnknown);
  EXPECT_EQ(hysteresis.update(State::kDegraded), State::kDegraded);
  EXPECT_EQ(hysteresis.update(State::kUnknown), State::kUnknown) << "not available is worse than degraded";
  hysteresis.update(State::kFailing);
  hysteresis.reset();
  EXPECT_EQ(hysteresis.update(State::kDegraded), State::kDegraded) << "unknown again, which is left at once";
}

TEST(FailureState, ParametersAreChecked) {
  EXPECT_THROW(validate(FailureThresholds{2.0, 5.0, 4.0}), ParameterError);
  EXPECT_THROW(validate(FailureThresholds{2.0, -1.0, 4.0}), ParameterError);
  EXPECT_THROW(validate(FailureThresholds{0.0, 4.0, 4.0}), ParameterError);
  EXPECT_NO_THROW((validate(FailureThresholds{2.0, 4.0, 4.0})));
  EXPECT_EQ(errorOf([] {
              validate(FailureThresholds{2.0, 5.0, 4.0});
            }),
            "degraded_s = 4: must be finite and >= failing_s, which is 5")
      << "the other key may be the wrong one";
}

}  // namespace
}  // namespace fail_aware::failure_state_test
