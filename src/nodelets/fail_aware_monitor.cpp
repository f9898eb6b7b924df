// The fail-aware monitor in the live graph (core/integrity/monitor.hpp).
// In: filter_state. Out: time_to_failure, one per filter state; without a filter state for stale_sweeps periods it is
// FAILED (UNKNOWN if there never was one) with reason STALE at 10 Hz; markers (text, uncertainty, alert limit) with
// each. Services: ~start_redundant, ~stop_redundant.
// Silence is measured on the graph's clock: simulated time if it is in use, otherwise the steady clock.
#include "fail_aware_lidar_odometry/FailAwareMonitorConfig.h"
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/graph_message_conversion.hpp"
#include "bridge/marker_conversion.hpp"
#include "bridge/monitor_message_conversion.hpp"
#include "bridge/parameter_server.hpp"
#include "clock_check.hpp"
#include "core/integrity/silence.hpp"
#include "drive_monitor.hpp"
#include "fail_aware_monitor_params.hpp"
#include "graph_nodelet.hpp"
#include "monitor_log.hpp"
#include "private_parameters.hpp"
#include "rate_meter.hpp"
#include "reconfiguration.hpp"
#include "silence_watch.hpp"
#include "stamps.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class FailAwareMonitorNodelet : public GraphNodelet {
 private:
  using Config = fail_aware_lidar_odometry::FailAwareMonitorConfig;

  static constexpr double kTimerPeriod_s = 0.05;
  static constexpr double kStarts_s = 5.0;  ///< in which fusion_ukf may still be loading

  void load() override {
    ros::NodeHandle& node = getNodeHandle();
    ros::NodeHandle& private_node = getPrivateNodeHandle();
    FailAwareMonitorNodeletParams params;
    readPrivateParameters(private_node, params, FailAwareMonitorTuning());
    validate(params);
    const PipelineParameters pipeline = readPipelineParameters(node);
    const FailAwareMonitorTuning tuning{pipeline.profile.monitor};
    T_base_cog_ = pipeline.vehicle.T_base_cog();
    monitor_ = std::make_unique<DriveMonitor>(tuning.monitor, params.start_redundant);
    log_.emplace(params.start_redundant);
    warnOfOtherValues(private_node, params, tuning);
    reconfiguration_ = std::make_unique<Reconfiguration<Config, FailAwareMonitorTuning>>(
        private_node, tuning, [this](const FailAwareMonitorTuning& changed) { monitor_->setLimits(changed.monitor); });
    publisher_ = node.advertise<messages::TimeToFailure>(topics::kTimeToFailure, topics::kQueue);
    marker_publisher_ = node.advertise<visualization_msgs::MarkerArray>(topics::kMarkers, 1);
    services_ = {private_node.advertiseService("start_redundant", &FailAwareMonitorNodelet::onStartRedundant, this),
                 private_node.advertiseService("stop_redundant", &FailAwareMonitorNodelet::onStopRedundant, this)};
    silence_ = SilenceWatch(params.silence, now_s());
    subscriber_ = node.subscribe(topics::kFilterState, topics::kQueue, &FailAwareMonitorNodelet::onState, this);
    timer_ = node.createSteadyTimer(ros::WallDuration(kTimerPeriod_s),
                                    [this](const ros::SteadyTimerEvent&) { checkSilence(); });
    health_ = reportHealth("time_to_failure");
  }

  static double now_s() { return ros::Time::isSimTime() ? ros::Time::now().toSec() : ros::SteadyTime::now().toSec(); }

  void onState(const messages::FilterStateConstPtr& message) {
    const std::optional<FilterState> state = fromMessage(*message);
    if (!state) return;
    silence_.heard(now_s(), state->dt_s);
    clock_.heard(message->header.stamp);
    rate_.tick();
    output_ = monitor_->update(*state, conditionOf(*message));
    header_ = message->header;
    T_odom_base_ = state->T_odom_cog * T_base_cog_.inverse();
    publish(header_);
  }

  void checkSilence() {
    const double now = now_s();
    if (!silence_.isDue(now)) return;
    const bool heard = !header_.stamp.isZero();
    output_ = staleOutput(output_);
    if (!heard) {
      output_.state = FailAwareState::kUnknown;
      output_.time_to_failure = TimeToFailure::unknown();
    }
    std_msgs::Header header = header_;
    if (heard) header.stamp = later(header.stamp, silence_.silence_s(now));
    publish(header);
  }

  void publish(const std_msgs::Header& header) {
    silence_.published(now_s());
    log_->tell(output_);
    publisher_.publish(messages::TimeToFailureConstPtr(
        boost::make_shared<messages::TimeToFailure>(toMessage(output_, monitor_->params(), header))));
    if (!header.stamp.isZero() && marker_publisher_.getNumSubscribers() > 0) showMarkers(header);
  }

  void showMarkers(const std_msgs::Header& header) {
    const auto markers = boost::make_shared<visualization_msgs::MarkerArray>(
        uncertaintyMarkers(monitor_->monitor().horizontalCovarianceOdom(), T_odom_base_.translation(),
                           monitor_->params().predictor.alert_limit_m, header));
    markers->markers.push_back(timeToFailureMarker(output_, T_odom_base_.translation(), header));
    markers->markers.push_back(roadAheadMarker(output_, T_odom_base_, header));
    marker_publisher_.publish(visualization_msgs::MarkerArrayConstPtr(markers));
  }

  // Both end an earlier t1 and its state: what is published in silence says so, too.
  bool onStartRedundant(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    monitor_->serve();
    output_ = MonitorOutput();
    response.success = true;
    response.message =
        "serves as the localisation from the next sweep on (if no motion is known: the first whose motion is observed)";
    return true;
  }

  bool onStopRedundant(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    response.success = monitor_->stopServing();
    if (response.success) output_ = MonitorOutput();
    response.message = response.success ? "does not serve as the localisation any more"
                                        : "it always serves: the parameter start_redundant is true";
    return true;
  }

  /// Once, when the period is known.
  void checkDeadline() {
    if (deadline_checked_) return;
    const std::optional<double> deadline_s = readNumber(getNodeHandle(), "fusion_ukf/deadline_s");
    const std::optional<std::string> fault = silence_.deadlineFault(deadline_s.value_or(0.0));
    deadline_checked_ = fault.has_value();
    if (fault && !fault->empty()) ROS_WARN("fail_aware_monitor: %s", fault->c_str());
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const bool failed = output_.state == FailAwareState::kFailed || output_.state == FailAwareState::kFailing;
    // before t1 the state is always UNKNOWN: the standby state tells whether all is well
    const bool on_standby = output_.state == FailAwareState::kUnknown && !monitor_->monitor().started();
    const FailAwareState told = on_standby ? output_.standby_state : output_.state;
    const auto level = failed ? Level::ERROR : told == FailAwareState::kOk ? Level::OK : Level::WARN;
    const std::string reasons = reasonText(output_.reasons);
    status.summary(level, (on_standby ? "on standby: " : "") + std::string(toString(told)) +
                              (reasons.empty() ? "" : ": " + reasons));
    if (const std::string fault = clock_.fault(); !fault.empty()) {
      status.summary(std::max<decltype(level)>(level, Level::WARN), status.message + "; " + fault);
    }
    if (subscriber_.getNumPublishers() == 0 && silence_.silence_s(now_s()) > kStarts_s) {
      status.summary(Level::ERROR, status.message + "; filter_state has no publisher: fusion_ukf does not run");
    }
    status.addf("rate of filter states (Hz)", "%.2f", rate_.take_hz());
    status.addf("silence (s)", "%.3f", silence_.silence_s(now_s()));
    status.add("serves as the localisation", monitor_->monitor().startPending() ? "waits for an observed motion"
                                             : monitor_->monitor().started()    ? "yes"
                                                                                : "no");
    if (output_.standby_time_to_failure.isKnown()) {
      status.add("if it served from now on", std::string(toString(output_.standby_state)) + ", time to failure " +
                                                 std::to_string(output_.standby_time_to_failure.seconds) + " s");
    }
    reconfiguration_->diagnose(status);
    checkDeadline();
    status.add("time to failure (s)", output_.time_to_failure.seconds);
    status.add("eta (rad)", output_.eta);
    status.add("sigma x since start_redundant (m)", output_.sigma_x_m);
    status.add("sigma y since start_redundant (m)", output_.sigma_y_m);
  }

  Pose T_base_cog_ = Pose::Identity();
  std::unique_ptr<DriveMonitor> monitor_;
  MonitorOutput output_;
  std_msgs::Header header_;  ///< of the last filter state
  Pose T_odom_base_ = Pose::Identity();
  ClockCheck clock_;  ///< of the filter states' stamps
  RateMeter rate_;
  SilenceWatch silence_;
  bool deadline_checked_ = false;
  std::optional<MonitorLog> log_;
  ros::Publisher publisher_, marker_publisher_;
  // Members with callbacks come last: they are destroyed first, and their destructors wait for running callbacks.
  std::unique_ptr<Reconfiguration<Config, FailAwareMonitorTuning>> reconfiguration_;
  ros::Subscriber subscriber_;
  std::vector<ros::ServiceServer> services_;
  ros::SteadyTimer timer_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::FailAwareMonitorNodelet, nodelet::Nodelet)
