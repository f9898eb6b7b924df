// The six nodelets in one manager over a made-up drive: one filter state, odometry and time to failure for every cloud,
// and the same poses as offline. Waits for messages, not for seconds.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <vector>

#include "../support/graph_recorder.hpp"
#include "../support/synthetic_street.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/core/odometry_pipeline.hpp"

namespace fail_aware {
namespace {

constexpr int kSweeps = 12;
std::vector<sensor_msgs::PointCloud2Ptr> driveClouds() {
  const synthetic::Street street;
  const synthetic::Drive drive;
  std::vector<sensor_msgs::PointCloud2Ptr> clouds;
  for (int i = 0; i < kSweeps; ++i) {
    const Sweep sweep = street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i,
                                    static_cast<std::uint32_t>(i));
    const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    CorrectedSweep points;
    points.points_lidar = sweep.points_lidar;
    writeCloud(points, sweep.intensities, *cloud);  // its time is zero everywhere, as the driver's for a 64E
    cloud->header.frame_id = "velodyne";
    cloud->header.stamp = ros::Time(1317384506, 0) + ros::Duration(0.1 * i);
    clouds.push_back(cloud);
  }
  return clouds;
}

TEST(Graph, everyCloudHasItsEstimateAndItIsOfflines) {
  ros::NodeHandle node;
  Recorder<messages::FilterState> states(node, "filter_state");
  Recorder<nav_msgs::Odometry> odometry(node, "odometry");
  Recorder<messages::TimeToFailure> times(node, "time_to_failure");
  Recorder<messages::PoseMeasurement> point(node, "measurement/icp_point_to_point");
  Recorder<messages::PoseMeasurement> plane(node, "measurement/icp_point_to_plane");
  Recorder<messages::PoseMeasurement> corners(node, "measurement/corner_svd");
  Recorder<sensor_msgs::PointCloud2> corrected(node, "sweep/points");
  ros::Publisher publisher = node.advertise<sensor_msgs::PointCloud2>("/lidar/points", 10);
  ASSERT_TRUE(waitFor([&] {
    return publisher.getNumSubscribers() == 1 && states.connected() && odometry.connected() && times.connected() &&
           point.connected() && plane.connected() && corners.connected() && corrected.connected();
  })) << "a nodelet did not come up";

  PipelineParameters params = readPipelineParameters(node);
  const synthetic::Lidar lidar;
  const Vector6d lidar_in_base = vectorFromPose(lidar.T_base_lidar);
  params.sensor.lidar_in_base.assign(lidar_in_base.data(), lidar_in_base.data() + 6);
  OdometryPipeline offline(params, 1);
  offline.startRedundant();

  const std::vector<sensor_msgs::PointCloud2Ptr> clouds = driveClouds();
  publisher.publish(clouds[0]);
  EXPECT_FALSE(waitFor([&] { return states.count(clouds[0]->header.stamp) > 0; }, 0.5)) << "without a transform";
  tf2_ros::StaticTransformBroadcaster broadcaster;
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "base_link";
  transform.child_frame_id = "velodyne";
  transform.transform = toTransformMessage(lidar.T_base_lidar);
  broadcaster.sendTransform(transform);
  ASSERT_TRUE(waitFor([&] {
    publisher.publish(clouds[0]);  // until the transform has arrived
    return waitFor([&] { return states.count(clouds[0]->header.stamp) > 0; }, 0.5);
  }));

  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const ros::Time stamp = clouds[i]->header.stamp;
    if (i > 0) publisher.publish(clouds[i]);
    ASSERT_TRUE(waitFor([&] {
      return states.count(stamp) > 0 && odometry.count(stamp) > 0 && times.count(stamp) > 0 && point.count(stamp) > 0 &&
             plane.count(stamp) > 0 && corners.count(stamp) > 0 && corrected.count(stamp) > 0;
    })) << "sweep " << i;
    Sweep sweep;
    ASSERT_TRUE(readCloud(*clouds[i], sweep).ok());
    const SweepResult expected = offline.step(sweep);
    EXPECT_FALSE(states.at(stamp).deadline_missed);
    EXPECT_EQ(states.at(stamp).corrected != 0, expected.state.corrected) << "sweep " << i;
    const std::optional<Pose> T_odom_base = fromMessage(odometry.at(stamp).pose.pose);
    ASSERT_TRUE(T_odom_base);
    const Vector6d error = logSe3(expected.T_odom_base.inverse() * *T_odom_base);
    EXPECT_LT(error.head<3>().norm(), 1e-4) << "sweep " << i;
    EXPECT_LT(error.tail<3>().norm(), 1e-5) << "sweep " << i;
    EXPECT_EQ(times.at(stamp).state, static_cast<int>(expected.monitor.state)) << "sweep " << i;
    EXPECT_EQ(times.at(stamp).reasons, expected.monitor.reasons) << "sweep " << i;
    EXPECT_NEAR(times.at(stamp).time_to_failure, expected.monitor.time_to_failure.seconds, 1e-2) << "sweep " << i;
  }
  for (const auto& cloud : clouds) {
    EXPECT_EQ(states.count(cloud->header.stamp), 1u);
    EXPECT_EQ(odometry.count(cloud->header.stamp), 1u);
  }
  const nav_msgs::Odometry& last = odometry.at(clouds.back()->header.stamp);
  EXPECT_EQ(last.header.frame_id, "odom");
  EXPECT_EQ(last.child_frame_id, "base_link");
  EXPECT_NEAR(last.twist.twist.linear.x, synthetic::Drive().speed_mps, 0.5);

  // silence is a failure
  bool stale = false;
  ros::Subscriber listener = node.subscribe<messages::TimeToFailure>(
      "time_to_failure", 10, [&](const messages::TimeToFailureConstPtr& message) {
        stale = message->state == messages::TimeToFailure::FAILED &&
                (message->reasons & messages::TimeToFailure::REASON_STALE) != 0 && message->time_to_failure == 0.0;
      });
  EXPECT_TRUE(waitFor([&] { return stale; }));
}

}  // namespace
}  // namespace fail_aware

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "graph_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
