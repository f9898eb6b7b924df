// Which clouds become sweeps: stamps must advance, and only a few may wait for the one in work. What is refused is
// counted by its cause, and counts as dropped before the next estimate.
//
// The queue is for a sweep that takes longer now and then. Each overflow lets one sweep fewer wait, at last only the
// newest, until none waits: whoever cannot follow for long skips sweeps in any case, and so his estimates are not late.
#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "fail_aware_lidar_odometry/core/sweep/stamp_order.hpp"
#include "stamps.hpp"

namespace fail_aware {

class SweepIntake {
 public:
  enum class Verdict {
    kQueued,
    kRefused,
    kNewDrive  ///< stamps jumped (stamp_order.hpp): start anew, then offer it again
  };
  struct Waiting {
    std_msgs::Header header;
    ros::SteadyTime arrived;
    double set_back_s = 0.0;  ///< as SweepPrediction's
  };
  struct Counts {
    std::size_t overload = 0, duplicate = 0, reordered = 0, far_ahead = 0, unusable_stamp = 0, wrong_frame = 0,
                reset = 0;
  };

  void setLimits(std::size_t queue_size, double max_reorder_s) {
    queue_size_ = may_wait_ = queue_size;
    stamps_.setMaxReorder(max_reorder_s);
  }

  Verdict offer(const std_msgs::Header& header, const ros::SteadyTime& arrived = ros::SteadyTime()) {
    if (!isUsable(header.stamp)) {
      refuseStamp();
      return Verdict::kRefused;
    }
    if (!newest_.isZero()) {
      switch (stamps_.next(since_newest_s(header.stamp))) {
        case StampOrder::kAdvances: break;
        case StampOrder::kSame: refuse(counts_.duplicate, "duplicate stamp"); return Verdict::kRefused;
        case StampOrder::kReordered: refuse(counts_.reordered, "stamp out of order"); return Verdict::kRefused;
        case StampOrder::kFarAhead: refuse(counts_.far_ahead, "stamp far ahead"); return Verdict::kRefused;
        case StampOrder::kJumpedBack:
        case StampOrder::kJumpedAhead: return Verdict::kNewDrive;
      }
    }
    newest_ = header.stamp;
    waiting_.push_back({header, arrived, stamps_.setBack_s()});
    if (waiting_.size() > may_wait_) may_wait_ = std::max<std::size_t>(1, may_wait_ - 1);
    while (waiting_.size() > may_wait_) {
      const double set_back_s = waiting_.front().set_back_s;
      waiting_.pop_front();
      waiting_.front().set_back_s = std::max(waiting_.front().set_back_s, set_back_s);
      lose(counts_.overload);
    }
    return Verdict::kQueued;
  }

  void refuseStamp() { refuse(counts_.unusable_stamp, "stamp not usable"); }
  void refuseFrame() { refuse(counts_.wrong_frame, "another frame"); }

  double since_newest_s(const ros::Time& stamp) const { return secondsFrom(newest_, stamp); }

  /// To be asked when no sweep is in work.
  std::optional<Waiting> next() {
    if (waiting_.empty()) {
      may_wait_ = queue_size_;
      return std::nullopt;
    }
    const Waiting waiting = waiting_.front();
    waiting_.pop_front();
    return waiting;
  }

  /// Sweeps lost since this was last asked.
  int takeDropped() {
    const int dropped = dropped_;
    dropped_ = 0;
    return dropped;
  }

  /// A new start: what waits, and the sweep in work if there is one, are lost by it. The counts stay.
  void clear(bool in_work = false) {
    counts_.reset += waiting_.size() + (in_work ? 1 : 0);
    waiting_.clear();
    may_wait_ = queue_size_;
    newest_ = ros::Time();
    stamps_.beginDrive();
    dropped_ = 0;
  }

  const Counts& counts() const { return counts_; }

  /// Why the last cloud that was refused was; empty if none was.
  const std::string& lastRefused() const { return last_refused_; }

 private:
  /// Not at the end of time: others add to stamps (tf2: 10 s), which throws there.
  static bool isUsable(const ros::Time& stamp) {
    constexpr std::uint32_t kHour_s = 3600;
    return !stamp.isZero() && stamp.nsec < 1000000000u && stamp.sec < ros::TIME_MAX.sec - kHour_s;
  }

  void refuse(std::size_t& cause, const char* why) {
    last_refused_ = why;
    lose(cause);
  }
  void lose(std::size_t& cause) {
    ++cause;
    ++dropped_;
  }

  std::size_t queue_size_ = 3;
  std::size_t may_wait_ = 3;  ///< now
  std::deque<Waiting> waiting_;
  ros::Time newest_;  ///< accepted
  StampSequence stamps_;
  int dropped_ = 0;
  std::string last_refused_;
  Counts counts_;
};

}  // namespace fail_aware
