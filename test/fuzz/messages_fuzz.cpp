// Any content of each message that a nodelet listens to -> core, as the nodelets call it, over some sweeps -> what is
// published of it: no NaN, no infinity; covariances are symmetric and have no negative variance.
#include "fail_aware_lidar_odometry/FilterState.h"
#include "fail_aware_lidar_odometry/PoseMeasurement.h"
#include "fail_aware_lidar_odometry/SweepCheck.h"
#include "fail_aware_lidar_odometry/SweepPrediction.h"
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <ros/serialization.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "../../src/nodelets/pose_message.hpp"
#include "../support/message_numbers.hpp"
#include "bridge/graph_message_conversion.hpp"
#include "bridge/marker_conversion.hpp"
#include "bridge/monitor_message_conversion.hpp"
#include "bridge/odometry_conversion.hpp"
#include "core/estimation/external_pose.hpp"
#include "core/estimation/increment_covariance.hpp"
#include "core/estimation/pose_setting.hpp"
#include "core/integrity/monitor.hpp"
#include "core/pipeline_parameters.hpp"
#include "core/preprocessing/sweep_corrector.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fuzz_input.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

namespace {

/// Stands for ROS's input stream: fields from the fuzzer, lists short enough for memory (what ROS itself refuses or not
/// is no matter of this package). Rotations and covariances are mostly such: of any numbers hardly one would be.
class FieldSource {
 public:
  FieldSource(const std::uint8_t* data, std::size_t size) : input_(data, size) {}

  template <class Message>
  Message message() {
    Message message;
    ros::serialization::deserialize(*this, message);
    return message;
  }
  FuzzInput& input() { return input_; }

  // What the messages' generated serializers call.
  template <class T>
  void next(T& value) {
    if constexpr (ros::message_traits::IsMessage<T>::value) {
      ros::serialization::deserialize(*this, value);
    } else if constexpr (std::is_floating_point_v<T>) {
      value = static_cast<T>(number());
    } else {
      value = input_.any<T>();
    }
  }
  void next(std::string& text) { text = input_.text(20); }
  void next(ros::Time& time) {
    next(time.sec);
    time.nsec = input_.below(1000000000);
  }
  void next(geometry_msgs::Quaternion& q) {
    double* const numbers[] = {&q.x, &q.y, &q.z, &q.w};
    if (input_.oneIn(16)) {
      for (double* value : numbers) *value = number();
      return;
    }
    Eigen::Vector4d some(input_.any<std::int8_t>(), input_.any<std::int8_t>(), input_.any<std::int8_t>(), 128.0);
    some.normalize();
    for (int i = 0; i < 4; ++i) *numbers[i] = some[i];
  }
  void next(boost::array<double, 36>& covariance) {
    if (input_.oneIn(16)) {
      for (double& value : covariance) value = number();
      return;
    }
    // variances of ten powers of ten, and one direction that is known worse
    Vector6d variances, direction;
    for (int i = 0; i < 6; ++i) variances[i] = std::pow(10.0, input_.within(-12.0, 6.0));
    for (int i = 0; i < 6; ++i) direction[i] = input_.any<std::int8_t>() / 16.0;
    Matrix6d C = direction * direction.transpose();
    C.diagonal() += variances;
    covariance = toCovarianceMessage(C);
  }
  template <class T, std::size_t N>
  void next(boost::array<T, N>& values) {
    for (T& value : values) next(value);
  }
  template <class T>
  void next(std::vector<T>& values) {
    values.resize(input_.below(6));
    for (T& value : values) next(value);
  }

 private:
  double number() {
    const double usual[] = {0.0, 0.0,   1.0,    -1.0,         0.1,      10.0,     1e-9,
                            1e9, 1e300, -1e300, std::nan(""), HUGE_VAL, -HUGE_VAL};
    const std::uint32_t kind = input_.below(32);
    if (kind == 0) return input_.any<double>();
    return kind < 8 ? input_.pick(usual) : input_.within(-10.0, 10.0);
  }

  FuzzInput input_;
};

// ---- promises -------------------------------------------------------------------------------------------------------

bool finite(const Pose& T) { return T.matrix().allFinite(); }

template <class Message>
void promiseFinite(const Message& message) {
  const std::string which = numbersNotFinite(message);
  promise(which.empty(),
          (std::string("what is published is finite: ") + ros::message_traits::datatype(message) + which).c_str());
}

void promiseCovariance(const Matrix6d& C, const char* what) {
  promise(C.allFinite(), what);
  promise((C - C.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * C.cwiseAbs().maxCoeff(), what);
  promise(C.diagonal().minCoeff() >= 0.0, what);
}

void promiseTime(double time_s, double horizon_s) {
  promise(time_s == -1.0 || (time_s >= 0.0 && time_s <= horizon_s), "a time to failure in its range");
}

void promiseTimes(const messages::TimeToFailure& out) {
  promiseFinite(out);
  promiseTime(out.time_to_failure, out.horizon);
  promiseTime(out.time_to_failure_indicator, out.horizon);
  promiseTime(out.time_to_failure_covariance, out.horizon);
  promise(out.protection_level == -1.0 || out.protection_level >= 0.0, "a protection level in its range");
  promise(out.sigma_x >= 0.0 && out.sigma_y >= 0.0, "sigmas are not negative");
  promise(out.state <= messages::TimeToFailure::FAILED, "a state that has a name");
}

// ---- one message, as its nodelet takes it ---------------------------------------------------------------------------

/// Making one takes milliseconds.
FailAwareMonitor freshMonitor() {
  static const FailAwareMonitor fresh{MonitorParameters()};
  return fresh;
}

/// fail_aware_monitor's.
messages::TimeToFailure monitored(FailAwareMonitor& monitor, const MonitorParameters& params,
                                  const messages::FilterState& message) {
  const std::optional<FilterState> state = fromMessage(message);
  if (!state) return {};
  const MonitorOutput output = monitor.update(*state, conditionOf(message));
  const Eigen::Vector3d position = state->T_odom_cog.translation();
  promiseFinite(
      uncertaintyMarkers(monitor.horizontalCovarianceOdom(), position, params.predictor.alert_limit_m, message.header));
  promiseFinite(timeToFailureMarker(output, position, message.header));
  return toMessage(output, params, message.header);
}

void monitor(FieldSource& source) {
  static const MonitorParameters params;
  FailAwareMonitor monitor = freshMonitor();
  monitor.start();
  for (int sweep = 0; sweep < 4; ++sweep) {
    promiseTimes(monitored(monitor, params, source.message<messages::FilterState>()));
  }
}

/// sweep_correction's, over some sweeps of which it learns.
void predictions(FieldSource& source) {
  PipelineParameters params;
  params.sensor.azimuth.angle_deg = params.sensor.vertical_angle.angle_deg = 0.25;
  SweepCorrector corrector(params.sensor.vertical_angle, params.sensor.azimuth, params.sensor.correctedTiming(),
                           params.profile.sweep_correction, params.profile.vertical_reference);
  for (int sweeps = 0; sweeps < 3; ++sweeps) {
    const std::optional<SweepTask> task = fromMessage(source.message<messages::SweepPrediction>());
    if (!task) continue;
    promise(finite(task->prediction.T_odom_cog) && finite(task->T_cog_lidar), "a prediction's poses are finite");
    Sweep sweep;
    sweep.stamp_s = task->prediction.stamp_s;
    for (std::uint32_t points = source.input().below(40); points > 0; --points) {
      const double azimuth = source.input().within(-3.1, 3.1), range_m = source.input().within(1.0, 120.0);
      sweep.points_lidar.emplace_back(
          Eigen::Vector3d(range_m * std::cos(azimuth), range_m * std::sin(azimuth), source.input().within(-2.0, 2.0))
              .cast<float>());
    }
    CorrectedSweep corrected;
    const SweepCorrectorReport report = corrector.correct(sweep, task->prediction, task->T_cog_lidar, corrected);
    promise(corrected.points_lidar.size() == sweep.size(), "a corrected point for each");
    for (const auto& point : corrected.points_lidar) promise(point.allFinite(), "corrected points are finite");
    for (const float time_s : corrected.times_s) promise(std::isfinite(time_s), "times are finite");
    promise(std::isfinite(report.middle_s), "the middle is finite");
  }
}

Measurement measurement(const messages::PoseMeasurement& message) {
  const Measurement measurement = fromMessage(message);
  promise(std::isfinite(measurement.rms_residual_m) && std::isfinite(measurement.inlier_ratio) &&
              std::isfinite(measurement.seed_spread_m) && std::isfinite(measurement.min_information_ratio),
          "a measurement's numbers are finite");
  promise(measurement.T_odom_cog.linear().allFinite(), "a measurement's rotation is finite");
  return measurement;
}

std::optional<ExternalPose> externalPose(const geometry_msgs::PoseWithCovarianceStamped& message, double stamp_s) {
  const std::optional<Pose> T_odom_base = fromMessage(message.pose.pose);
  if (!T_odom_base) return std::nullopt;
  promise(finite(*T_odom_base), "a pose is finite");
  const ExternalPose pose{stamp_s, *T_odom_base, fromMessage(message.pose.covariance)};
  if (!unusableReason(pose).empty()) return std::nullopt;
  return pose;
}

Measurement externalMeasurement(const ExternalPose& pose, const SweepPrediction& prediction, const Pose& T_base_cog) {
  const std::optional<Vector6d> twist = twistFromIncrement(prediction.T_previous_now(), prediction.dt_s);
  const Measurement measurement = fail_aware::externalMeasurement(pose, prediction.stamp_s, prediction.T_odom_cog,
                                                                  twist.value_or(Vector6d::Zero()), T_base_cog);
  promise(finite(measurement.T_odom_cog), "a measurement is finite");
  promiseCovariance(measurement.covariance, "a measurement's covariance is one");
  return measurement;
}

// ---- some sweeps of fusion_ukf, with the monitor behind it ----------------------------------------------------------

/// Half of them near the prediction, so that they pass the gate.
geometry_msgs::Pose nearOrAny(FieldSource& source, const geometry_msgs::Pose& any, const Pose& T_predicted) {
  if (source.input().flag()) return any;
  Vector6d offset;
  for (int i = 0; i < 6; ++i) offset[i] = source.input().any<std::int8_t>() / 512.0;
  return toPoseMessage(T_predicted * poseFromVector(offset));
}

SweepAccount account(FieldSource& source, const SweepPrediction& prediction, const Pose& T_base_cog) {
  SweepAccount account;
  for (const char* name : {kIcpPointToPoint, kIcpPointToPlane, kCornerSvd}) {
    SweepAccount::Source answer{name, std::nullopt};
    if (source.input().flag()) {
      auto message = source.message<messages::PoseMeasurement>();
      if (source.input().flag()) message.status = messages::PoseMeasurement::OK;
      message.pose = nearOrAny(source, message.pose, prediction.T_odom_cog);
      answer.measurement = measurement(message);
    }
    account.sources.push_back(answer);
  }
  SweepAccount::Source external{"gps", std::nullopt, false, FusionInput::Kind::kExternal};
  if (prediction.motionKnown() && source.input().flag()) {
    auto message = source.message<geometry_msgs::PoseWithCovarianceStamped>();
    message.pose.pose = nearOrAny(source, message.pose.pose, prediction.T_odom_cog * T_base_cog.inverse());
    const std::optional<ExternalPose> pose =
        externalPose(message, prediction.stamp_s + source.input().within(-0.1, 0.1));
    if (pose) external.measurement = externalMeasurement(*pose, prediction, T_base_cog);
  }
  account.sources.push_back(external);
  if (source.input().flag()) account.findings = fromMessage(source.message<messages::SweepCheck>());
  return account;
}

void promiseState(const FilterState& state) {
  promiseCovariance(state.covariance, "the filter's covariance is one");
  promiseCovariance(state.increment_covariance, "an increment's covariance is one");
  promiseCovariance(state.motion_covariance, "a motion's covariance is one");
  if (state.registered) promiseCovariance(state.registration_covariance, "a registration's covariance is one");
  promiseCovariance(state.fusion.R, "what is fused has a covariance");
  for (const double weight : state.fusion.weights) promise(weight >= 0.0 && weight <= 1.0, "weights are in 0..1");
  promise(state.speed_error.variance_m2_s2 >= 0.0, "a variance is not negative");
}

void drive(FieldSource& source) {
  static const PipelineParameters params;
  const ProfileParameters& profile = params.profile;
  const Pose T_base_cog = params.vehicle.T_base_cog();
  PoseFilter filter(profile.filter, VehicleModel(params.vehicle.dynamics, profile.model), profile.history,
                    profile.fusion);
  filter.reset(T_base_cog);
  OdometryCovariance covariance(profile.monitor.drift);
  FailAwareMonitor monitor = freshMonitor();
  monitor.start();
  std_msgs::Header header;
  header.frame_id = "odom";
  header.stamp.sec = 1600000000;
  for (std::uint32_t sweeps = 2 + source.input().below(10); sweeps > 0; --sweeps) {
    const double intervals_s[] = {0.1, 0.1, 0.1, 0.1, 0.05, 0.2, 1.0, 1e-6, 0.0, 100.0};
    const ros::Time previous = header.stamp;
    header.stamp += ros::Duration(source.input().pick(intervals_s));
    SweepTask task;
    if (!filter.predict(header.stamp.toSec(), task.prediction)) continue;
    const messages::SweepPrediction prediction = toMessage(task, header, previous);
    promiseFinite(prediction);
    promise(fromMessage(prediction).has_value(), "a prediction can be read");
    promiseCovariance(task.prediction.covariance, "a prediction's covariance is one");

    const SweepAccount sweep = account(source, task.prediction, T_base_cog);
    std::vector<FusionInput> inputs;
    for (const SweepAccount::Source& one : sweep.sources) {
      inputs.push_back({one.name, one.measurement ? &*one.measurement : nullptr, one.kind});
    }
    const Pose T_odom_cog_previous = filter.state().T_odom_cog;
    const FilterState& state = filter.correct(inputs, sweep.findings.value_or(SweepFindings()));
    promiseState(state);
    if (state.dt_s > 0.0) covariance.propagate(T_odom_cog_previous, state.T_odom_cog, incrementOf(state));
    promiseCovariance(covariance.covariance(), "the odometry's covariance is one");
    const messages::FilterState message = toMessage(state, sweep, header);
    promiseFinite(message);
    promise(fromMessage(message).has_value(), "a filter state can be read");
    promiseFinite(toOdometryMessage(state, covariance.covariance(), T_base_cog, "odom", "base_link"));
    promiseTimes(monitored(monitor, profile.monitor, message));

    if (!source.input().oneIn(4)) continue;
    auto set = source.message<geometry_msgs::PoseWithCovarianceStamped>();
    set.header.frame_id = "odom";
    set.header.stamp = header.stamp + ros::Duration(source.input().within(-0.5, 0.5));
    PoseSetting setting;
    std::string reason;
    const std::optional<ExternalPose> said = poseInOdom(set, "odom", reason);
    if (!said || !setting.offer(*said, header.stamp.toSec()).empty() || !setting.outdated(state).empty()) continue;
    const PoseSetting::AtEstimate at = setting.take(state, T_base_cog);
    if (!filter.setPose(at.T_odom_cog)) continue;
    covariance.reset(at.covariance);
    promiseState(filter.state());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FieldSource source(data, size);
  switch (source.input().below(6)) {
    case 0: predictions(source); break;
    case 1: measurement(source.message<messages::PoseMeasurement>()); break;
    case 2: monitor(source); break;
    case 3: {
      const auto message = source.message<geometry_msgs::PoseWithCovarianceStamped>();
      SweepPrediction prediction;
      prediction.stamp_s = 0.1;
      prediction.dt_s = 0.1;
      if (const auto pose = externalPose(message, 0.05)) externalMeasurement(*pose, prediction, Pose::Identity());
      break;
    }
    default: drive(source);
  }
  return 0;
}
