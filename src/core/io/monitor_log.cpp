#include "core/io/monitor_log.hpp"

#include "core/io/number_table.hpp"

namespace fail_aware {

namespace {

struct MonitorLogTable {
  using Row = MonitorInput;
  static constexpr const char* kName = "this version's monitor_log.csv";
  static constexpr const char* kRemedy = "run offline_odometry again";

  template <class Input, class Visitor>
  static void visit(Input& input, Visitor&& v) {
    auto& s = input.state;
    v("row", input.row);
    v("stamp", s.stamp_s);
    v("stamp_error", s.stamp_error_s);
    v("dt", s.dt_s);
    number_table::visitMatrix("T_odom_cog", s.T_odom_cog.affine(), v);
    number_table::visitMatrix("covariance", s.covariance, v);
    v("sigma_yaw", s.sigma_yaw_rad);
    v("measurement_applied", s.measurement_applied);
    v("clock_jump", s.clock_jump);
    v("started", s.started);
    v("motion_status", s.motion_status);
    number_table::visitMatrix("T_previous_now", s.T_previous_now.affine(), v);
    number_table::visitMatrix("increment_covariance", s.increment_covariance, v);
    number_table::visitMatrix("motion_covariance", s.motion_covariance, v);
    number_table::visitMatrix("registration_covariance", s.registration_covariance, v);
    v("registered", s.registered);
    v("doubt", s.doubt.sigma_m);
    v("doubt_yaw", s.doubt.sigma_yaw_rad);
    v("speed_variance", s.speed_error.variance_m2_s2);
    v("speed_kept", s.speed_error.kept);
    v("odom_reset_count", s.odom_reset_count);
    v("map_update", s.map_update);
    v("view_range", s.view_range_m);
    v("filter_nis", s.filter_nis);
    auto& f = s.fusion;
    v("has_measurement", f.has_measurement);
    number_table::visitMatrix("fused_state", f.z, v);
    number_table::visitMatrix("fused_covariance", f.R, v);
    v("weights", f.weights);
    v("nis", f.nis);
    v("all_gated_out", f.all_gated_out);
    v("prediction_overruled", f.prediction_overruled);
    v("prediction_invalid", f.prediction_invalid);
    v("disagreement_m", f.disagreement_m);
    v("disagreement_yaw_rad", f.disagreement_yaw_rad);
    v("confirmed", f.confirmed);
    v("valid_inputs", f.valid_inputs);
    v("invalid_inputs", f.invalid_inputs);
    auto& c = input.condition;
    v("sweep_empty", c.empty);
    v("sweep_incomplete", c.incomplete);
    v("sweep_low_visibility", c.low_visibility);
    v("sweep_frozen", c.frozen);
    v("sweep_time_jump", c.time_jump);
    v("sweep_time_field_refused", c.time_field_refused);
    v("sweep_point_times_contradicted", c.point_times_contradicted);
    v("sweep_no_answer", c.no_answer);
    v("sweep_dropped_before", c.dropped_before);
    v("sweep_point_missing", c.point_missing);
    v("sweep_plane_missing", c.plane_missing);
    v("sweep_corners_missing", c.corners_missing);
    v("sweep_min_information_ratio", c.min_information_ratio);
    v("sweep_min_information_ahead", c.ahead.ratio);
    v("sweep_information_ahead_distance_m", c.ahead.distance_m);
  }
};

}  // namespace

std::string monitorLogHeader() { return numberTableHeader<MonitorLogTable>(); }

std::string monitorLogRow(const MonitorInput& input) { return numberTableRow<MonitorLogTable>(input); }

std::vector<MonitorInput> readMonitorLog(const std::string& path) {
  std::vector<MonitorInput> log = readNumberTable<MonitorLogTable>(path);
  if (log.empty()) throw InputError(path + ": no sweeps");
  return log;
}

}  // namespace fail_aware
