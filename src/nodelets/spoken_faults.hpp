// Faults in the log: per kind at most one line every 10 s, by the steady clock (ROS_WARN_THROTTLE is silent while ROS
// time stands still). Call it for every occurrence, from one thread.
#pragma once

#include <ros/console.h>
#include <ros/time.h>

#include <cstddef>
#include <map>
#include <string>
#include <utility>

namespace fail_aware {

class SpokenFaults {
 public:
  static constexpr double kPeriod_s = 10.0;

  explicit SpokenFaults(std::string name) : name_(std::move(name)) {}

  /// Empty text: no fault, no line.
  void say(const std::string& kind, const std::string& text, const ros::SteadyTime& now = ros::SteadyTime::now()) {
    if (text.empty() || !isDue(kinds_[kind], now)) return;
    ROS_WARN("%s: %s", name_.c_str(), text.c_str());
  }

  /// `total`: number of occurrences so far. Reports the increase since the last line of this kind.
  void count(const std::string& kind, std::size_t total, const ros::SteadyTime& now = ros::SteadyTime::now()) {
    Kind& known = kinds_[kind];
    if (total <= known.said || !isDue(known, now)) return;
    ROS_WARN("%s: %s: %zu since the last such line, %zu in all", name_.c_str(), kind.c_str(), total - known.said,
             total);
    known.said = total;
  }

 private:
  struct Kind {
    ros::SteadyTime last;
    std::size_t said = 0;
  };

  static bool isDue(Kind& kind, const ros::SteadyTime& now) {
    if (!kind.last.isZero() && (now - kind.last).toSec() < kPeriod_s) return false;
    kind.last = now;
    return true;
  }

  std::string name_;
  std::map<std::string, Kind> kinds_;
};

}  // namespace fail_aware
