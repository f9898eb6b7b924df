// The last few messages of one topic, found by their exact stamp. Bounded: the oldest message is dropped.
#pragma once

#include <ros/time.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

namespace fail_aware {

template <class Value>
class ExactStampBuffer {
 public:
  explicit ExactStampBuffer(std::size_t capacity) : capacity_(capacity) {}

  void push(const ros::Time& stamp, Value value) {
    entries_.emplace_back(stamp, std::move(value));
    if (entries_.size() > capacity_) entries_.pop_front();
  }

  /// Null if there is no message with this stamp.
  Value* find(const ros::Time& stamp) {
    return find(stamp, [](const Value&) { return true; });
  }
  /// The newest message with this stamp for which `fitting` is true.
  template <class Fitting>
  Value* find(const ros::Time& stamp, const Fitting& fitting) {
    const auto at = std::find_if(entries_.rbegin(), entries_.rend(),
                                 [&](const auto& e) { return e.first == stamp && fitting(e.second); });
    return at == entries_.rend() ? nullptr : &at->second;
  }

  /// Drops the message with this stamp and all earlier arrivals; returns the number of the earlier ones.
  std::size_t popThrough(const ros::Time& stamp) {
    std::size_t before = 0;
    while (!entries_.empty()) {
      const bool found = entries_.front().first == stamp;
      entries_.pop_front();
      if (found) break;
      ++before;
    }
    return before;
  }

  /// Removes the messages with earlier stamps and returns them, oldest first.
  std::vector<Value> takeBefore(const ros::Time& stamp) {
    std::vector<Value> before;
    for (; !entries_.empty() && entries_.front().first < stamp; entries_.pop_front()) {
      before.push_back(std::move(entries_.front().second));
    }
    return before;
  }

  void clear() { entries_.clear(); }

 private:
  std::size_t capacity_;
  std::deque<std::pair<ros::Time, Value>> entries_;
};

}  // namespace fail_aware
