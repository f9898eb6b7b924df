// Checks that the stamps come from the clock of ROS time. Message ages, silence detection and a planner's use of a
// stamp depend on it. Stamps since power-on, a lidar clock that nobody sets and a recording played without /clock would
// otherwise look healthy.
#pragma once

#include <ros/time.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "core/moving_median.hpp"
#include "stamps.hpp"

namespace fail_aware {

class ClockCheck {
 public:
  static constexpr double kOldest_s = 5.0;  ///< age on arrival that no driver and no queue reaches
  static constexpr double kAhead_s = 0.5;
  static constexpr std::size_t kStampsKept = 11;

  /// Call for each message on arrival.
  void heard(const ros::Time& stamp, const ros::Time& now = ros::Time::now()) {
    if (stamp.isZero()) return;  // no stamp
    ages_s_.add(secondsFrom(stamp, now));
  }

  /// Median age of the last messages on arrival, s; NaN: no message yet.
  double age_s() const { return ages_s_.size() == 0 ? std::nan("") : ages_s_.median(); }

  /// One line for the user; empty: no fault.
  std::string fault(bool sim_time = ros::Time::isSimTime(), const ros::Time& now = ros::Time::now()) const {
    if (sim_time && now.isZero()) {
      return "use_sim_time is set and nothing publishes /clock, so ROS time stays 0: play with rosbag play --clock, or "
             "set use_sim_time to false and start anew";
    }
    const double age = age_s();
    if (!(age > kOldest_s || age < -kAhead_s)) return "";
    char text[320];
    std::snprintf(text, sizeof text,
                  "stamps and ROS time are different clocks: a stamp is %.4g s %s when it comes; set the lidar's clock "
                  "(PTP, or stamps of the host), or play recordings with use_sim_time and rosbag play --clock",
                  std::abs(age), age > 0.0 ? "old" : "ahead");
    return text;
  }

 private:
  MovingMedian ages_s_{kStampsKept};
};

}  // namespace fail_aware
