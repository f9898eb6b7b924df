#include "sweep_log.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numeric>

#include "core/geometry/rotation.hpp"
#include "core/io/measurement_log.hpp"
#include "core/io/monitor_log.hpp"
#include "core/io/output_file.hpp"
#include "core/preprocessing/sweep_check.hpp"
#include "evaluation/quantile.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kStatuses = 5;

/// Names of the sources that measure a whole pose, or of the others.
std::vector<const char*> sourcesThatMeasure(bool whole_pose) {
  std::vector<const char*> names;
  for (const BuiltInSource& source : kBuiltInSources) {
    if (FusionInput::isPartial(source.kind) != whole_pose) names.push_back(source.name);
  }
  return names;
}

const std::vector<const char*> kWhole = sourcesThatMeasure(true), kPartial = sourcesThatMeasure(false);

void writeMeasurement(std::ostream& out, const Measurement& m) {
  out << ',' << toString(m.status) << ',' << m.iterations << ',' << m.inlier_ratio << ',' << m.rms_residual_m << ','
      << m.degenerate_directions;
}

/// The source's value of those that are in the order of the fusion's inputs; `none` if it has none.
double ofSource(const char* source, const SweepResult& r, const std::vector<double>& values, double none) {
  for (std::size_t i = 0; i < r.sources.size() && i < values.size(); ++i) {
    if (r.sources[i].name == source) return values[i];
  }
  return none;
}

/// 0: not used in this sweep.
double weightOf(const char* source, const SweepResult& r) { return ofSource(source, r, r.state.fusion.weights, 0.0); }

}  // namespace

SweepLog::SweepLog(const std::filesystem::path& folder)
    : path_((folder / "per_sweep.csv").string()),
      monitor_path_((folder / "monitor_log.csv").string()),
      measurement_path_((folder / "measurements.csv").string()),
      out_(createFile(path_)),
      monitor_log_(createFile(monitor_path_)),
      measurement_log_(createFile(measurement_path_)),
      by_status_(kStatuses, 0) {
  monitor_log_ << monitorLogHeader() << '\n';
  measurement_log_ << measurementLogHeader() << '\n';
  out_
      << "stamp,status,state,reasons,time_to_failure,time_to_failure_indicator,time_to_failure_covariance,eta,eta_rate,"
         "sigma_yaw,sigma_x,sigma_y,protection_level";
  for (const char* name : kWhole) out_ << ",weight_" << name;
  for (const char* name : kWhole) out_ << ",nis_" << name;
  out_ << ",nis_fused,ms_total,ms_correction";
  for (const char* name : kWhole) out_ << ",ms_" << name;
  out_ << ",ms_fusion,ms_reference";
  for (const char* name : kWhole) {
    for (const char* column : {"status", "iterations", "inlier_ratio", "rms_m", "degenerate_directions"}) {
      out_ << ',' << name << '_' << column;
    }
  }
  out_ << ",seed_spread_m,min_information_ratio,disagreement_m,cov_xx,cov_xy,cov_yy,cov_zz,cov_yaw,speed_mps,"
          "yaw_rate_rps,odom_sigma_x,odom_sigma_y,odom_sigma_z,odom_sigma_roll,odom_sigma_pitch,odom_sigma_yaw";
  for (const char* name : kPartial) out_ << ",weight_" << name;
  out_ << ",min_information_ahead,information_ahead_distance_m\n";
}

void SweepLog::add(double stamp_s, const SweepResult& r) {
  const MonitorOutput& m = r.monitor;
  out_ << std::setprecision(std::numeric_limits<double>::max_digits10) << stamp_s << std::setprecision(9) << ','
       << toString(r.status) << ',' << toString(m.state) << ',' << reasonText(m.reasons) << ','
       << m.time_to_failure.seconds << ',' << m.time_to_failure_indicator.seconds << ','
       << m.time_to_failure_covariance.seconds << ',' << m.eta << ',' << m.eta_rate_per_s << ',' << m.sigma_yaw_rad
       << ',' << m.sigma_x_m << ',' << m.sigma_y_m << ',' << m.protection_level_m;
  for (const char* name : kWhole) out_ << ',' << weightOf(name, r);
  for (const char* name : kWhole) out_ << ',' << ofSource(name, r, r.state.fusion.nis, -1.0);
  const StageTimes& t = r.times;
  out_ << ',' << (r.state.measurement_applied ? r.state.filter_nis : -1.0) << ',' << t.total_ms << ','
       << t.correction_ms;
  for (const char* name : kWhole) out_ << ',' << r.of(name).duration_ms;
  out_ << ',' << t.fusion_ms << ',' << t.reference_ms;
  for (const char* name : kWhole) writeMeasurement(out_, r.of(name).measurement);
  out_ << ',' << r.of(kIcpPointToPoint).measurement.seed_spread_m << ','
       << r.of(kIcpPointToPlane).measurement.min_information_ratio << ',' << r.state.fusion.disagreement_m;
  const Matrix6d& c = m.covariance_since_start;
  for (const double entry : {c(0, 0), c(0, 1), c(1, 1), c(2, 2), c(5, 5)}) out_ << ',' << entry;
  const double dt_s = r.state.dt_s;
  out_ << ',' << (dt_s > 0.0 ? r.state.T_previous_now.translation().x() / dt_s : 0.0) << ','
       << (dt_s > 0.0 ? rpyFromRotation(r.state.T_previous_now.linear()).z() / dt_s : 0.0);
  for (int i = 0; i < 6; ++i) out_ << ',' << std::sqrt(std::max(0.0, r.odometry_covariance(i, i)));
  for (const char* name : kPartial) out_ << ',' << weightOf(name, r);
  out_ << ',' << m.min_information_ahead << ',' << m.information_ahead_distance_m << '\n';
  if (hasPose(r.status)) {
    logSweep(total_ms_.size(), r);
  } else {
    without_pose_.push_back(total_ms_.size());
  }
  total_ms_.push_back(t.total_ms);
  ++by_status_[static_cast<std::size_t>(r.status)];
  if (r.status == SweepStatus::kStampNotAdvancing || r.condition.empty) return;
  ++by_timing_[r.timing.source];
  if (r.condition.incomplete) ++incomplete_;
  outliers_ += r.timing.outliers;
  if (r.timing.guessed() || guessed_ == 0) timing_ = r.timing;
  if (r.timing.guessed()) ++guessed_;
}

void SweepLog::logSweep(std::size_t row, const SweepResult& r) {
  monitor_log_ << monitorLogRow({row, r.state, r.condition}) << '\n';
  if (r.state.dt_s <= 0.0) return;
  for (std::size_t i = 0; i < r.sources.size(); ++i) {
    const SourceResult& source = r.sources[i];
    if (FusionInput::isPartial(source.kind) || !source.measurement.ok()) continue;
    measurement_log_ << measurementLogRow(measuredMotion(row, i, source.measurement, r.state)) << '\n';
  }
}

std::size_t SweepLog::timedAsBefore() const {
  const auto held = by_timing_.find(TimingSource::kHeld);
  return held == by_timing_.end() ? 0 : held->second;
}

Json SweepLog::summary() const {
  Json json;
  const auto quantileOrZero = [&](double q) { return total_ms_.empty() ? 0.0 : quantile(total_ms_, q); };
  const double sum = std::accumulate(total_ms_.begin(), total_ms_.end(), 0.0);
  json["sweeps"] = total_ms_.size();
  json["mean_ms"] = total_ms_.empty() ? 0.0 : sum / static_cast<double>(total_ms_.size());
  json["median_ms"] = quantileOrZero(0.5);
  json["p95_ms"] = quantileOrZero(0.95);
  json["p99_ms"] = quantileOrZero(0.99);
  for (const SweepStatus status : {SweepStatus::kNotStarted, SweepStatus::kFirst, SweepStatus::kCorrected,
                                   SweepStatus::kPredicted, SweepStatus::kStampNotAdvancing}) {
    json["by_status"][toString(status)] = count(status);
  }
  for (const auto& [source, sweeps] : by_timing_) json["timing"]["by_source"][toString(source)] = sweeps;
  json["timing"]["stamp_reference"] = toString(timing_.reference);
  json["timing"]["time_field"] = toString(timing_.field);
  json["timing"]["refused"] = guessed_;
  json["timing"]["refusal"] = timing_.refusal;
  json["timing"]["points_without_usable_time"] = outliers_;
  return json;
}

std::vector<std::string> SweepLog::warnings() const {
  std::vector<std::string> warnings;
  const auto ofSweeps = [&](std::size_t sweeps) {
    return "in " + std::to_string(sweeps) + " of " + std::to_string(total_ms_.size()) + " sweeps ";
  };
  if (guessed_ > 0) warnings.push_back(ofSweeps(guessed_) + describeGuess(timing_));
  if (2 * incomplete_ > total_ms_.size()) warnings.push_back(ofSweeps(incomplete_) + describeIncomplete());
  return warnings;
}

void SweepLog::close() {
  finishFile(out_, path_);
  finishFile(monitor_log_, monitor_path_);
  finishFile(measurement_log_, measurement_path_);
}

}  // namespace fail_aware
