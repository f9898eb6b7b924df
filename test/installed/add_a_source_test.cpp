// examples/add_a_source in the live graph: the fusion takes what it publishes.
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>

#include "../support/bus_links.hpp"
#include "../support/graph_driver.hpp"

namespace fail_aware::add_a_source_test {
namespace {

TEST(AddASource, JoinsTheFusion) {
  GraphDriver graph;
  graph.sendTransform();
  ASSERT_TRUE(graph.waitUntilLinked());
  ASSERT_TRUE(waitFor([&] { return allLinked({graph.topic("measurement/my_source")}); }));
  ASSERT_TRUE(graph.start(streetCloud(0)));
  for (int i = 1; i <= 4; ++i) ASSERT_TRUE(graph.drive(streetCloud(i))) << i;
  const messages::FilterState state = graph.states.at(stampOfSweep(4));
  const auto& names = state.measurement_names;
  const auto at = std::find(names.begin(), names.end(), "my_source");
  ASSERT_NE(at, names.end());
  EXPECT_EQ(state.measurement_status[static_cast<std::size_t>(at - names.begin())], messages::PoseMeasurement::OK);
}

}  // namespace
}  // namespace fail_aware::add_a_source_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "add_a_source_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
