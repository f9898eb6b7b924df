// Receives the clouds for FusionUkf. A cloud is passed on if the lidar's mounting is known and belongs to the cloud's
// frame. Until it is known the last few clouds wait: the transform may arrive later; a bag has it at the stamp of the
// first cloud. Failure: clouds that waited in vain are counted; a cloud of another frame is refused (SweepScheduler
// counts it). Single-threaded.
#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>

#include "clock_check.hpp"
#include "core/estimation/sweep_scheduler.hpp"
#include "lidar_place.hpp"

namespace fail_aware {

class CloudIntake {
 public:
  using Accept = std::function<void(const std_msgs::Header&)>;

  /// `accept` receives the header of each passed cloud, in order.
  CloudIntake(SweepScheduler& scheduler, Accept accept) : scheduler_(scheduler), accept_(std::move(accept)) {}

  void take(const std_msgs::Header& cloud) {
    heard_at_ = ros::SteadyTime::now();
    clock_.heard(cloud.stamp);
    const LidarPlace::Answer answer = lidar_.find(cloud.frame_id);
    if (answer == LidarPlace::Answer::kNoTransform) return hold(cloud);
    if (answer == LidarPlace::Answer::kKnown) release();
    pass(cloud, answer);
  }
  /// Passes the waiting clouds on if the mounting is known now.
  void retry() {
    if (!held_.empty() && lidar_.find(held_.back().frame_id) == LidarPlace::Answer::kKnown) release();
  }
  /// A new drive: the waiting clouds are lost.
  void clear() {
    lost_ += held_.size();
    held_.clear();
  }

  LidarPlace& lidar() { return lidar_; }
  const LidarPlace& lidar() const { return lidar_; }
  /// Number of clouds that waited in vain.
  std::size_t lost() const { return lost_; }
  /// Arrival of the last cloud, whether it was passed on or not; zero: no cloud yet.
  const ros::SteadyTime& heardAt() const { return heard_at_; }
  const ClockCheck& clock() const { return clock_; }

 private:
  static constexpr std::size_t kHeld = 3;  ///< less than the number of clouds that SweepCorrection keeps

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
  ClockCheck clock_;  ///< of the clouds' stamps
};

}  // namespace fail_aware
