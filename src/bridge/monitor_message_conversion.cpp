#include "bridge/monitor_message_conversion.hpp"

#include <string>

#include "bridge/graph_message_conversion.hpp"
#include "core/types/measurement.hpp"
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
  condition.no_answer = message.deadline_missed != 0;
  condition.ahead = aheadOf(message.min_information_ahead, message.information_ahead_distance);
  for (std::size_t i = 0; i < message.measurement_names.size(); ++i) {
    if (i >= message.measurement_status.size()) break;
    const bool missing = message.measurement_status[i] != messages::PoseMeasurement::OK;
    const std::string& name = message.measurement_names[i];
    if (name == kIcpPointToPoint) condition.point_missing = missing;
    if (name == kCornerSvd) condition.corners_missing = missing;
    if (name != kIcpPointToPlane) continue;
    condition.plane_missing = missing;
    if (missing) continue;
    if (i < message.min_information_ratio.size()) condition.min_information_ratio = message.min_information_ratio[i];
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
