#include "core/estimator.hpp"

#include <cmath>

#include "core/estimation/increment_covariance.hpp"
#include "core/geometry/degree.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

Estimator::Estimator(const PipelineParameters& params)
    : T_base_cog_(params.vehicle.T_base_cog()),
      filter_(params.profile.filter, VehicleModel(params.vehicle.dynamics, params.profile.model),
              params.profile.history, params.profile.fusion),
      odometry_covariance_(params.profile.monitor.drift),
      clock_(params.sensor.timing.sweep_period_s) {
  const PoseFilter::Params& filter = params.profile.filter;
  start_covariance_ = isotropicCovariance(filter.initial_sigma_m, filter.initial_sigma_deg * kDegree);
  reset();
}

Estimator::Accepted Estimator::accept(double stamp_s) {
  Accepted accepted;
  if (!std::isfinite(stamp_s)) return {StampOrder::kReordered, 0.0};
  if (newest_stamp_s_) accepted.order = stamps_.next(sinceNewest_s(stamp_s));
  if (accepted.beginsDrive()) beginDrive(Pose(filter_.state().T_odom_cog));
  if (accepted.taken()) {
    newest_stamp_s_ = stamp_s;
    accepted.set_back_s = stamps_.setBack_s();
  }
  return accepted;
}

double Estimator::sinceNewest_s(double stamp_s) const {
  return newest_stamp_s_ ? secondsBetween(*newest_stamp_s_, stamp_s) : 0.0;
}

bool Estimator::predict(double stamp_s, double set_back_s, SweepPrediction& prediction) {
  return filter_.predict(clock_.next(stamp_s, set_back_s), prediction);
}

const FilterState& Estimator::update(const std::vector<FusionInput>& measurements, const SweepFindings& findings) {
  external_.clear();
  refused_.clear();
  for (auto& [name, source] : sources_) {
    external_.push_back({name, source.measure(filter_.prediction(), T_base_cog_)});
    if (const std::string why = source.timeFault(); !why.empty()) refused_.push_back({name, why});
  }
  std::vector<FusionInput> inputs = measurements;
  for (const ExternalMeasurement& external : external_) {
    inputs.push_back(
        {external.source, external.measurement ? &*external.measurement : nullptr, FusionInput::Kind::kExternal});
  }
  const Pose T_odom_cog_previous = filter_.state().T_odom_cog;
  const FilterState& state = filter_.correct(inputs, findings);
  noteRefused(inputs);
  clock_.observeRevolution(findings.revolution_s);
  OdometryIncrement increment = incrementOf(state);
  increment.tilt_moment = findings.tilt_moment;
  covariance_is_whole_ =
      !(state.dt_s > 0.0) || odometry_covariance_.propagate(T_odom_cog_previous, state.T_odom_cog, increment);
  takeSetPose(filter_.prediction().motionKnown());
  return state;
}

void Estimator::noteRefused(const std::vector<FusionInput>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].kind != FusionInput::Kind::kExternal || !inputs[i].measurement) continue;
    const Vector6d off = stateDifference(vectorFromPose(inputs[i].measurement->T_odom_cog),
                                         vectorFromPose(filter_.prediction().T_odom_cog));
    const std::string why = refusalOf(filter_.state().fusion, i, off);
    if (!why.empty()) refused_.push_back({inputs[i].name, why});
  }
}

void Estimator::takeSetPose(bool motion_known) {
  const FilterState& state = filter_.state();
  const bool is_first = !(state.dt_s > 0.0);  // no motion that could move the pose to this estimate
  if (!pose_setting_.pending()) return;
  if (is_first ? !pose_setting_.isAt(state) : !motion_known) {
    pose_setting_.wait(state.stamp_s);
    return;
  }
  pose_set_.refused = pose_setting_.outdated(state);
  if (!pose_set_.refused.empty()) return;
  const PoseSetting::AtEstimate set = pose_setting_.take(filter_.stateAsDriven(), T_base_cog_);
  pose_set_.done = filter_.setPose(set.T_odom_cog);
  if (!pose_set_.done) {
    pose_set_.refused = "the filter cannot stand there";
    return;
  }
  odometry_covariance_.reset(set.covariance + start_covariance_);
  for (auto& [name, source] : sources_) source.clear();
}

void Estimator::addSource(const std::string& name, double tolerance_s) {
  sources_.insert_or_assign(name, ExternalPoseSource(tolerance_s));
}

std::string Estimator::offer(const std::string& source, const ExternalPose& pose) {
  const auto found = sources_.find(source);
  if (found == sources_.end()) return "there is no source " + source;
  return found->second.offer(pose);
}

void Estimator::reset() { beginDrive(T_base_cog_); }

void Estimator::beginDrive(const Pose& T_odom_cog) {
  filter_.reset(T_odom_cog);
  odometry_covariance_.reset(start_covariance_);
  clock_.reset();
  stamps_.beginDrive();
  newest_stamp_s_.reset();
  if (pose_setting_.pending()) pose_set_.refused = "a new drive began before it could be set";
  pose_setting_.clear();
  for (auto& [name, source] : sources_) source.clear();
  external_.clear();
  refused_.clear();
}

}  // namespace fail_aware
