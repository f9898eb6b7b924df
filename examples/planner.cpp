// A planner that obeys the time to failure (doc/planner_contract.md). It publishes what the vehicle must do, 20 times a
// second, on ~action: "drive", "slow down", "stop" (follow the pose) or "stop blind" (do not use the pose).
// ~standing (std_msgs/Bool): the vehicle stands, as its wheels tell.
#include "fail_aware_lidar_odometry/TimeToFailure.h"
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

#include <algorithm>

using fail_aware_lidar_odometry::TimeToFailure;

namespace {
constexpr double kSilence_s = 0.5;  // without a message: the monitor or its computer has failed
constexpr double kOldest_s = 1.0;   // an older stamp is outdated
constexpr double kAhead_s = 0.1;    // a stamp further in the future comes from another clock
enum Stop { kNone = 0, kByThePose = 1, kBlind = 2 };
}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "planner");
  ros::NodeHandle node("~");
  TimeToFailure last;     // UNKNOWN until the first one comes
  ros::SteadyTime heard;  // a clock that nobody sets
  ros::Subscriber subscriber = node.subscribe<TimeToFailure>(
      "/fail_aware_lidar_odometry/time_to_failure", 1,
      [&](const TimeToFailure::ConstPtr& message) { last = *message, heard = ros::SteadyTime::now(); });
  bool standing = false;
  ros::Subscriber wheels = node.subscribe<std_msgs::Bool>(
      "standing", 1, [&](const std_msgs::Bool::ConstPtr& message) { standing = message->data; });
  ros::Publisher publisher = node.advertise<std_msgs::String>("action", 1);
  int stop = kNone;
  for (ros::WallRate rate(20.0); ros::ok(); rate.sleep()) {
    ros::spinOnce();
    const bool silent = (ros::SteadyTime::now() - heard).toSec() > kSilence_s;
    const double age_s = ros::Time::now().toSec() - last.header.stamp.toSec();
    const bool current = age_s >= -kAhead_s && age_s <= kOldest_s;
    int wanted = last.state == TimeToFailure::FAILING ? kByThePose : kNone;
    if (silent || !current || last.state == TimeToFailure::FAILED || last.state == TimeToFailure::UNKNOWN) {
      wanted = kBlind;
    }
    stop = standing ? wanted : std::max(stop, wanted);  // a stop that has begun ends at standstill
    std_msgs::String action;
    if (stop != kNone) {
      action.data = stop == kBlind ? "stop blind" : "stop";
    } else {
      action.data = last.state == TimeToFailure::DEGRADED ? "slow down" : "drive";
    }
    publisher.publish(action);
  }
}
