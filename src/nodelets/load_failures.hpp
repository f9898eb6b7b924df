// The lines in the log about nodelets that cannot be loaded. A wrong key in profile, vehicle or sensor stops all six:
// the first one says why, and the others refer to it. Thread-safe.
#pragma once

#include <ros/time.h>

#include <map>
#include <mutex>
#include <string>

namespace fail_aware {

class LoadFailures {
 public:
  static constexpr double kSameLaunch_s = 10.0;  ///< after this time the reason is logged in full again

  std::string line(const std::string& nodelet, const std::string& reason,
                   const ros::SteadyTime& now = ros::SteadyTime::now()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    Told& told = told_[reason];
    const bool known = !told.nodelet.empty() && (now - told.at).toSec() < kSameLaunch_s;
    if (known && told.nodelet != nodelet) return nodelet + " is not loaded: for the same reason as " + told.nodelet;
    told = {nodelet, now};
    return nodelet + " is not loaded: " + reason;
  }

 private:
  struct Told {
    std::string nodelet;
    ros::SteadyTime at;
  };

  std::mutex mutex_;
  std::map<std::string, Told> told_;  ///< by reason
};

}  // namespace fail_aware
