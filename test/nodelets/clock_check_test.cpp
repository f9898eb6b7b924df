#include "../../src/nodelets/clock_check.hpp"

#include <gtest/gtest.h>

namespace fail_aware::clock_check_test {
namespace {

const ros::Time kNow(1700000000, 0);

/// What is said of messages of that age on arrival.
std::string faultAt(double age_s, int messages = 11) {
  ClockCheck check;
  for (int i = 0; i < messages; ++i) check.heard(kNow - ros::Duration(age_s), kNow);
  return check.fault(false, kNow);
}

TEST(ClockCheck, StampsOfRosTimeAreNoFault) {
  for (const double age_s : {0.0, 0.1, 0.6, 4.9, -0.4}) EXPECT_EQ(faultAt(age_s), "") << age_s;
  EXPECT_EQ(ClockCheck().fault(false, kNow), "") << "nothing was heard";
}

TEST(ClockCheck, StampsOfAnotherClockAreNamed) {
  for (const double age_s : {5.1, 100.0, 1.69e9}) {
    EXPECT_NE(faultAt(age_s).find("different clocks"), std::string::npos) << age_s;
    EXPECT_NE(faultAt(age_s).find("s old"), std::string::npos) << age_s;
  }
  EXPECT_NE(faultAt(-0.6).find("s ahead"), std::string::npos) << faultAt(-0.6);
  EXPECT_NE(faultAt(1.6e9, 1), "") << "the first one tells it";
}

TEST(ClockCheck, SingleStampsCountNothing) {
  ClockCheck check;
  for (int i = 0; i < 11; ++i) check.heard(kNow - ros::Duration(i % 3 == 0 ? 1000.0 : 0.1), kNow);
  EXPECT_EQ(check.fault(false, kNow), "");
  EXPECT_NEAR(check.age_s(), 0.1, 1e-6);
  check.heard(ros::Time(), kNow);
  EXPECT_EQ(check.fault(false, kNow), "") << "a stamp of zero is none, and refused elsewhere";
}

TEST(ClockCheck, SimulatedTimeThatStandsAtZeroIsNamed) {
  ClockCheck check;
  EXPECT_NE(check.fault(true, ros::Time()).find("/clock"), std::string::npos);
  EXPECT_EQ(check.fault(true, kNow), "");
}

}  // namespace
}  // namespace fail_aware::clock_check_test
