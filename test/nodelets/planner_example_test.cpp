// The two subscribers in README's "The planner's contract", built from its text: what they do in each state, with time
// running out, and in silence. Waits for what they do, with messages going on as long as it takes.
#include <fail_aware_lidar_odometry/TimeToFailure.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

#include <map>
#include <memory>
#include <string>

#include "../support/graph_recorder.hpp"

namespace fail_aware {
namespace {

using fail_aware_lidar_odometry::TimeToFailure;

class PlannerExample : public testing::TestWithParam<const char*> {
 protected:
  static void SetUpTestSuite() {
    senders_ = std::make_unique<Senders>();
    for (const std::string name : {"planner_cpp", "planner_python"}) {
      senders_->standing[name] = senders_->node.advertise<std_msgs::Bool>('/' + name + "/standing", 1, true);
    }
  }
  static void TearDownTestSuite() { senders_.reset(); }

  void SetUp() override {
    publisher_ = senders_->times;
    standing_ = senders_->standing.at(GetParam());
    subscriber_ =
        node_.subscribe<std_msgs::String>(std::string("/") + GetParam() + "/action", 1,
                                          [this](const std_msgs::String::ConstPtr& action) { action_ = action->data; });
    ASSERT_TRUE(waitFor([&] {
      return publisher_.getNumSubscribers() == 2 && standing_.getNumSubscribers() == 1 && !action_.empty();
    })) << "not up";
    setStanding(true);
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

  void setStanding(bool standing) {
    std_msgs::Bool message;
    message.data = standing;
    standing_.publish(message);
  }

  ros::NodeHandle node_;
  ros::Publisher publisher_, standing_;
  ros::Subscriber subscriber_;
  std::string action_;

 private:
  /// For all cases: rospy 1.15.9 (Debian 11) does not hear for seconds a publisher that goes and comes back in one node.
  struct Senders {
    ros::NodeHandle node;
    ros::Publisher times = node.advertise<TimeToFailure>("/fail_aware_lidar_odometry/time_to_failure", 1);
    std::map<std::string, ros::Publisher> standing;
  };
  static std::unique_ptr<Senders> senders_;
};

std::unique_ptr<PlannerExample::Senders> PlannerExample::senders_;

TEST_P(PlannerExample, doesWhatTheContractSays) {
  EXPECT_EQ(await("stop blind"), "stop blind") << "before any message";
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(await("stop blind"), "stop blind") << "in silence";
  EXPECT_EQ(reaction("slow down", TimeToFailure::DEGRADED, 60.0), "slow down");
  EXPECT_EQ(reaction("stop", TimeToFailure::FAILING, 60.0), "stop");
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(reaction("stop", TimeToFailure::OK, 3.9), "stop") << "less than a stop takes";
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
  EXPECT_EQ(reaction("stop", TimeToFailure::DEGRADED, 4.5, 0.8), "stop") << "said 0.8 s ago";
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
  setStanding(false);
  ASSERT_EQ(reaction("slow down", TimeToFailure::DEGRADED, 60.0), "slow down");
  ASSERT_EQ(reaction("stop", TimeToFailure::FAILING, 60.0), "stop");
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop") << "though it is over";
  EXPECT_EQ(reaction("stop blind", TimeToFailure::FAILED, 0.0), "stop blind") << "from here on without the pose";
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::FAILING, 60.0), "stop blind");
  EXPECT_EQ(reactionAfterAWhile(TimeToFailure::OK, 60.0), "stop blind");
  setStanding(true);
  EXPECT_EQ(reaction("drive", TimeToFailure::OK, 60.0), "drive");
}

INSTANTIATE_TEST_SUITE_P(Readme, PlannerExample, testing::Values("planner_cpp", "planner_python"));

}  // namespace
}  // namespace fail_aware

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "planner_example_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
