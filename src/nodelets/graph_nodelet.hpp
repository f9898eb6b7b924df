// What every nodelet of the graph does in the same way: it loads, and it reports its health.
//
// Failure: the nodelet manager keeps to itself why a nodelet could not be loaded. What load() throws (a parameter's name
// and rule) therefore goes into the log first, and then on to the manager, which must not take the nodelet for loaded.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>

#include <exception>
#include <memory>
#include <string>

#include "open_queue.hpp"

namespace fail_aware {

/// A nodelet's diagnostics: one status, told once a second by the steady clock (the updater has no timer of its own).
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

class GraphNodelet : public nodelet::Nodelet {
 protected:
  /// Parameters, publishers, subscribers. Runs in the manager's thread, while callbacks may come in another one already.
  virtual void load() = 0;
  virtual void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;

  /// Calls diagnose() once a second. The nodelet's last member, so that it is destroyed first.
  std::unique_ptr<Health> reportHealth(const std::string& task) {
    return std::make_unique<Health>(getNodeHandle(), getPrivateNodeHandle(), getName(), task,
                                    [this](diagnostic_updater::DiagnosticStatusWrapper& status) { diagnose(status); });
  }

 private:
  void onInit() final {
    openQueue(getSTCallbackQueue());
    try {
      load();
    } catch (const std::exception& error) {
      ROS_FATAL("%s is not loaded: %s", getName().c_str(), error.what());
      throw;
    }
  }
};

}  // namespace fail_aware
