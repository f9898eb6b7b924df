// The rate of an event since the last query, by the steady clock; for diagnostics.
#pragma once

#include <ros/time.h>

#include <cstddef>

namespace fail_aware {

class RateMeter {
 public:
  void tick() { ++count_; }

  /// Hz since the last call; 0 at the first call.
  double take_hz() {
    const ros::SteadyTime now = ros::SteadyTime::now();
    const double since_s = asked_.isZero() ? 0.0 : (now - asked_).toSec();
    const double rate_hz = since_s > 0.0 ? static_cast<double>(count_) / since_s : 0.0;
    asked_ = now;
    count_ = 0;
    return rate_hz;
  }

 private:
  std::size_t count_ = 0;
  ros::SteadyTime asked_;
};

}  // namespace fail_aware
