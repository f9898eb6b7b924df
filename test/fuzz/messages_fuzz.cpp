// Any content of each message that a nodelet listens to -> core -> what is published of it: no NaN, no infinity.
#include <fail_aware_lidar_odometry/FilterState.h>
#include <fail_aware_lidar_odometry/PoseMeasurement.h>
#include <fail_aware_lidar_odometry/SweepCheck.h>
#include <fail_aware_lidar_odometry/SweepPrediction.h>
#include <fuzzer/FuzzedDataProvider.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <ros/serialization.h>

#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/core/fail_aware/monitor.hpp"
#include "fail_aware_lidar_odometry/core/fusion/external_pose.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

namespace {

/// Stands for ROS's input stream: fields from the fuzzer, lists short enough for memory (what ROS itself refuses or not
/// is no matter of this package).
class FieldSource {
 public:
  FieldSource(const std::uint8_t* data, std::size_t size) : input_(data, size) {}

  template <class Message>
  Message message() {
    Message message;
    ros::serialization::deserialize(*this, message);
    return message;
  }
  FuzzedDataProvider& input() { return input_; }

  // What the messages' generated serializers call.
  template <class T>
  void next(T& value) {
    if constexpr (ros::message_traits::IsMessage<T>::value) {
      ros::serialization::deserialize(*this, value);
    } else if constexpr (std::is_floating_point_v<T>) {
      value = static_cast<T>(number());
    } else {
      value = input_.ConsumeIntegral<T>();
    }
  }
  void next(bool& value) { value = input_.ConsumeBool(); }
  void next(std::string& text) { text = input_.ConsumeRandomLengthString(20); }
  void next(ros::Time& time) {
    next(time.sec);
    time.nsec = input_.ConsumeIntegralInRange<std::uint32_t>(0, 999999999);
  }
  void next(ros::Duration& duration) {
    next(duration.sec);
    next(duration.nsec);
  }
  template <class T, std::size_t N>
  void next(boost::array<T, N>& values) {
    for (T& value : values) next(value);
  }
  template <class T>
  void next(std::vector<T>& values) {
    values.resize(input_.ConsumeIntegralInRange<std::size_t>(0, 5));
    for (auto&& value : values) {
      T one{};
      next(one);
      value = one;
    }
  }

 private:
  double number() {
    const double usual[] = {0.0, 0.0, 0.0, 1.0, -1.0, 0.1, 1e-9, 1e9, 1e300, std::nan(""), HUGE_VAL, -HUGE_VAL};
    switch (input_.ConsumeIntegralInRange<int>(0, 2)) {
      case 0: return input_.PickValueInArray(usual);
      case 1: return input_.ConsumeFloatingPointInRange<double>(-10.0, 10.0);
      default: return input_.ConsumeFloatingPoint<double>();
    }
  }

  FuzzedDataProvider input_;
};

bool finite(const Pose& T) { return T.matrix().allFinite(); }

void checkTime(double time_s, double horizon_s) {
  promise(std::isfinite(time_s) && (time_s == -1.0 || (time_s >= 0.0 && time_s <= horizon_s)),
          "a time to failure in its range");
}

void monitor(FieldSource& source) {
  const MonitorParameters params;
  FailAwareMonitor monitor(params);
  monitor.start();
  for (int sweep = 0; sweep < 4; ++sweep) {
    const auto message = source.message<messages::FilterState>();
    const std::optional<FilterState> state = fromMessage(message);
    if (!state) continue;
    const messages::TimeToFailure out = toMessage(monitor.update(*state, conditionOf(message)), params, message.header);
    checkTime(out.time_to_failure, out.horizon);
    checkTime(out.time_to_failure_indicator, out.horizon);
    checkTime(out.time_to_failure_covariance, out.horizon);
    promise(std::isfinite(out.eta) && std::isfinite(out.eta_rate) && std::isfinite(out.sigma_yaw), "eta is finite");
    promise(std::isfinite(out.sigma_x) && std::isfinite(out.sigma_y), "sigmas are finite");
    promise(std::isfinite(out.protection_level) && (out.protection_level == -1.0 || out.protection_level >= 0.0),
            "a protection level in its range");
  }
}

void pose(const geometry_msgs::PoseWithCovarianceStamped& message) {
  const std::optional<Pose> T_odom_base = fromMessage(message.pose.pose);
  if (!T_odom_base) return;
  promise(finite(*T_odom_base), "a pose is finite");
  const ExternalPose pose{message.header.stamp.toSec(), *T_odom_base, fromMessage(message.pose.covariance)};
  if (!unusableReason(pose).empty()) return;
  const Measurement measurement =
      externalMeasurement(pose, pose.stamp_s + 0.05, Pose::Identity(), Vector6d::Constant(1.0), Pose::Identity());
  promise(finite(measurement.T_odom_cog) && measurement.covariance.allFinite(), "a measurement is finite");
}

void prediction(const messages::SweepPrediction& message) {
  const std::optional<SweepTask> task = fromMessage(message);
  if (!task) return;
  promise(finite(task->prediction.T_odom_cog) && finite(task->T_cog_lidar), "a prediction's poses are finite");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FieldSource source(data, size);
  switch (source.input().ConsumeIntegralInRange<int>(0, 4)) {
    case 0: prediction(source.message<messages::SweepPrediction>()); break;
    case 1: fromMessage(source.message<messages::PoseMeasurement>()); break;
    case 2: fromMessage(source.message<messages::SweepCheck>()); break;
    case 3: monitor(source); break;
    default: pose(source.message<geometry_msgs::PoseWithCovarianceStamped>());
  }
  return 0;
}
