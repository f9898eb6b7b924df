#include "fail_aware_lidar_odometry/bridge/bag_file.hpp"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include <filesystem>

#include "core/io/input_error.hpp"

namespace fail_aware::bag_file_test {
namespace {

namespace fs = std::filesystem;

TEST(BagFile, WritesLatchedAndPlainMessages) {
  const std::string path =
      (fs::path(::testing::TempDir()) / ("bag_file_" + std::to_string(getpid()) + ".bag")).string();
  std_msgs::String message;
  message.data = "text";
  {
    BagFile bag(path);
    bag.write("/plain", ros::Time(1, 0), message);
    bag.writeLatched("/latched", ros::Time(2, 0), message, "/me");
    bag.close();
    EXPECT_THROW(bag.write("/plain", ros::Time(3, 0), message), std::runtime_error);
    bag.close();  // a second time does nothing
  }
  rosbag::Bag bag(path);
  std::size_t count = 0;
  for (const rosbag::MessageInstance& instance : rosbag::View(bag)) {
    EXPECT_EQ(instance.isLatching(), instance.getTopic() == "/latched");
    EXPECT_EQ(instance.instantiate<std_msgs::String>()->data, "text");
    ++count;
  }
  EXPECT_EQ(count, 2u);
  fs::remove(path);
}

TEST(BagFile, PlaceThatCannotBeWrittenIsRefused) { EXPECT_THROW(BagFile("/no/such/folder/x.bag"), InputError); }

}  // namespace
}  // namespace fail_aware::bag_file_test
