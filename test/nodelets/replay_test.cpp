// A bag, played on its own time at several rates, into the graph of kitti_replay.launch: one odometry for every cloud,
// the same as offline's over the bag, and a clean start anew when the bag begins again.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "../support/graph_recorder.hpp"
#include "../support/synthetic_street.hpp"
#include "../support/tum_trajectory.hpp"
#include "bridge/bag_sweep_source.hpp"
#include "bridge/kitti_bag_writer.hpp"
#include "bridge/parameter_server.hpp"
#include "core/io/trajectory_io.hpp"
#include "core/odometry_pipeline.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::replay_test {
namespace {

// No more than the graph's queues hold: none is dropped, however slow the machine.
constexpr int kSweeps = 8;

std::string writeBag() {
  const std::string path =
      (std::filesystem::path(::testing::TempDir()) / ("replay_" + std::to_string(getpid()) + ".bag")).string();
  const synthetic::Street street;
  const synthetic::Drive drive;
  synthetic::Lidar lidar;
  lidar.T_base_lidar = poseFromVector((Vector6d() << -0.595, 0.1, 1.73, 0.01, -0.02, 0.03).finished());
  KittiBagWriter writer(path, {lidar.T_base_lidar, false, true});
  for (int i = 0; i < kSweeps; ++i) {
    const Sweep sweep =
        street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i), lidar);
    writer.add(ros::Time(1317000000, 0) + ros::Duration(0.1 * i), sweep, drive.T_odom_base(0.1 * i));
  }
  writer.close();
  return path;
}

std::vector<Pose> offlinePoses(const std::string& bag, PipelineParameters params) {
  BagSweepSource source({bag});
  const Vector6d place = vectorFromPose(*source.lidarInBase("base_link").T_base_lidar);
  params.sensor.lidar_in_base.assign(place.data(), place.data() + 6);
  OdometryPipeline pipeline(params, 1);
  std::vector<Pose> poses;
  Sweep sweep;
  for (std::size_t i = 0; i < source.size(); ++i) {
    source.next(sweep);
    poses.push_back(pipeline.step(sweep).T_odom_base);
  }
  return poses;
}

/// rosbag play in the background; waits for its end when destroyed.
class Player {
 public:
  Player(const std::string& bag, double rate)
      : thread_([bag, rate] {
          const std::string command = "rosbag play --clock --quiet --wait-for-subscribers --rate " +
                                      std::to_string(rate) + " '" + bag + "' /tf:=/kitti/tf >/dev/null";
          if (std::system(command.c_str()) != 0) ADD_FAILURE() << command;
        }) {}
  ~Player() { thread_.join(); }

 private:
  std::thread thread_;
};

template <class Message>
void ignore(const typename Message::ConstPtr&) {}

class Replay : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { bag_ = writeBag(); }
  static void TearDownTestSuite() { std::filesystem::remove(bag_); }

  Replay()
      : odometry_(node_.subscribe<nav_msgs::Odometry>(
            "odometry", 100, [this](const nav_msgs::OdometryConstPtr& message) { received_.push_back(message); })) {
    // The player waits for a subscriber on every topic of the bag; the graph listens to the clouds, and to /tf_static
    // only until it knows where the lidar is.
    for (const char* topic : {"/tf_static", "/kitti/tf"}) {
      others_.push_back(node_.subscribe<tf2_msgs::TFMessage>(topic, 100, &ignore<tf2_msgs::TFMessage>));
    }
    others_.push_back(node_.subscribe<nav_msgs::Odometry>("/kitti/ground_truth", 100, &ignore<nav_msgs::Odometry>));
  }

  static std::string bag_;
  ros::NodeHandle node_;
  std::vector<nav_msgs::OdometryConstPtr> received_;
  ros::Subscriber odometry_;
  std::vector<ros::Subscriber> others_;
};

std::string Replay::bag_;

TEST_F(Replay, EverySweepIsAnsweredAsOfflineAtAnyRate) {
  ASSERT_TRUE(waitFor([&] { return odometry_.getNumPublishers() > 0; }));
  const std::vector<Pose> expected = offlinePoses(bag_, readPipelineParameters(node_));
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(kSweeps));
  {
    const Player player(bag_, 1.0);  // the transform comes from the bag, perhaps after its first clouds
    ASSERT_TRUE(waitFor([&] { return !received_.empty() && received_.back()->header.stamp.nsec == 700000000; }));
  }
  for (const double rate : {0.5, 1.0, 2.0}) {
    std_srvs::Trigger trigger;  // without it, odom would go on from the last pose
    ASSERT_TRUE(ros::service::call("fusion_ukf/reset", trigger));
    received_.clear();
    const Player player(bag_, rate);
    EXPECT_TRUE(waitFor([&] { return received_.size() >= expected.size(); })) << received_.size();
    ASSERT_EQ(received_.size(), expected.size()) << "rate " << rate;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const nav_msgs::Odometry& odometry = *received_[i];
      EXPECT_EQ(odometry.header.stamp, ros::Time(1317000000, 0) + ros::Duration(0.1 * static_cast<double>(i)));
      const std::optional<Pose> T_odom_base = fromMessage(odometry.pose.pose);
      ASSERT_TRUE(T_odom_base);
      EXPECT_TRUE(T_odom_base->matrix() == quaternionRoundTrip(expected[i]).matrix())
          << "rate " << rate << ", sweep " << i << ": "
          << (T_odom_base->translation() - expected[i].translation()).norm() << " m";
    }
  }
}

TEST_F(Replay, MeasureLatencyWatchesTheGraph) {
  const std::string json = bag_ + ".json", tum = bag_ + ".tum";
  std::atomic<bool> ended{false};
  int status = -1;
  std::thread watcher([&] {
    status = std::system(("'" MEASURE_LATENCY "' --cloud /kitti/velo/pointcloud --idle 2 --json '" + json +
                          "' --trajectory '" + tum + "' >/dev/null")
                             .c_str());
    ended = true;
  });
  while (!ended) {  // from when it listens, which nobody else can see
    const Player player(bag_, 1.0);
    EXPECT_TRUE(
        waitFor([&] { return ended || (!received_.empty() && received_.back()->header.stamp.nsec == 700000000); }));
    received_.clear();
    waitFor([&] { return ended.load(); }, 4.0);
  }
  watcher.join();
  EXPECT_EQ(status, 0);
  const nlohmann::json figures = nlohmann::json::parse(std::ifstream(json));
  EXPECT_GE(figures["clouds"], 1);
  EXPECT_GE(figures["odometries"], 1);
  EXPECT_LE(figures["clouds"], kSweeps);
  EXPECT_GT(figures["latency_ms"]["sweeps"], 0);
  EXPECT_GT(figures["latency_ms"]["max"], 0.0);
  EXPECT_LE(figures["latency_ms"]["p50"], figures["latency_ms"]["p99"]);
  EXPECT_GT(figures["process"]["rss_max_mb"], 1.0);
  EXPECT_EQ(readTumTrajectory(tum).size(), figures["odometries"].get<std::size_t>());
  std::filesystem::remove(json);
  std::filesystem::remove(tum);
}

}  // namespace
}  // namespace fail_aware::replay_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "replay_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
