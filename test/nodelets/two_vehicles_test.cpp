// Two vehicles in one ROS master, on different drives at the same stamps: each has its own odometry, in its own frames,
// and neither hears anything of the other.
#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include <set>
#include <string>
#include <utility>

#include "../support/bus_links.hpp"
#include "../support/graph_driver.hpp"

namespace fail_aware::two_vehicles_test {
namespace {

constexpr int kSweeps = 6;

struct Vehicle {
  Vehicle(const std::string& vehicle_name, const synthetic::Drive& its_drive)
      : name(vehicle_name),
        drive(its_drive),
        graph('/' + name + "/odometry", {'/' + name + "/lidar/points", name + '/'}) {}

  sensor_msgs::PointCloud2Ptr cloud(int i) const {
    const Sweep sweep = synthetic::Street().scan([&](double t) { return drive.T_street_base(t); }, kSweepPeriod_s * i,
                                                 static_cast<std::uint32_t>(i));
    const sensor_msgs::PointCloud2Ptr cloud = cloudOf(sweep, stampOfSweep(i));
    cloud->header.frame_id = name + "/velodyne";
    return cloud;
  }

  std::string name;
  synthetic::Drive drive;
  GraphDriver graph;
};

synthetic::Drive slowDrive() {
  synthetic::Drive drive;
  drive.speed_mps = 5.0;
  drive.yaw_rate_rps = -0.1;
  return drive;
}

TEST(TwoVehicles, EachHasItsOwnOdometryInItsOwnFrames) {
  Vehicle vehicles[] = {{"car_1", synthetic::Drive()}, {"car_2", slowDrive()}};
  std::set<std::pair<std::string, std::string>> transforms;
  using OnTransforms = boost::function<void(const tf2_msgs::TFMessageConstPtr&)>;
  const ros::Subscriber listener = vehicles[0].graph.node().subscribe<tf2_msgs::TFMessage>(
      "/tf", 100, OnTransforms([&](const tf2_msgs::TFMessageConstPtr& message) {
        for (const auto& transform : message->transforms) {
          transforms.insert({transform.header.frame_id, transform.child_frame_id});
        }
      }));
  for (Vehicle& vehicle : vehicles) {
    ASSERT_TRUE(vehicle.graph.waitUntilLinked()) << vehicle.name;
  }
  ASSERT_TRUE(waitFor([] { return allLinked({"/tf"}); }));

  // The second vehicle's transform comes later: the first does not take it for its own, nor wait for it.
  vehicles[0].graph.sendTransform();
  ASSERT_TRUE(vehicles[0].graph.start(vehicles[0].cloud(0)));
  vehicles[1].graph.publish(vehicles[1].cloud(0));
  EXPECT_FALSE(waitFor([&] { return vehicles[1].graph.answered(stampOfSweep(0)); }, 0.5))
      << "without its own transform";
  vehicles[1].graph.sendTransform();
  ASSERT_TRUE(waitFor([&] { return vehicles[1].graph.answered(stampOfSweep(0)); }));

  for (int i = 1; i < kSweeps; ++i) {
    for (Vehicle& vehicle : vehicles) vehicle.graph.publish(vehicle.cloud(i));  // both are at work at the same time
    for (Vehicle& vehicle : vehicles) {
      ASSERT_TRUE(waitFor([&] { return vehicle.graph.answered(stampOfSweep(i)); })) << vehicle.name << ", sweep " << i;
    }
  }
  for (Vehicle& vehicle : vehicles) {
    for (int i = 0; i < kSweeps; ++i) {
      EXPECT_EQ(vehicle.graph.states.count(stampOfSweep(i)), 1u) << vehicle.name << ", sweep " << i;
      EXPECT_EQ(vehicle.graph.odometry.count(stampOfSweep(i)), 1u) << vehicle.name << ", sweep " << i;
    }
    const nav_msgs::Odometry& last = vehicle.graph.odometry.at(stampOfSweep(kSweeps - 1));
    EXPECT_EQ(last.header.frame_id, vehicle.name + "/odom");
    EXPECT_EQ(last.child_frame_id, vehicle.name + "/base_link");
    EXPECT_EQ(vehicle.graph.states.at(stampOfSweep(kSweeps - 1)).measurement_applied, 1);
    const Pose truth = vehicle.drive.T_odom_base(kSweepPeriod_s * (kSweeps - 1));
    const Pose T_odom_base = vehicle.graph.T_odom_base(stampOfSweep(kSweeps - 1));
    EXPECT_LT((T_odom_base.translation() - truth.translation()).norm(), 0.1) << vehicle.name;
  }
  const std::set<std::pair<std::string, std::string>> own = {{"car_1/odom", "car_1/base_link"},
                                                             {"car_2/odom", "car_2/base_link"}};
  EXPECT_EQ(transforms, own);
  for (const char* topic : {"filter_state", "sweep/points", "odometry", "time_to_failure"}) {
    EXPECT_TRUE(registeredNodes(true, std::string("/fail_aware_lidar_odometry/") + topic).empty()) << topic;
  }
}

}  // namespace
}  // namespace fail_aware::two_vehicles_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "two_vehicles_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
