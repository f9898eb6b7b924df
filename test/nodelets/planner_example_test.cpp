// examples/planner.cpp and planner.py: what they do in each state of doc/planner_contract.md, and in silence. Waits for
// what they do, with messages going on as long as it takes.
#include "fail_aware_lidar_odometry/TimeToFailure.h"
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Header.h>
#include <std_msgs/String.h>

#include <map>
#include <string>
#include <type_traits>

#include "../support/graph_recorder.hpp"

namespace fail_aware::planner_example_test {
namespace {

using fail_aware_lidar_odometry::TimeToFailure;

class PlannerExample : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    publisher_ = kept<TimeToFailure>("/fail_aware_lidar_odometry/time_to_failure");
    standing_ = kept<std_msgs::Bool>(std::string("/") + GetParam() + "/standing");
    gps_lost_ = kept<std_msgs::Bool>(std::string("/") + GetParam() + "/gps_lost");
    gps_pose_ = kept<std_msgs::Header>(std::string("/") + GetParam() + "/gps_pose");
    subscriber_ =
        node_.subscribe<std_msgs::String>(std::string("/") + GetParam() + "/action", 1,
                                          [this](const std_msgs::String::ConstPtr& action) { action_ = action->data; });
    ASSERT_TRUE(waitFor([&] {
      return publisher_.getNumSubscribers() == 2 && standing_.getNumSubscribers() == 1 &&
             gps_lost_.getNumSubscribers() == 1 && gps_pose_.getNumSubscribers() == 1 && !action_.empty();
    })) << "not up";
    publish(standing_, true);
    publish(gps_lost_, false);
    ASSERT_EQ(await("own localisation"), "own localisation");
    loseGps();
  }

  /// The last good GPS pose is `age_s` old.
  void loseGps(double age_s = 0.0) {
    for (int i = 0; i < 20; ++i) {  // the topics have no common order: each pose arrives long before the loss
      std_msgs::Header header;
      header.stamp = ros::Time::now() - ros::Duration(age_s);
      gps_pose_.publish(header);
      ros::WallDuration(0.02).sleep();
    }
    t1_ = ros::Time::now();
    publish(gps_lost_, true);
  }

  /// The same publisher in every test: a subscriber need not find a new one.
  template <class Message>
  ros::Publisher kept(const std::string& topic) {
    static auto& publishers = *new std::map<std::string, ros::Publisher>();  // outlives ROS
    ros::Publisher& publisher = publishers[topic];
    if (!publisher) publisher = node_.advertise<Message>(topic, 1, std::is_same_v<Message, std_msgs::Bool>);
    return publisher;
  }

  std::string await(const std::string& action) {
    waitFor([&] { return action_ == action; });
    return action_;
  }

  void say(std::uint8_t state, double time_s, double age_s = 0.0) {
    TimeToFailure message;
    message.header.stamp = ros::Time::now() - ros::Duration(age_s);
    message.state = state;
    message.horizon = 60.0;
    message.time_to_failure = time_s;
    if (state != TimeToFailure::UNKNOWN) message.t1 = t1_;
    publisher_.publish(message);
    ros::WallDuration(0.02).sleep();
  }

  /// What it does after some time of such messages.
  std::string reaction(const std::string& expected, std::uint8_t state, double time_s, double age_s = 0.0) {
    waitFor([&] {
      say(state, time_s, age_s);
      return action_ == expected;
    });
    return action_;
  }

  /// What it does after a second of such messages.
  std::string reactionAfterAWhile(std::uint8_t state, double time_s) {
    const ros::SteadyTime end = ros::SteadyTime::now() + ros::WallDuration(1.0);
    waitFor([&] {
      say(state, time_s);
      return ros::SteadyTime::now() > end;
    });
    return action_;
  }

  static void publish(const ros::Publisher& publisher, bool value) {
    std_msgs::Bool message;
    message.data = value;
    publisher.publish(message);
  }

  ros::NodeHandle node_;
  ros::Publisher publisher_, standing_, gps_lost_, gps_pose_;
  ros::Subscriber subscriber_;
  std::string action_;
  ros::Time t1_;
};

TEST_P(PlannerExample, DoesWhatTheContractSays) {
  EXPECT_EQ(await("stop blind"), "stop blind") << "before any message";
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(await("stop blind"), "stop blind") << "in silence";
  EXPECT_EQ(reaction("slow down", TimeToFailure::DEGRADED, 60.0), "slow down");
  EXPECT_EQ(reaction("stop", TimeToFailure::FAILING, 60.0), "stop");
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(reaction("stop blind", TimeToFailure::OK, 60.0, 6.0), "stop blind") << "said 6 s ago";
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(reaction("stop blind", TimeToFailure::OK, 60.0, -3.0), "stop blind") << "said in the future";
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(reaction("stop blind", TimeToFailure::FAILED, 0.0), "stop blind");
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(reaction("stop blind", TimeToFailure::UNKNOWN, -1.0), "stop blind");
}

TEST_P(PlannerExample, AStopThatHasBegunIsCarriedThroughToStandstill) {
  ASSERT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  publish(standing_, false);
  ASSERT_EQ(reaction("slow down", TimeToFailure::DEGRADED, 60.0), "slow down");
  ASSERT_EQ(reaction("stop", TimeToFailure::FAILING, 60.0), "stop");
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop") << "though it is over";
  EXPECT_EQ(reaction("stop blind", TimeToFailure::FAILED, 0.0), "stop blind") << "from here on without the pose";
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::FAILING, 60.0), "stop blind");
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop blind");
  publish(standing_, true);
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
}

TEST_P(PlannerExample, AsksOnlyFromTheLossOfTheGpsOn) {
  publish(standing_, false);
  publish(gps_lost_, false);
  EXPECT_EQ(reaction("own localisation", TimeToFailure::UNKNOWN, -1.0), "own localisation");
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::FAILED, 0.0), "own localisation");
  say(TimeToFailure::UNKNOWN, -1.0);
  loseGps();
  EXPECT_EQ(reaction("slow down", TimeToFailure::UNKNOWN, -1.0), "slow down") << "it waits for the first state";
  EXPECT_EQ(reaction("stop blind", TimeToFailure::UNKNOWN, -1.0), "stop blind") << "0.5 s later";
  publish(gps_lost_, false);
  EXPECT_EQ(reaction("own localisation", TimeToFailure::OK, 60.0), "own localisation") << "the GPS is back";
  loseGps();
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive") << "at the next loss";
}

TEST_P(PlannerExample, AT1OfAnEarlierCallIsNotTakenForThisLoss) {
  t1_ = ros::Time::now() - ros::Duration(30.0);
  EXPECT_EQ(reaction("slow down", TimeToFailure::OK, 60.0), "slow down") << "it waits for its own t1";
  t1_ = ros::Time::now();
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive") << "though another one was there before";
  publish(gps_lost_, false);
  ASSERT_EQ(await("own localisation"), "own localisation");
  loseGps();
  t1_ -= ros::Duration(30.0);
  EXPECT_EQ(reaction("stop blind", TimeToFailure::OK, 60.0), "stop blind") << "nobody called start_redundant";
}

TEST_P(PlannerExample, AT1ThatNobodyAskedForEndsTheUseOfThePose) {
  ASSERT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  ASSERT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "drive");  // now it has heard of t1 since the loss, for sure
  t1_ += ros::Duration(0.1);
  EXPECT_EQ(reaction("stop blind", TimeToFailure::OK, 60.0), "stop blind") << "the odometry began anew";
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop blind") << "though it stands";
  publish(gps_lost_, false);
  ASSERT_EQ(await("own localisation"), "own localisation");
  loseGps();
  t1_ += ros::Duration(2.0);
  EXPECT_EQ(reaction("stop blind", TimeToFailure::OK, 60.0), "stop blind") << "t1 came too late";
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop blind");
}

TEST_P(PlannerExample, AnOldGpsPoseIsNoStart) {
  ASSERT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  publish(gps_lost_, false);
  ASSERT_EQ(await("own localisation"), "own localisation");
  loseGps(3.0);
  EXPECT_EQ(reaction("stop blind", TimeToFailure::OK, 60.0), "stop blind");
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop blind");
  publish(gps_lost_, false);
  ASSERT_EQ(await("own localisation"), "own localisation");
  loseGps();
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive") << "at the next loss, with a new pose";
}

INSTANTIATE_TEST_SUITE_P(Examples, PlannerExample, testing::Values("planner_cpp", "planner_python"));

}  // namespace
}  // namespace fail_aware::planner_example_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "planner_example_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
