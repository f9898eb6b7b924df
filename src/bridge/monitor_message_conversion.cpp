#include "bridge/monitor_message_conversion.hpp"

#include <vector>

#include "bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/PoseMeasurement.h"

namespace fail_aware {

SweepCondition conditionOf(const messages::FilterState& message) {
  SweepCondition condition;
  condition.empty = message.sweep_points == 0;
  condition.dropped_before = static_cast<int>(message.dropped_before);
  condition.incomplete = message.sweep_incomplete != 0;
  condition.low_visibility = message.sweep_low_visibility != 0;
  condition.frozen = message.sweep_frozen != 0;
  condition.time_jump = message.time_jump != 0;
  condition.time_field_refused = message.sweep_time_field_refused != 0;
  condition.point_times_contradicted = message.sweep_point_times_contradicted != 0;
  condition.no_answer = message.deadline_missed != 0;
  condition.ahead = aheadOf(message.min_information_ahead, message.information_ahead_distance);
  const std::vector<double>& ratios = message.min_information_ratio;
  for (std::size_t i = 0; i < message.measurement_names.size() && i < message.measurement_status.size(); ++i) {
    const bool ok = message.measurement_status[i] == messages::PoseMeasurement::OK;
    condition.add(message.measurement_names[i], ok, i < ratios.size() ? ratios[i] : condition.min_information_ratio);
  }
  return condition;
}

messages::TimeToFailure toMessage(const MonitorOutput& output, const MonitorParameters& params,
                                  const std_msgs::Header& header) {
  messages::TimeToFailure message;
  message.header = header;
  message.state = static_cast<std::uint8_t>(output.state);
  message.reasons = output.reasons;
  message.reasons_text = reasonText(output.reasons);
  message.horizon = params.predictor.horizon_s;
  message.time_to_failure = output.time_to_failure.seconds;
  message.time_to_failure_indicator = output.time_to_failure_indicator.seconds;
  message.time_to_failure_covariance = output.time_to_failure_covariance.seconds;
  message.eta = output.eta;
  message.eta_rate = output.eta_rate_per_s;
  message.sigma_yaw = output.sigma_yaw_rad;
  message.sigma_x = output.sigma_x_m;
  message.sigma_y = output.sigma_y_m;
  message.protection_level = output.protection_level_m;
  message.min_information_ahead = output.min_information_ahead;
  message.information_ahead_distance = output.information_ahead_distance_m;
  if (output.t1_stamp_s > 0.0 && output.t1_stamp_s < ros::TIME_MAX.toSec() - 1.0) message.t1.fromSec(output.t1_stamp_s);
  message.eta_threshold = params.indicator.threshold;
  message.alert_limit = params.predictor.alert_limit_m;
  message.standby_state = static_cast<std::uint8_t>(output.standby_state);
  message.standby_time_to_failure = output.standby_time_to_failure.seconds;
  return message;
}

}  // namespace fail_aware
