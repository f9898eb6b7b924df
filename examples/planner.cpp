// A planner that obeys the time to failure (doc/planner_contract.md). It publishes what the vehicle must do, 20 times a
// second, on ~action: "drive", "slow down", "stop" (follow the pose), "stop blind" (do not use the pose), or
// "own localisation" while the GPS is good. Inputs: ~gps_lost (std_msgs/Bool): true from the loss of the GPS, when
// start_redundant is called, until it is back; ~gps_pose (std_msgs/Header): the header of each good GPS pose; ~standing
// (std_msgs/Bool): the vehicle stands, as its wheels tell.
#include "fail_aware_lidar_odometry/TimeToFailure.h"
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Header.h>
#include <std_msgs/String.h>

#include <algorithm>

using fail_aware_lidar_odometry::TimeToFailure;

namespace {

constexpr double kSilence_s = 0.5;  // without a message: the monitor or its computer has failed
constexpr double kOldest_s = 1.0;   // an older stamp is outdated
constexpr double kAhead_s = 0.1;    // a stamp further in the future comes from another clock
constexpr double kWait_s = 0.5;     // for t1 after the loss of the GPS
enum Stop { kNone = 0, kByThePose = 1, kBlind = 2 };

// SteadyTime is not moved when the system clock is set.
double since_s(const ros::SteadyTime& time) { return (ros::SteadyTime::now() - time).toSec(); }

}  // namespace

class Planner {
 public:
  Planner() : node_("~"), publisher_(node_.advertise<std_msgs::String>("action", 1)) {
    time_ = node_.subscribe<TimeToFailure>("/fail_aware_lidar_odometry/time_to_failure", 1,
                                           [this](const TimeToFailure::ConstPtr& message) { hear(*message); });
    wheels_ = node_.subscribe<std_msgs::Bool>(
        "standing", 1, [this](const std_msgs::Bool::ConstPtr& message) { standing_ = message->data; });
    gps_pose_ = node_.subscribe<std_msgs::Header>("gps_pose", 1, [this](const std_msgs::Header::ConstPtr& header) {
      if (!gps_lost_) gps_pose_at_ = header->stamp;
    });
    gps_ = node_.subscribe<std_msgs::Bool>("gps_lost", 1, [this](const std_msgs::Bool::ConstPtr& message) {
      if (message->data && !gps_lost_) loseGps();
      gps_lost_ = message->data;
    });
  }

  void publishAction() {
    std_msgs::String message;
    message.data = action();
    publisher_.publish(message);
  }

 private:
  void loseGps() {
    lost_since_ = ros::SteadyTime::now();
    lost_at_ = ros::Time::now();
    t1_ = ros::Time();
    pose_lost_ = !isCurrent(gps_pose_at_);  // the drift from this pose to t1 is not in the state
  }

  void hear(const TimeToFailure& message) {
    last_ = message;
    heard_ = ros::SteadyTime::now();
    if (!gps_lost_ || message.t1.isZero()) return;
    if (t1_.isZero() && (lost_at_ - message.t1).toSec() > kOldest_s) {
      last_.state = TimeToFailure::UNKNOWN;  // t1 of an earlier call: the state is not about the pose since this loss
      return;
    }
    if (t1_.isZero()) t1_ = message.t1;
    // a late or new t1: the state does not include the error from the loss of the GPS to it
    pose_lost_ = pose_lost_ || message.t1 != t1_ || t1_ > lost_at_ + ros::Duration(kWait_s);
  }

  const char* action() {
    if (!gps_lost_) {
      stop_ = kNone;
      return "own localisation";
    }
    stop_ = standing_ ? wantedStop() : std::max(stop_, wantedStop());  // a stop that has begun ends at standstill
    if (stop_ != kNone) return stop_ == kBlind ? "stop blind" : "stop";
    return last_.state == TimeToFailure::OK ? "drive" : "slow down";
  }

  Stop wantedStop() const {
    const bool silent = since_s(heard_) > kSilence_s;
    if (pose_lost_ || silent || !isCurrent(last_.header.stamp) || last_.state == TimeToFailure::FAILED) return kBlind;
    if (last_.state == TimeToFailure::UNKNOWN) return since_s(lost_since_) < kWait_s ? kNone : kBlind;
    return last_.state == TimeToFailure::FAILING ? kByThePose : kNone;
  }

  static bool isCurrent(const ros::Time& stamp) {
    const double age_s = ros::Time::now().toSec() - stamp.toSec();
    return age_s >= -kAhead_s && age_s <= kOldest_s;
  }

  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Subscriber time_, wheels_, gps_, gps_pose_;
  TimeToFailure last_;  // UNKNOWN until the first one comes
  ros::SteadyTime heard_, lost_since_;
  ros::Time lost_at_, t1_, gps_pose_at_;
  bool standing_ = false, gps_lost_ = false, pose_lost_ = false;
  Stop stop_ = kNone;
};

int main(int argc, char** argv) {
  ros::init(argc, argv, "planner");
  Planner planner;
  for (ros::WallRate rate(20.0); ros::ok(); rate.sleep()) {
    ros::spinOnce();
    planner.publishAction();
  }
}
