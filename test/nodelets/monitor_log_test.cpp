#include "../../src/nodelets/monitor_log.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fail_aware::monitor_log_test {
namespace {

MonitorOutput outputOf(FailAwareState state, double t1_stamp_s) {
  MonitorOutput output;
  output.state = state;
  output.t1_stamp_s = t1_stamp_s;
  output.time_to_failure = TimeToFailure::fromSeconds(2.5, 60.0);
  return output;
}

/// What is written to both streams about an output.
std::string lineOf(MonitorLog& log, const MonitorOutput& output) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  log.tell(output);
  const std::string info = testing::internal::GetCapturedStdout();
  return info + testing::internal::GetCapturedStderr();
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(MonitorLog, ALineForEachChangeOfT1) {
  MonitorLog log(false);
  EXPECT_EQ(lineOf(log, outputOf(FailAwareState::kUnknown, -1.0)), "");
  EXPECT_TRUE(has(lineOf(log, outputOf(FailAwareState::kOk, 12.5)), "t1 is 12.500000"));
  EXPECT_EQ(lineOf(log, outputOf(FailAwareState::kOk, 12.5)), "");
  EXPECT_TRUE(has(lineOf(log, outputOf(FailAwareState::kOk, 13.0)), "t1 is 13.000000"));
  EXPECT_TRUE(has(lineOf(log, outputOf(FailAwareState::kUnknown, -1.0)), "until start_redundant is called"));
}

TEST(MonitorLog, AT1ThatReturnsByItselfWaitsForNoCall) {
  MonitorLog log(true);
  EXPECT_TRUE(has(lineOf(log, outputOf(FailAwareState::kOk, 12.5)), "t1 is 12.500000"));
  const std::string said = lineOf(log, outputOf(FailAwareState::kUnknown, -1.0));
  EXPECT_TRUE(has(said, "t1 has ended: the state is UNKNOWN until a motion is observed again")) << said;
}

TEST(MonitorLog, ALineWhenAnAlarmBeginsGetsWorseAndEnds) {
  MonitorLog log(true);
  EXPECT_EQ(lineOf(log, outputOf(FailAwareState::kDegraded, -1.0)), "");
  MonitorOutput failing = outputOf(FailAwareState::kFailing, -1.0);
  failing.reasons = kReasonFrozenCloud;
  const std::string said = lineOf(log, failing);
  EXPECT_TRUE(has(said, "the state is FAILING, time to failure 2.5 s: FROZEN_CLOUD")) << said;
  EXPECT_EQ(lineOf(log, failing), "");
  EXPECT_TRUE(has(lineOf(log, outputOf(FailAwareState::kFailed, -1.0)), "the state is FAILED"));
  EXPECT_TRUE(has(lineOf(log, outputOf(FailAwareState::kDegraded, -1.0)), "the state is DEGRADED"));
  EXPECT_EQ(lineOf(log, outputOf(FailAwareState::kOk, -1.0)), "");
}

}  // namespace
}  // namespace fail_aware::monitor_log_test
