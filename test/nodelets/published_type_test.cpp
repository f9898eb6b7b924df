#include "../../src/nodelets/published_type.hpp"

#include <gtest/gtest.h>

namespace fail_aware::published_type_test {
namespace {

TEST(WhyNoCloud, AnotherTypeIsNamedWithWhatIsNeeded) {
  const std::string said = whyNoCloud("/scan", "sensor_msgs/LaserScan");
  for (const char* word : {"/scan", "sensor_msgs/LaserScan", "sensor_msgs/PointCloud2"}) {
    EXPECT_NE(said.find(word), std::string::npos) << said;
  }
}

TEST(WhyNoCloud, ATopicThatNobodyPublishesIsNamed) {
  EXPECT_EQ(whyNoCloud("/points", ""), "no cloud yet: nobody publishes /points (another topic: cloud:=/your/points)");
}

TEST(WhyNoCloud, TheRightTypeIsNoFault) {
  EXPECT_EQ(whyNoCloud("/points", "sensor_msgs/PointCloud2"), "no cloud yet on /points");
  EXPECT_FALSE(isAnotherType("sensor_msgs/PointCloud2") || isAnotherType(""));
  EXPECT_TRUE(isAnotherType("sensor_msgs/LaserScan"));
}

}  // namespace
}  // namespace fail_aware::published_type_test
