#include "core/odometry_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/integrity/silence.hpp"
#include "core/parallel.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware {

namespace {

class Stopwatch {
 public:
  double lapMs() {
    const auto begin = std::exchange(last_, std::chrono::steady_clock::now());
    return std::chrono::duration<double, std::milli>(last_ - begin).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

const PipelineParameters& validated(const PipelineParameters& params, int threads) {
  requireWithin("threads", threads, 1, 256);
  validate(params);
  return params;
}

// What a message keeps of the numbers that stages exchange: it holds a rotation as a quaternion. Offline the stages
// exchange rounded data, as if by message. A different number of roundings would change some of the registration's
// decisions and finally give another trajectory than the live graph.
SweepPrediction exchanged(SweepPrediction prediction) {
  prediction.T_odom_cog_previous = quaternionRoundTrip(prediction.T_odom_cog_previous);
  prediction.T_odom_cog = quaternionRoundTrip(prediction.T_odom_cog);
  return prediction;
}

Measurement exchanged(Measurement measurement) {
  measurement.T_odom_cog = quaternionRoundTrip(measurement.T_odom_cog);
  return measurement;
}

FilterState exchanged(FilterState state) {
  state.T_odom_cog = quaternionRoundTrip(state.T_odom_cog);
  state.T_previous_now = quaternionRoundTrip(state.T_previous_now);
  return state;
}

}  // namespace

const SourceResult& SweepResult::of(const std::string& source) const {
  static const SourceResult kNone;
  const auto found =
      std::find_if(sources.begin(), sources.end(), [&](const SourceResult& s) { return s.name == source; });
  return found == sources.end() ? kNone : *found;
}

struct OdometryPipeline::Arena {
  tbb::task_arena arena;
};

OdometryPipeline::OdometryPipeline(const PipelineParameters& params, int threads)
    : params_(validated(params, threads)),
      T_cog_lidar_(quaternionRoundTrip(T_cog_base() * params.sensor.T_base_lidar())),
      check_(params.sensor.check),
      corrector_(params.sensor.vertical_angle, params.sensor.azimuth, params.sensor.correctedTiming(),
                 params.profile.sweep_correction, params.profile.vertical_reference),
      estimator_(params),
      registration_(params.profile.registration, params.sensor.correctedTiming()),
      corner_svd_(params.profile.registration.corner_extraction, params.profile.registration.corner_reference,
                  params.profile.registration.corner_alignment),
      monitor_(params.profile.monitor),
      arena_(new Arena{tbb::task_arena(arenaSize(threads))}),
      sources_(makeSources()) {}

OdometryPipeline::~OdometryPipeline() = default;

/// In the order of kBuiltInSources. A new source: its name in types/measurement.hpp, a line at the end of
/// kBuiltInSources and one here; live, the nodelet that measures it. A kPose that is ok counts as measured: without a
/// measurement return another status. With dt_s 0 a drive begins: forget what came before, return kNoReference.
std::array<OdometryPipeline::Source, kBuiltInSources.size()> OdometryPipeline::makeSources() {
  const RegistrationParameters& use = params_.profile.registration;
  return {{{use.use_icp_point_to_point, true,
            [this, icp = IcpPointToPoint(use.icp_point_to_point)](const SweepPrediction&) {
              return registration_.align(icp);
            }},
           {use.use_icp_point_to_plane, true,
            [this, icp = IcpPointToPlane(use.icp_point_to_plane)](const SweepPrediction& p) {
              return registration_.align(icp, p.sigma_yaw_rad);
            }},
           {use.use_corner_svd, false,
            [this](const SweepPrediction& p) { return corner_svd_.measure(corrected_, p, T_cog_lidar_); }},
           {true, true, [this](const SweepPrediction&) { return registration_.roadProfile(); }},
           {true, true, [this](const SweepPrediction&) { return registration_.aboveGround(); }}}};
}

void OdometryPipeline::measure(const SweepPrediction& prediction, SweepResult& result) {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    result.sources.push_back({kBuiltInSources[i].name, kBuiltInSources[i].kind, sources_[i].used, {}, 0.0});
  }
  const auto measureThose = [&](bool needs_scan) {
    inParallelFor(sources_.size(), [&](std::size_t i) {
      if (!sources_[i].used || sources_[i].needs_scan != needs_scan) return;
      Stopwatch watch;
      result.sources[i].measurement = exchanged(sources_[i].measure(prediction));
      result.sources[i].duration_ms = watch.lapMs();
    });
  };
  inArena(arena_->arena, [&] {
    inParallel(
        [&] {
          Stopwatch thinning;
          registration_.prepare(corrected_, prediction, T_cog_lidar_);
          result.times.correction_ms += thinning.lapMs();
          measureThose(true);
        },
        [&] { measureThose(false); });
  });
}

SweepCondition OdometryPipeline::condition(const SweepFindings& findings, const SweepResult& result) {
  SweepCondition condition;
  condition.empty = corrected_.points_lidar.empty();
  condition.dropped_before = std::exchange(refused_sweeps_, 0);
  condition.incomplete = findings.incomplete;
  condition.low_visibility = findings.low_visibility;
  condition.frozen = findings.frozen;
  condition.time_jump = findings.time_jump;
  condition.time_field_refused = findings.time_field_refused;
  condition.point_times_contradicted = findings.point_times_contradicted;
  condition.ahead = result.of(kIcpPointToPlane).measurement.ahead;
  for (const SourceResult& source : result.sources) {
    const Measurement& measurement = source.measurement;
    if (source.used) condition.add(source.name, measurement.ok(), measurement.min_information_ratio);
  }
  return condition;
}

/// Resets everything except the estimator.
void OdometryPipeline::beginDrive() {
  refused_sweeps_ = 0;
  check_.beginDrive();
  corrector_.reset();
  registration_.reset();
  corner_svd_.reset();
  monitor_.reset();
  last_output_ = MonitorOutput();
}

std::optional<SweepPrediction> OdometryPipeline::predict(double stamp_s) {
  const Estimator::Accepted accepted = estimator_.accept(stamp_s);
  if (accepted.beginsDrive()) {
    beginDrive();
    // a request that waits stays valid; its stamp was that of another clock
    if (start_from_stamp_s_) start_from_stamp_s_ = std::numeric_limits<double>::lowest();
  }
  SweepPrediction prediction;
  if (!accepted.taken() || !estimator_.predict(stamp_s, accepted.set_back_s, prediction)) return std::nullopt;
  return exchanged(prediction);
}

SweepCorrectorReport OdometryPipeline::deskew(Sweep& sweep, const SweepFindings& findings,
                                              const SweepPrediction& prediction) {
  const SweepCorrectorReport report = corrector_.correct(sweep, prediction, T_cog_lidar_, corrected_);
  corrected_.stamp_s = prediction.time_s();
  if (isLeftOut(findings, prediction.isFirst())) corrected_.clear();
  return report;
}

void OdometryPipeline::estimate(const SweepPrediction& prediction, const SweepFindings& findings, SweepResult& result) {
  std::vector<FusionInput> inputs;
  for (const SourceResult& source : result.sources) {
    inputs.push_back({source.name, source.used ? &source.measurement : nullptr, source.kind});
  }
  const FilterState& state = estimator_.update(inputs, findings);
  describeState(result);
  result.pose_set = estimator_.takePoseSet();
  result.refused_poses = estimator_.refusedPoses();
  result.status = !state.started              ? SweepStatus::kNotStarted
                  : prediction.isFirst()      ? SweepStatus::kFirst
                  : state.measurement_applied ? SweepStatus::kCorrected
                                              : SweepStatus::kPredicted;
}

void OdometryPipeline::describeState(SweepResult& result) const {
  const Pose& T_odom_cog = estimator_.state().T_odom_cog;
  result.state = exchanged(estimator_.state());
  result.T_odom_base = T_odom_cog * T_cog_base();
  result.odometry_covariance = covarianceAfterOffset(estimator_.odometryCovariance(), T_odom_cog, T_cog_base());
}

SweepResult OdometryPipeline::refuse() {
  ++refused_sweeps_;
  SweepResult result;
  result.status = SweepStatus::kStampNotAdvancing;
  describeState(result);
  // a driver whose stamps stand still is as silent as one that sends nothing
  if (refused_sweeps_ >= SilenceParams().stale_sweeps) last_output_ = staleOutput(last_output_);
  result.monitor = last_output_;
  return result;
}

const MonitorOutput& OdometryPipeline::judge(const SweepResult& result) {
  if (start_from_stamp_s_ && result.state.stamp_s >= *start_from_stamp_s_) {
    monitor_.start();
    start_from_stamp_s_.reset();
  }
  return last_output_ = monitor_.update(result.state, result.condition);
}

SweepResult OdometryPipeline::step(Sweep& sweep) {
  Stopwatch total, stage;
  const std::optional<SweepPrediction> prediction = predict(sweep.stamp_s);
  if (!prediction) return refuse();

  SweepResult result;
  SweepFindings findings = check_.check(sweep);
  const SweepCorrectorReport report = deskew(sweep, findings, *prediction);
  report.addTo(findings);
  result.timing = report.timing;
  result.times.correction_ms = stage.lapMs();

  measure(*prediction, result);  // the measurements record their own times
  stage.lapMs();

  estimate(*prediction, findings, result);
  result.times.fusion_ms = stage.lapMs();

  registration_.place(result.state);
  corner_svd_.place(result.state);
  result.times.reference_ms = stage.lapMs();

  result.condition = condition(findings, result);
  result.monitor = judge(result);
  result.times.total_ms = total.lapMs();
  return result;
}

void OdometryPipeline::stopRedundant() {
  start_from_stamp_s_.reset();
  monitor_.stop();
  last_output_ = MonitorOutput();
}

void OdometryPipeline::reset() {
  check_.reset();
  estimator_.reset();
  beginDrive();
}

}  // namespace fail_aware
