#include "../../src/nodelets/load_failures.hpp"

#include <gtest/gtest.h>

namespace fail_aware::load_failures_test {
namespace {

TEST(LoadFailures, OnlyTheFirstNodeletSaysTheReason) {
  LoadFailures failures;
  const ros::SteadyTime now(100.0);
  EXPECT_EQ(failures.line("/a", "profile: x: unknown", now), "/a is not loaded: profile: x: unknown");
  EXPECT_EQ(failures.line("/b", "profile: x: unknown", now), "/b is not loaded: for the same reason as /a");
  EXPECT_EQ(failures.line("/b", "b: y: unknown", now), "/b is not loaded: b: y: unknown") << "another reason";
  EXPECT_EQ(failures.line("/a", "profile: x: unknown", now), "/a is not loaded: profile: x: unknown") << "tried again";
}

TEST(LoadFailures, ALaterLaunchIsToldTheReasonAgain) {
  LoadFailures failures;
  failures.line("/a", "profile: x: unknown", ros::SteadyTime(100.0));
  EXPECT_EQ(failures.line("/b", "profile: x: unknown", ros::SteadyTime(111.0)),
            "/b is not loaded: profile: x: unknown");
}

}  // namespace
}  // namespace fail_aware::load_failures_test
