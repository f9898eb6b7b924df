// Stamp arithmetic that cannot throw. ros::Time's operators throw beyond 68 years; a sensor's stamp can be anything.
#pragma once

#include <ros/time.h>

#include <cstdint>

namespace fail_aware {

inline double secondsFrom(const ros::Time& from, const ros::Time& to) {
  return static_cast<double>(static_cast<std::int64_t>(to.toNSec()) - static_cast<std::int64_t>(from.toNSec())) / 1e9;
}

/// Limited to the end of ros::Time's range.
inline ros::Time later(const ros::Time& stamp, double seconds) {
  const double left_s = secondsFrom(stamp, ros::TIME_MAX);
  if (!(seconds > 0.0)) return stamp;
  if (seconds >= left_s) return ros::TIME_MAX;
  ros::Time sum;
  sum.fromNSec(stamp.toNSec() + static_cast<std::uint64_t>(seconds * 1e9));
  return sum;
}

/// Not zero, not malformed, not at the end of ros::Time's range: others add to stamps (tf2: 10 s), which would throw.
inline bool isUsableStamp(const ros::Time& stamp) {
  constexpr std::uint32_t kHour_s = 3600;
  return !stamp.isZero() && stamp.nsec < 1000000000u && stamp.sec < ros::TIME_MAX.sec - kHour_s;
}

}  // namespace fail_aware
