// Takes the clouds in for FusionUkf. A cloud goes on when the lidar's place is known and is that of the cloud's frame. Until
// it is known, the last few clouds wait: the transform may be on its way, a bag has it at the stamp of the first cloud.
// Failure: clouds that waited in vain are counted; another frame is refused (SweepScheduler's count). One thread.
#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>

#include "clock_check.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_scheduler.hpp"
#include "lidar_place.hpp"

namespace fail_aware {

class CloudIntake {
 public:
  using Accept = std::function<void(const std_msgs::Header&)>;

  /// `accept`: takes the header of each cloud that goes on, in their order.
  CloudIntake(SweepScheduler& scheduler, Accept accept) : scheduler_(scheduler), accept_(std::move(accept)) {}

  void take(const std_msgs::Header& cloud) {
    heard_at_ = ros::SteadyTime::now();
    clock_.heard(cloud.stamp);
    const LidarPlace::Answer answer = lidar_.find(cloud.frame_id);
    if (answer == LidarPlace::Answer::kNoTransform) return hold(cloud);
    if (answer == LidarPlace::Answer::kKnown) release();
    pass(cloud, answer);
  }
  /// What waits goes on, if the place is known by now.
  void retry() {
    if (!held_.empty() && lidar_.find(held_.back().frame_id) == LidarPlace::Answer::kKnown) release();
  }
  /// A new drive: what waits is lost.
  void clear() {
    lost_ += held_.size();
    held_.clear();
  }

  LidarPlace& lidar() { return lidar_; }
  const LidarPlace& lidar() const { return lidar_; }
  /// Clouds that waited in vain.
  std::size_t lost() const { return lost_; }
  /// The last cloud, whatever became of it; zero: none came.
  const ros::SteadyTime& heardAt() const { return heard_at_; }
  const ClockCheck& clock() const { return clock_; }

 private:
  static constexpr std::size_t kHeld = 3;  ///< fewer than SweepCorrection keeps clouds

  void hold(const std_msgs::Header& cloud) {
    held_.push_back(cloud);
    if (held_.size() <= kHeld) return;
    held_.pop_front();
    ++lost_;
  }

  void release() {
    std::deque<std_msgs::Header> held;
    held.swap(held_);
    for (const std_msgs::Header& cloud : held) pass(cloud, lidar_.find(cloud.frame_id));
  }

  void pass(const std_msgs::Header& cloud, LidarPlace::Answer answer) {
    if (answer == LidarPlace::Answer::kKnown) return accept_(cloud);
    scheduler_.refuse(SweepScheduler::Cause::kWrongFrame);
  }

  SweepScheduler& scheduler_;
  Accept accept_;
  LidarPlace lidar_;
  std::deque<std_msgs::Header> held_;
  std::size_t lost_ = 0;
  ros::SteadyTime heard_at_;
  ClockCheck clock_;  ///< of the stamps
};

}  // namespace fail_aware
