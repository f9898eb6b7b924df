#include "../../src/nodelets/bounded_path.hpp"

#include <gtest/gtest.h>

namespace fail_aware::bounded_path_test {
namespace {

bool addAt(BoundedPath& path, double x_m) {
  Pose T = Pose::Identity();
  T.translation().x() = x_m;
  std_msgs::Header header;
  header.stamp = ros::Time(100.0 + x_m);
  return path.add(T, header);
}

TEST(BoundedPath, KeepsAPoseEverySoManyMetresAndForgetsTheOldest) {
  BoundedPath path(3, 0.5);
  EXPECT_TRUE(path.message()->poses.empty());
  EXPECT_TRUE(addAt(path, 0.0));
  EXPECT_FALSE(addAt(path, 0.4));
  for (const double x_m : {0.5, 1.0, 1.5}) EXPECT_TRUE(addAt(path, x_m));
  const nav_msgs::PathConstPtr message = path.message();
  ASSERT_EQ(message->poses.size(), 3u);
  EXPECT_EQ(message->poses.front().pose.position.x, 0.5);
  EXPECT_EQ(message->poses.back().pose.position.x, 1.5);
  EXPECT_EQ(message->header.stamp, ros::Time(101.5));
  path.clear();
  EXPECT_TRUE(addAt(path, 1.5)) << "a new path begins anywhere";
}

}  // namespace
}  // namespace fail_aware::bounded_path_test
