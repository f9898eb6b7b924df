#include "trajectory_service.hpp"

#include <filesystem>
#include <stdexcept>

#include "bridge/parameter_server.hpp"

namespace fail_aware {

TrajectoryService::TrajectoryService(ros::NodeHandle private_node, const std::string& file, std::size_t max_poses)
    : private_node_(private_node), file_(file), trajectory_(max_poses) {
  private_node.setCallbackQueue(&queue_);
  service_ = private_node.advertiseService("save_trajectory", &TrajectoryService::onSave, this);
  spinner_.start();
}

TrajectoryService::~TrajectoryService() {
  spinner_.stop();  // waits for a running callback
}

void TrajectoryService::add(double stamp_s, const Pose& T_odom_base) {
  const std::lock_guard<std::mutex> lock(mutex_);
  trajectory_.add(stamp_s, T_odom_base);
}

void TrajectoryService::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  trajectory_.clear();
}

bool TrajectoryService::onSave(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  // the parameter may have changed since the start
  const std::string file = readText(private_node_, "trajectory_file", file_);
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(file, error);
  std::unique_lock<std::mutex> lock(mutex_);
  const TrajectoryRecord trajectory = trajectory_;
  lock.unlock();
  try {
    if (trajectory.size() == 0) throw std::runtime_error("there is no pose yet");
    trajectory.save(path.string());
    response.success = true;
    response.message = path.string() + ": " + std::to_string(trajectory.size()) + " poses";
    if (trajectory.forgotten() > 0) {
      response.message +=
          " (the first " + std::to_string(trajectory.forgotten()) + " were forgotten, see trajectory_max_poses)";
    }
  } catch (const std::exception& failure) {
    response.success = false;
    response.message = failure.what();
  }
  return true;
}

}  // namespace fail_aware
