// Which clouds become sweeps: stamps must advance, and only a few may wait for the one in work. What is refused is
// counted by its cause, and counts as dropped before the next estimate.
#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include <cstddef>
#include <deque>
#include <optional>

#include "stamps.hpp"

namespace fail_aware {

class SweepIntake {
 public:
  enum class Verdict {
    kQueued,
    kRefused,
    kJumpedBack  ///< further back than max_reorder_s: start anew, then offer it again
  };
  struct Counts {
    std::size_t overload = 0, duplicate = 0, reordered = 0, unusable_stamp = 0, wrong_frame = 0, reset = 0;
  };

  void setLimits(std::size_t queue_size, double max_reorder_s) {
    queue_size_ = queue_size;
    max_reorder_s_ = max_reorder_s;
  }

  Verdict offer(const std_msgs::Header& header) {
    if (header.stamp.isZero()) {
      refuseStamp();
      return Verdict::kRefused;
    }
    if (!newest_.isZero() && header.stamp <= newest_) {
      if (behind_s(header.stamp) > max_reorder_s_) return Verdict::kJumpedBack;
      lose(header.stamp == newest_ ? counts_.duplicate : counts_.reordered);
      return Verdict::kRefused;
    }
    newest_ = header.stamp;
    waiting_.push_back(header);
    if (waiting_.size() > queue_size_) {
      waiting_.pop_front();
      lose(counts_.overload);
    }
    return Verdict::kQueued;
  }

  void refuseStamp() { lose(counts_.unusable_stamp); }
  void refuseFrame() { lose(counts_.wrong_frame); }

  double behind_s(const ros::Time& stamp) const { return secondsFrom(stamp, newest_); }

  std::optional<std_msgs::Header> next() {
    if (waiting_.empty()) return std::nullopt;
    const std_msgs::Header header = waiting_.front();
    waiting_.pop_front();
    return header;
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
    newest_ = ros::Time();
    dropped_ = 0;
  }

  const Counts& counts() const { return counts_; }

 private:
  void lose(std::size_t& cause) {
    ++cause;
    ++dropped_;
  }

  std::size_t queue_size_ = 3;
  double max_reorder_s_ = 0.5;
  std::deque<std_msgs::Header> waiting_;
  ros::Time newest_;  ///< accepted
  int dropped_ = 0;
  Counts counts_;
};

}  // namespace fail_aware
