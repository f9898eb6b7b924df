// Base class of the graph's nodelets: loading and health reports.
//
// Failure: the nodelet manager does not report why a nodelet could not be loaded. An exception of load() (with a
// parameter's name and rule) is therefore logged first and then passed to the manager, which must not consider the
// nodelet loaded.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>

#include <exception>
#include <memory>
#include <string>

#include "load_failures.hpp"
#include "open_queue.hpp"

namespace fail_aware {

/// A nodelet's diagnostics: one status, published once a second by the steady clock (the updater has no timer).
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
  /// Sets up parameters, publishers, subscribers. Runs in the manager's thread, callbacks maybe already in another.
  virtual void load() = 0;
  virtual void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;

  /// Calls diagnose() once a second. Keep the result as the nodelet's last member, so that it is destroyed first.
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
      static LoadFailures failures;  // of all nodelets of this manager
      ROS_FATAL("%s", failures.line(getName(), error.what()).c_str());
      throw;
    }
  }
};

}  // namespace fail_aware
