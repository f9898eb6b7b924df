#include "core/odometry_pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "core/estimator.hpp"
#include "core/integrity/silence.hpp"
#include "core/local_map_registration.hpp"
#include "core/parallel.hpp"
#include "core/parameters/validate.hpp"
#include "core/preprocessing/sweep_check.hpp"
#include "core/preprocessing/sweep_corrector.hpp"
#include "core/registration/corner_svd/corner_svd.hpp"
#include "core/types/exchanged.hpp"

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

PipelineParameters validated(const PipelineParameters& params) {
  validate(params);
  return params;
}

}  // namespace

const SourceResult& SweepResult::of(const std::string& source) const {
  static const SourceResult kNone;
  const auto found =
      std::find_if(sources.begin(), sources.end(), [&](const SourceResult& s) { return s.name == source; });
  return found == sources.end() ? kNone : *found;
}

struct OdometryPipeline::Stages {
  Stages(const PipelineParameters& p, int threads)
      : params(validated(p)),
        T_cog_lidar(quaternionRoundTrip(T_cog_base() * p.sensor.T_base_lidar())),
        check(p.sensor.check),
        corrector(p.sensor.vertical_angle, p.sensor.azimuth, p.sensor.correctedTiming(), p.profile.sweep_correction,
                  p.profile.vertical_reference),
        estimator(p),
        registration(p.profile.registration, p.sensor.correctedTiming()),
        corner_svd(p.profile.registration.corner_extraction, p.profile.registration.corner_reference,
                   p.profile.registration.corner_alignment),
        monitor(p.profile.monitor),
        arena(arenaSize(threads)),
        sources(makeSources()) {}

  struct Source {
    const char* name;
    bool used;
    FusionInput::Kind kind;
    bool needs_scan;  ///< measures after LocalMapRegistration::prepare()
    std::function<Measurement(const SweepPrediction&)> measure;
  };

  std::vector<Source> makeSources();
  Pose T_cog_base() const { return params.vehicle.T_base_cog().inverse(); }
  SweepResult step(Sweep& sweep);
  std::optional<SweepPrediction> predict(double stamp_s);
  SweepCorrectorReport deskew(Sweep& sweep, const SweepFindings& findings, const SweepPrediction& prediction);
  void estimate(const SweepPrediction& prediction, const SweepCorrectorReport& report, SweepResult& result);
  const MonitorOutput& judge(const SweepResult& result);
  void describeState(SweepResult& result) const;
  SweepResult refused();
  void beginDrive();
  void measure(const SweepPrediction& prediction, SweepResult& result);
  SweepCondition condition(const SweepFindings& findings, const SweepResult& result);

  PipelineParameters params;
  Pose T_cog_lidar;
  SweepCheck check;
  SweepCorrector corrector;
  Estimator estimator;
  LocalMapRegistration registration;
  CornerSvd corner_svd;
  FailAwareMonitor monitor;
  tbb::task_arena arena;
  std::vector<Source> sources;  ///< in the order of the fusion's inputs
  CorrectedSweep corrected;
  MonitorOutput last_output;
  int refused_sweeps = 0;                    ///< since the last accepted sweep
  std::optional<double> start_from_stamp_s;  ///< t1 is requested and not reached yet
};

/// A new source: a line here, last (files name the sources by their place), and its header above. Kinds: FusionInput. A
/// kPose that is ok counts as measured, so without anything to tell return a status; with dt_s 0 a drive begins: forget
/// what came before and return kNoReference. In the live graph: nodelets/measurement_sources.cpp.
std::vector<OdometryPipeline::Stages::Source> OdometryPipeline::Stages::makeSources() {
  const RegistrationParameters& use = params.profile.registration;
  using Kind = FusionInput::Kind;
  return {
      {kIcpPointToPoint, use.use_icp_point_to_point, Kind::kPose, true,
       [this, icp = IcpPointToPoint(use.icp_point_to_point)](const SweepPrediction&) {
         return registration.align(icp);
       }},
      {kIcpPointToPlane, use.use_icp_point_to_plane, Kind::kPose, true,
       [this, icp = IcpPointToPlane(use.icp_point_to_plane)](const SweepPrediction& p) {
         return registration.align(icp, p.sigma_yaw_rad);
       }},
      {kCornerSvd, use.use_corner_svd, Kind::kPose, false,
       [this](const SweepPrediction& p) { return corner_svd.measure(corrected, p, T_cog_lidar); }},
      {kRoadProfile, true, Kind::kMotion, true, [this](const SweepPrediction&) { return registration.roadProfile(); }},
      {kAboveGround, true, Kind::kPartial, true, [this](const SweepPrediction&) { return registration.aboveGround(); }},
  };
}

void OdometryPipeline::Stages::measure(const SweepPrediction& prediction, SweepResult& result) {
  for (const Source& source : sources) result.sources.push_back({source.name, source.kind, source.used, {}, 0.0});
  const auto measureThose = [&](bool needs_scan) {
    inParallelFor(sources.size(), [&](std::size_t i) {
      if (!sources[i].used || sources[i].needs_scan != needs_scan) return;
      Stopwatch watch;
      result.sources[i].measurement = exchanged(sources[i].measure(prediction));
      result.sources[i].duration_ms = watch.lapMs();
    });
  };
  inArena(arena, [&] {
    inParallel(
        [&] {
          Stopwatch thinning;
          registration.prepare(corrected, prediction, T_cog_lidar);
          result.times.correction_ms += thinning.lapMs();
          measureThose(true);
        },
        [&] { measureThose(false); });
  });
}

SweepCondition OdometryPipeline::Stages::condition(const SweepFindings& findings, const SweepResult& result) {
  SweepCondition condition;
  const auto missing = [&](const char* source) {
    return result.of(source).used && !result.of(source).measurement.ok();
  };
  const Measurement& planes = result.of(kIcpPointToPlane).measurement;
  condition.empty = corrected.points_lidar.empty();
  condition.dropped_before = std::exchange(refused_sweeps, 0);
  condition.incomplete = findings.incomplete;
  condition.low_visibility = findings.low_visibility;
  condition.frozen = findings.frozen;
  condition.time_jump = findings.time_jump;
  condition.time_field_refused = result.timing.guessed();
  condition.point_missing = missing(kIcpPointToPoint);
  condition.plane_missing = missing(kIcpPointToPlane);
  condition.corners_missing = missing(kCornerSvd);
  if (planes.ok()) {
    condition.min_information_ratio = planes.min_information_ratio;
    condition.ahead = planes.ahead;
  }
  return condition;
}

/// Resets everything except the estimator.
void OdometryPipeline::Stages::beginDrive() {
  refused_sweeps = 0;
  check.beginDrive();
  corrector.reset();
  registration.reset();
  corner_svd.reset();
  monitor.reset();
}

std::optional<SweepPrediction> OdometryPipeline::Stages::predict(double stamp_s) {
  const Estimator::Accepted accepted = estimator.accept(stamp_s);
  if (accepted.beginsDrive()) {
    beginDrive();
    // a request that waits stays valid; its stamp was that of another clock
    if (start_from_stamp_s) start_from_stamp_s = std::numeric_limits<double>::lowest();
  }
  SweepPrediction prediction;
  if (!accepted.taken() || !estimator.predict(stamp_s, accepted.set_back_s, prediction)) return std::nullopt;
  return exchanged(prediction);
}

SweepCorrectorReport OdometryPipeline::Stages::deskew(Sweep& sweep, const SweepFindings& findings,
                                                      const SweepPrediction& prediction) {
  const SweepCorrectorReport report = corrector.correct(sweep, prediction, T_cog_lidar, corrected);
  corrected.stamp_s = prediction.time_s();
  if (isLeftOut(findings, !(prediction.dt_s > 0.0))) corrected.clear();
  return report;
}

void OdometryPipeline::Stages::estimate(const SweepPrediction& prediction, const SweepCorrectorReport& report,
                                        SweepResult& result) {
  std::vector<FusionInput> inputs;
  for (const SourceResult& source : result.sources) {
    inputs.push_back({source.name, source.used ? &source.measurement : nullptr, source.kind});
  }
  const FilterState& state = estimator.update(inputs, report.middle_s, report.revolution_s, report.tilt_moment);
  describeState(result);
  result.pose_set = estimator.takePoseSet();
  result.refused_poses = estimator.refusedPoses();
  result.status = !state.started              ? SweepStatus::kNotStarted
                  : !(prediction.dt_s > 0.0)  ? SweepStatus::kFirst
                  : state.measurement_applied ? SweepStatus::kCorrected
                                              : SweepStatus::kPredicted;
}

void OdometryPipeline::Stages::describeState(SweepResult& result) const {
  const Pose& T_odom_cog = estimator.state().T_odom_cog;
  result.state = exchanged(estimator.state());
  result.T_odom_base = T_odom_cog * T_cog_base();
  result.odometry_covariance = covarianceAfterOffset(estimator.odometryCovariance(), T_odom_cog, T_cog_base());
}

SweepResult OdometryPipeline::Stages::refused() {
  ++refused_sweeps;
  SweepResult result;
  result.status = SweepStatus::kStampNotAdvancing;
  describeState(result);
  // a driver whose stamps stand still is as silent as one that sends nothing
  if (refused_sweeps >= SilenceParams().stale_sweeps) last_output = staleOutput(last_output);
  result.monitor = last_output;
  return result;
}

const MonitorOutput& OdometryPipeline::Stages::judge(const SweepResult& result) {
  if (start_from_stamp_s && result.state.stamp_s >= *start_from_stamp_s) {
    monitor.start();
    start_from_stamp_s.reset();
  }
  return last_output = monitor.update(result.state, result.condition);
}

SweepResult OdometryPipeline::Stages::step(Sweep& sweep) {
  Stopwatch total, stage;
  const std::optional<SweepPrediction> prediction = predict(sweep.stamp_s);
  if (!prediction) return refused();

  SweepResult result;
  const SweepFindings findings = check.check(sweep);
  const SweepCorrectorReport report = deskew(sweep, findings, *prediction);
  result.timing = report.timing;
  result.times.correction_ms = stage.lapMs();

  measure(*prediction, result);  // the measurements record their own times
  stage.lapMs();

  estimate(*prediction, report, result);
  result.times.fusion_ms = stage.lapMs();
  registration.place(result.state);
  corner_svd.place(result.state);
  result.times.reference_ms = stage.lapMs();

  result.condition = condition(findings, result);
  result.monitor = judge(result);
  result.times.total_ms = total.lapMs();
  return result;
}

OdometryPipeline::OdometryPipeline(const PipelineParameters& params, int threads) {
  requireWithin("threads", threads, 1, 256);
  stages_ = std::make_unique<Stages>(params, threads);
}

OdometryPipeline::~OdometryPipeline() = default;
SweepResult OdometryPipeline::step(Sweep& sweep) { return stages_->step(sweep); }
SweepResult OdometryPipeline::refuse() { return stages_->refused(); }
void OdometryPipeline::startRedundant(double from_stamp_s) { stages_->start_from_stamp_s = from_stamp_s; }

void OdometryPipeline::stopRedundant() {
  stages_->start_from_stamp_s.reset();
  stages_->monitor.stop();
  stages_->last_output = MonitorOutput();
}

void OdometryPipeline::reset() {
  stages_->check.reset();
  stages_->estimator.reset();
  stages_->beginDrive();
}

const VerticalReference& OdometryPipeline::verticalReference() const { return stages_->corrector.verticalReference(); }
std::string OdometryPipeline::seamContradiction() const { return stages_->corrector.seamContradiction(); }
const SweepClock& OdometryPipeline::sweepClock() const { return stages_->estimator.sweepClock(); }
std::string OdometryPipeline::setPose(const ExternalPose& pose) { return stages_->estimator.setPose(pose); }

void OdometryPipeline::addSource(const std::string& name, double tolerance_s) {
  stages_->estimator.addSource(name, tolerance_s);
}

std::string OdometryPipeline::offer(const std::string& source, const ExternalPose& pose) {
  return stages_->estimator.offer(source, pose);
}

}  // namespace fail_aware
