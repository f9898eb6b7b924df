// The fail-aware monitor in the live graph (core/fail_aware/monitor.hpp).
// In: filter_state. Out: time_to_failure, one for every filter state and, when there is none for stale_sweeps periods,
// FAILED (UNKNOWN if there never was one) with reason STALE at 10 Hz; markers (text, uncertainty, alert limit) with each.
// Service: ~start_redundant.
// What silence means is measured on the clock of the graph: simulated time if that is used, otherwise the steady clock.
#include <fail_aware_lidar_odometry/FailAwareMonitorConfig.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <memory>

#include "clock_check.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/marker_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/core/fail_aware/monitor.hpp"
#include "fail_aware_lidar_odometry/core/stamp_difference.hpp"
#include "fail_aware_monitor_params.hpp"
#include "health.hpp"
#include "load_or_say_why.hpp"
#include "open_queue.hpp"
#include "private_parameters.hpp"
#include "rate_meter.hpp"
#include "reconfiguration.hpp"
#include "stamps.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class FailAwareMonitorNodelet : public nodelet::Nodelet {
 private:
  using Config = fail_aware_lidar_odometry::FailAwareMonitorConfig;

  static constexpr double kTimerPeriod_s = 0.05;
  static constexpr double kStalePeriod_s = 0.1;

  void onInit() override {
    openQueue(getSTCallbackQueue());
    loadOrSayWhy(getName(), [this] { load(); });
  }

  void load() {
    ros::NodeHandle& node = getNodeHandle();
    ros::NodeHandle& private_node = getPrivateNodeHandle();
    readPrivateParameters(private_node, params_, FailAwareMonitorTuning());
    params_.validate();
    pipeline_ = readPipelineParameters(node);
    monitor_ = std::make_unique<FailAwareMonitor>(pipeline_.profile.monitor);
    if (params_.start_redundant) monitor_->start();
    const FailAwareMonitorTuning tuning{pipeline_.profile.monitor};
    warnOfOtherValues(private_node, params_, tuning);
    reconfiguration_ = std::make_unique<Reconfiguration<Config, FailAwareMonitorTuning>>(
        private_node, tuning, [this](const FailAwareMonitorTuning& changed) {
          pipeline_.profile.monitor = changed.monitor;
          monitor_->setLimits(changed.monitor);
        });
    publisher_ = node.advertise<messages::TimeToFailure>(topics::kTimeToFailure, topics::kQueue);
    marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::kMarkers, 1);
    service_ = private_node.advertiseService("start_redundant", &FailAwareMonitorNodelet::onStartRedundant, this);
    heard_s_ = now_s();
    subscriber_ = node.subscribe(topics::kFilterState, topics::kQueue, &FailAwareMonitorNodelet::onState, this);
    timer_ = node.createSteadyTimer(ros::WallDuration(kTimerPeriod_s),
                                    [this](const ros::SteadyTimerEvent&) { checkStale(); });
    health_ =
        std::make_unique<Health>(node, private_node, getName(), "time_to_failure",
                                 [this](diagnostic_updater::DiagnosticStatusWrapper& status) { diagnose(status); });
  }

  static double now_s() { return ros::Time::isSimTime() ? ros::Time::now().toSec() : ros::SteadyTime::now().toSec(); }

  void onState(const messages::FilterStateConstPtr& message) {
    const std::optional<FilterState> state = fromMessage(*message);
    if (!state) return;
    heard_s_ = now_s();
    clock_.heard(message->header.stamp);
    rate_.tick();
    if (state->dt_s > 0.0) {
      period_s_ = state->dt_s;
    } else {
      beginDrive();
    }
    asked_ = false;
    output_ = monitor_->update(*state, conditionOf(*message));
    header_ = message->header;
    base_position_odom_ = (state->T_odom_cog * pipeline_.vehicle.T_base_cog().inverse()).translation();
    publish(header_);
  }

  /// odom begins anew: what it served as is lost, and whoever relied on it must ask again (start_redundant: always
  /// serves). A request that still waits for an observed motion stays.
  void beginDrive() {
    const bool is_asked_for = params_.start_redundant || asked_ || monitor_->startPending();
    monitor_ = std::make_unique<FailAwareMonitor>(pipeline_.profile.monitor);
    if (is_asked_for) monitor_->start();
  }

  void checkStale() {
    const double now = now_s();
    heard_s_ = std::min(heard_s_, now);  // simulated time may begin anew
    published_s_ = std::min(published_s_, now);
    const double silence_s = now - heard_s_;
    if (silence_s < staleAfter_s(params_.silence, period_s_) || now - published_s_ < kStalePeriod_s) return;
    const bool heard = !header_.stamp.isZero();
    output_ = staleOutput(output_);
    if (!heard) {
      output_.state = FailAwareState::kUnknown;
      output_.time_to_failure = TimeToFailure::unknown();
    }
    std_msgs::Header header = header_;
    if (heard) header.stamp = later(header.stamp, silence_s);
    publish(header);
  }

  void publish(const std_msgs::Header& header) {
    published_s_ = now_s();
    publisher_.publish(messages::TimeToFailureConstPtr(
        boost::make_shared<messages::TimeToFailure>(toMessage(output_, pipeline_.profile.monitor, header))));
    if (!header.stamp.isZero() && marker_publisher_.getNumSubscribers() > 0) showMarkers(header);
  }

  void showMarkers(const std_msgs::Header& header) {
    const auto markers = boost::make_shared<visualization_msgs::MarkerArray>(
        uncertaintyMarkers(monitor_->horizontalCovarianceOdom(), base_position_odom_,
                           pipeline_.profile.monitor.predictor.alert_limit_m, header));
    markers->markers.push_back(timeToFailureMarker(output_, base_position_odom_, header));
    marker_publisher_.publish(visualization_msgs::MarkerArrayConstPtr(markers));
  }

  bool onStartRedundant(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    monitor_->start();
    asked_ = true;
    response.success = true;
    response.message = "serves as the localisation from the next sweep on whose motion is observed";
    return true;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const bool failed = output_.state == FailAwareState::kFailed || output_.state == FailAwareState::kFailing;
    const auto level = failed ? Level::ERROR : output_.state == FailAwareState::kOk ? Level::OK : Level::WARN;
    const std::string reasons = reasonText(output_.reasons);
    status.summary(level, std::string(toString(output_.state)) + (reasons.empty() ? "" : ": " + reasons));
    if (const std::string fault = clock_.fault(); !fault.empty()) {
      status.summary(std::max<decltype(level)>(level, Level::WARN), status.message + "; " + fault);
    }
    status.addf("rate of filter states (Hz)", "%.2f", rate_.take_hz());
    status.addf("silence (s)", "%.3f", now_s() - heard_s_);
    const char* serves = monitor_->startPending() ? "waits for an observed motion" : monitor_->started() ? "yes" : "no";
    status.add("serves as the localisation", serves);
    if (output_.standby_time_to_failure.isKnown()) {
      status.add("if it served from now on", std::string(toString(output_.standby_state)) + ", time to failure " +
                                                 std::to_string(output_.standby_time_to_failure.seconds) + " s");
    }
    if (!reconfiguration_->refused().empty()) status.add("reconfiguration refused", reconfiguration_->refused());
    status.add("time to failure (s)", output_.time_to_failure.seconds);
    status.add("eta (rad)", output_.eta);
    status.add("sigma x since start_redundant (m)", output_.sigma_x_m);
    status.add("sigma y since start_redundant (m)", output_.sigma_y_m);
  }

  FailAwareMonitorNodeletParams params_;
  PipelineParameters pipeline_;
  std::unique_ptr<FailAwareMonitor> monitor_;
  ros::Publisher publisher_, marker_publisher_;
  MonitorOutput output_;
  bool asked_ = false;  ///< ~start_redundant was called since the last filter state
  Eigen::Vector3d base_position_odom_ = Eigen::Vector3d::Zero();
  std_msgs::Header header_;  ///< of the last filter state
  ClockCheck clock_;         ///< of the filter states
  RateMeter rate_;
  double period_s_ = kUsualPeriod_s;
  double heard_s_ = 0.0;
  double published_s_ = 0.0;
  // What calls back is destroyed first, and waits for a call that is under way.
  std::unique_ptr<Reconfiguration<Config, FailAwareMonitorTuning>> reconfiguration_;
  ros::Subscriber subscriber_;
  ros::ServiceServer service_;
  ros::SteadyTimer timer_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::FailAwareMonitorNodelet, nodelet::Nodelet)
