// A nodelet's diagnostics: one status, told once a second by the steady clock (the updater has no timer of its own).
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <string>

namespace fail_aware {

class Health {
 public:
  Health(ros::NodeHandle& node, ros::NodeHandle& private_node, const std::string& nodelet_name, const std::string& task,
         const diagnostic_updater::TaskFunction& say)
      : updater_(node, private_node, nodelet_name) {
    updater_.setHardwareID("none");
    updater_.add(task, say);
    timer_ = node.createSteadyTimer(ros::WallDuration(1.0),
                                    [this](const ros::SteadyTimerEvent&) { updater_.force_update(); });
  }

 private:
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace fail_aware
