// What the tests of the live graph share: waiting for events, and messages kept by stamp.
#pragma once

#include <ros/ros.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace fail_aware {

/// The environment's FAIL_AWARE_TEST_PATIENCE is a factor, for builds that are slow (scripts/test --sanitize).
inline double patienceFactor() {
  const char* factor = std::getenv("FAIL_AWARE_TEST_PATIENCE");
  return factor == nullptr ? 1.0 : std::max(1.0, std::atof(factor));
}

inline const double kPatience_s = 30.0 * patienceFactor();

inline bool waitFor(const std::function<bool()>& condition, double patience_s = kPatience_s) {
  const ros::SteadyTime end = ros::SteadyTime::now() + ros::WallDuration(patience_s);
  while (!condition()) {
    if (!ros::ok() || ros::SteadyTime::now() > end) return false;
    ros::WallDuration(0.005).sleep();
    ros::spinOnce();
  }
  return true;
}

template <class Message>
class Recorder {
 public:
  Recorder(ros::NodeHandle& node, const std::string& topic);

  bool connected() const { return subscriber_.getNumPublishers() > 0; }
  std::size_t count(const ros::Time& stamp) const {
    const auto at = messages_.find(stamp);
    return at == messages_.end() ? 0 : at->second.size();
  }
  void forget(const ros::Time& stamp) { messages_.erase(stamp); }
  const Message& at(const ros::Time& stamp) const { return *messages_.at(stamp).front(); }

 private:
  std::map<ros::Time, std::vector<typename Message::ConstPtr>> messages_;
  ros::Subscriber subscriber_;
};

template <class Message>
Recorder<Message>::Recorder(ros::NodeHandle& node, const std::string& topic)
    : subscriber_(node.subscribe<Message>(topic, 100, [this](const typename Message::ConstPtr& message) {
        messages_[message->header.stamp].push_back(message);
      })) {}

}  // namespace fail_aware
