// What an integrator gets wrong before the first sweep, and the line in the log and the diagnostics that names it.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/LaserScan.h>

#include <map>
#include <string>
#include <vector>

#include "../../src/tools/process_monitor.hpp"
#include "../support/graph_driver.hpp"

namespace fail_aware::wrong_inputs_test {
namespace {

class WrongInputs : public testing::Test {
 protected:
  WrongInputs() {
    log_listener_ = node_.subscribe<rosgraph_msgs::Log>(
        "/rosout", 100, [this](const rosgraph_msgs::LogConstPtr& line) { log_.push_back(line->msg); });
    diagnostics_ = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 50, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
          for (const auto& status : array->status) {
            for (const auto& [name, type] : NodeletManager::types()) {
              if (status.name.find(name) != std::string::npos) said_[name] = status;
            }
          }
        });
  }
  ~WrongInputs() override {
    for (const std::string& name : loaded_) manager_.unload(name);
  }

  void load(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      ASSERT_TRUE(manager_.load(name)) << name;
      loaded_.push_back(name);
    }
  }
  void loadAll() {
    for (const auto& [name, type] : NodeletManager::types()) load({name});
  }

  std::size_t linesWith(const std::string& part) const {
    std::size_t count = 0;
    for (const std::string& line : log_) count += line.find(part) != std::string::npos ? 1 : 0;
    return count;
  }
  /// The diagnostics' message.
  std::string said(const std::string& name) const {
    const auto at = said_.find(name);
    return at == said_.end() ? "" : at->second.message;
  }
  bool says(const std::string& name, const std::string& part) const {
    return said(name).find(part) != std::string::npos;
  }
  /// Clouds at 20 Hz until both say it, and two seconds more.
  void publishUntilSaid(GraphDriver& graph, const std::string& frame, const std::string& part) {
    int i = 0;
    const auto publishOne = [&] {
      const sensor_msgs::PointCloud2Ptr cloud = streetCloud(i++ % 5);
      cloud->header.stamp = stampOfSweep(i);
      cloud->header.frame_id = frame;
      graph.publish(cloud);
    };
    EXPECT_TRUE(waitFor([&] {
      publishOne();
      ros::WallDuration(0.05).sleep();
      return linesWith(part) > 0 && says("fusion_ukf", part);
    })) << said("fusion_ukf");
    for (int more = 0; more < 40; ++more) {
      publishOne();
      waitFor([] { return false; }, 0.05);
    }
  }

  ros::NodeHandle node_;
  NodeletManager manager_;
  std::vector<std::string> loaded_, log_;
  std::map<std::string, diagnostic_msgs::DiagnosticStatus> said_;
  ros::Subscriber log_listener_, diagnostics_;
};

TEST_F(WrongInputs, AMissingTransformIsALineInTheLogAndAnError) {
  GraphDriver graph;
  load({"fusion_ukf"});
  publishUntilSaid(graph, "nowhere", "no transform base_link -> nowhere: ");
  EXPECT_EQ(said_["fusion_ukf"].level, diagnostic_msgs::DiagnosticStatus::ERROR);
  EXPECT_TRUE(says("fusion_ukf", "static_transform_publisher")) << "what to do: " << said("fusion_ukf");
  EXPECT_EQ(linesWith("no transform base_link -> nowhere: "), 1u) << "not one a cloud";
}

TEST_F(WrongInputs, AnEmptyFrameIsNamed) {
  GraphDriver graph;
  load({"fusion_ukf"});
  publishUntilSaid(graph, "", "the clouds have no frame_id");
  EXPECT_EQ(linesWith("the clouds have no frame_id"), 1u);
}

TEST_F(WrongInputs, ALaserScanOnTheCloudsTopicIsNamed) {
  ros::Publisher scans = node_.advertise<sensor_msgs::LaserScan>(kCloudTopic, 1);
  load({"fusion_ukf"});
  const std::string part = std::string(kCloudTopic) + " carries sensor_msgs/LaserScan";
  EXPECT_TRUE(waitFor([&] { return linesWith(part) > 0 && says("fusion_ukf", part); })) << said("fusion_ukf");
}

TEST_F(WrongInputs, StampsOfAnotherClockAreAWarning) {
  GraphDriver graph;
  loadAll();
  graph.sendTransform();
  ASSERT_TRUE(graph.waitUntilLinked());
  ASSERT_TRUE(graph.start(streetCloud(0)));
  int i = 1;
  for (const char* name : {"fusion_ukf", "sweep_correction", "fail_aware_monitor"}) {
    // clouds go on: of silence the diagnostics speak first
    EXPECT_TRUE(waitFor([&] {
      EXPECT_TRUE(graph.drive(streetCloud(i++)));
      return says(name, "stamps and ROS time are different clocks");
    })) << name
        << ": " << said(name);
    EXPECT_NE(said_[name].level, diagnostic_msgs::DiagnosticStatus::OK) << name;
  }
}

TEST_F(WrongInputs, TheNodeBehindATopicIsFoundByItsPublisher) {
  load({"fusion_ukf"});
  ros::Publisher own = node_.advertise<sensor_msgs::LaserScan>("own", 1);
  EXPECT_EQ(publisherOf(node_.resolveName("/fail_aware_lidar_odometry/odometry")),
            "/fail_aware_lidar_odometry/manager");
  EXPECT_EQ(publisherOf(own.getTopic()), ros::this_node::getName());
  EXPECT_EQ(publisherOf("/nobodys"), "");
}

}  // namespace
}  // namespace fail_aware::wrong_inputs_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "wrong_inputs_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
