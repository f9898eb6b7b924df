// One process holds the six nodelets and this test: the corrected cloud is one object for all who hear it, from the
// publisher on, and nobody writes to it, nor to any other message, after it was published.
#include <gtest/gtest.h>
#include <nodelet/loader.h>

#include <set>
#include <string>
#include <vector>

#include "../support/bus_links.hpp"
#include "../support/graph_driver.hpp"

namespace fail_aware::zero_copy_test {
namespace {

constexpr int kSweeps = 5;

std::uint64_t hashOf(const std::uint8_t* data, std::size_t size) {
  std::uint64_t hash = 1469598103934665603u;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * 1099511628211u;
  return hash;
}

template <class Message>
std::uint64_t contentOf(const Message& message) {
  const ros::SerializedMessage serialized = ros::serialization::serializeMessage(message);
  return hashOf(serialized.buf.get(), serialized.num_bytes);
}

/// Keeps every message it hears, with the hash it had when it came.
template <class Message>
class Witness {
 public:
  Witness(ros::NodeHandle& node, const std::string& topic)
      : subscriber_(node.subscribe<Message>(topic, 100, [this](const typename Message::ConstPtr& message) {
          heard.push_back({message, contentOf(*message)});
        })) {}

  void expectUnchanged(const std::string& what) const {
    EXPECT_FALSE(heard.empty()) << what;
    for (const auto& [message, hash] : heard) EXPECT_EQ(contentOf(*message), hash) << what;
  }

  std::vector<std::pair<typename Message::ConstPtr, std::uint64_t>> heard;

 private:
  ros::Subscriber subscriber_;
};

TEST(ZeroCopy, OneCloudForAllAndNobodyWritesToIt) {
  nodelet::Loader loader;  // its worker threads run the nodelets
  const std::string graph_namespace = "/fail_aware_lidar_odometry";
  for (const auto& [name, type] : NodeletManager::types()) {
    ASSERT_TRUE(loader.load(graph_namespace + '/' + name, "fail_aware_lidar_odometry/" + type,
                            {{graph_namespace + "/points", kCloudTopic}}, {}))
        << name;
  }
  GraphDriver graph;
  ros::NodeHandle second(graph.node());
  Witness<sensor_msgs::PointCloud2> raw(graph.node(), kCloudTopic);
  Witness<sensor_msgs::PointCloud2> corrected(graph.node(), "sweep/points"), again(second, "sweep/points");
  Witness<messages::SweepPrediction> predictions(graph.node(), "sweep/prediction");
  Witness<messages::SweepCheck> checks(graph.node(), "sweep/check");
  Witness<messages::PoseMeasurement> point(graph.node(), "measurement/icp_point_to_point");
  Witness<messages::PoseMeasurement> plane(graph.node(), "measurement/icp_point_to_plane");
  Witness<messages::PoseMeasurement> corners(graph.node(), "measurement/corner_svd");
  Witness<messages::FilterState> states(graph.node(), "filter_state");
  Witness<messages::TimeToFailure> times(graph.node(), "time_to_failure");
  ASSERT_TRUE(graph.waitUntilLinked());
  graph.sendTransform();
  ASSERT_TRUE(graph.start(streetCloud(0)));
  std::vector<sensor_msgs::PointCloud2Ptr> published;
  for (int i = 1; i < kSweeps; ++i) {
    published.push_back(streetCloud(i));
    ASSERT_TRUE(graph.drive(published.back())) << "sweep " << i;
    const ros::Time stamp = stampOfSweep(i);
    EXPECT_FALSE(graph.states.at(stamp).deadline_missed) << "all consumers had it";
    EXPECT_TRUE(graph.states.at(stamp).measurement_applied);
  }
  ASSERT_TRUE(waitFor([&] { return corrected.heard.size() >= kSweeps && again.heard.size() >= kSweeps; }));

  // Every link of every topic of the sweep is within the process: messages are handed over as pointers.
  std::set<std::string> local;
  for (const BusLink& link : busLinks(ros::this_node::getName())) {
    for (const char* name : {"sweep/points", "sweep/prediction", "sweep/check", "filter_state"}) {
      if (link.topic != graph.topic(name)) continue;
      EXPECT_EQ(link.transport, "INTRAPROCESS") << link.topic;
      local.insert(link.topic);
    }
  }
  EXPECT_EQ(local.size(), 4u);
  EXPECT_EQ(registeredNodes(false, graph.topic("sweep/points")).size(), 1u) << "all consumers are in this process";
  // The subscribers of a process share one subscription, which hands the publisher's pointer to each of them.
  for (std::size_t i = 0; i < corrected.heard.size(); ++i) {
    EXPECT_EQ(corrected.heard[i].first.get(), again.heard[i].first.get());
    EXPECT_EQ(corrected.heard[i].first->data.data(), again.heard[i].first->data.data());
  }
  for (const sensor_msgs::PointCloud2Ptr& cloud : published) {
    bool same = false;
    for (const auto& [message, hash] : raw.heard) same = same || message->data.data() == cloud->data.data();
    EXPECT_TRUE(same) << "the cloud that was published, not a copy";
  }

  raw.expectUnchanged("points");
  corrected.expectUnchanged("sweep/points");
  predictions.expectUnchanged("sweep/prediction");
  checks.expectUnchanged("sweep/check");
  point.expectUnchanged("measurement/icp_point_to_point");
  plane.expectUnchanged("measurement/icp_point_to_plane");
  corners.expectUnchanged("measurement/corner_svd");
  states.expectUnchanged("filter_state");
  times.expectUnchanged("time_to_failure");
  loader.clear();
}

}  // namespace
}  // namespace fail_aware::zero_copy_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "zero_copy_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
