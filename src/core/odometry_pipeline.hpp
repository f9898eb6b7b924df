// Runs the odometry sweep by sweep: the stages of the paper's architecture in order. It is the offline counterpart of
// the nodelets and uses the same objects.
//
//   predict -> correct the sweep -> measure (a list of sources) -> fuse, correct the filter -> update the map ->
//   monitor
//
// Deterministic: the same sweeps give the same bits for any number of threads (the number of threads changes neither
// what runs in parallel nor the order of summation). Failure is data: SweepResult describes what a sweep gave. From the
// first sweep with usable points on, every sweep whose stamp advances has a pose.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator.hpp"
#include "core/local_map_registration.hpp"
#include "core/pipeline_parameters.hpp"
#include "core/preprocessing/sweep_check.hpp"
#include "core/preprocessing/sweep_corrector.hpp"
#include "core/registration/corner_svd/corner_svd.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"
#include "fail_aware_lidar_odometry/result.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

struct StageTimes {
  double correction_ms = 0.0;  ///< prediction, timing, deskew, thinning
  double fusion_ms = 0.0;
  double reference_ms = 0.0;
  double total_ms = 0.0;
};

/// What one source measured in a sweep.
struct SourceResult {
  std::string name;
  FusionInput::Kind kind = FusionInput::Kind::kPose;
  bool used = true;  ///< false: a parameter leaves the source out, and `measurement` says nothing
  Measurement measurement;
  double duration_ms = 0.0;
};

struct SweepResult {
  SweepStatus status = SweepStatus::kFirst;
  FilterState state;
  Pose T_odom_base = Pose::Identity();
  Matrix6d odometry_covariance = Matrix6d::Zero();  ///< accumulated, of T_odom_base, geometry/pose.hpp's convention
  PoseSet pose_set;                                 ///< outcome of a pose that was set
  std::vector<RefusedPose> refused_poses;           ///< of external sources
  std::vector<SourceResult> sources;                ///< in the order of the fusion's weights
  TimingResult timing;                              ///< of the sweep's points
  SweepCondition condition;                         ///< the monitor's input beside `state`
  MonitorOutput monitor;
  StageTimes times;

  /// Of that source; a result without a pose if there is none of that name.
  const SourceResult& of(const std::string& source) const;
};

class OdometryPipeline {
 public:
  /// Validates the parameters; throws ParameterError. threads >= 1.
  OdometryPipeline(const PipelineParameters& params, int threads);
  ~OdometryPipeline();

  /// A stamp that jumped (stamp_order.hpp) begins a new drive at the last pose: reference, motion and t1 are reset.
  /// `sweep` may be empty (a dropped or unreadable scan): the vehicle model then predicts the pose. step()
  /// moves from `sweep`.
  SweepResult step(Sweep& sweep);

  /// In place of step(), for a sweep that is none of this drive: the result of a stamp that is refused.
  SweepResult refuse();

  /// Starts the time t1 at the next accepted sweep that is not before `from_stamp_s`; from t1 on the odometry serves as
  /// the localisation. MonitorOutput says which sweep it was.
  void startRedundant(double from_stamp_s = std::numeric_limits<double>::lowest()) {
    start_from_stamp_s_ = from_stamp_s;
  }
  void stopRedundant();

  /// Resets everything; the next sweep is the first.
  void reset();

  /// As Estimator's functions of these names. Offer a pose no later than the sweep that it belongs to.
  std::string setPose(const ExternalPose& pose) { return estimator_.setPose(pose); }
  void addSource(const std::string& name, double tolerance_s) { estimator_.addSource(name, tolerance_s); }
  std::string offer(const std::string& source, const ExternalPose& pose) { return estimator_.offer(source, pose); }

  /// The tilt and drift estimated so far.
  const VerticalReference& verticalReference() const { return corrector_.verticalReference(); }

  /// One line: how the clouds contradict the sensor's timing parameters (sweep_seam.hpp). Empty: no contradiction.
  std::string seamContradiction() const { return corrector_.seamContradiction(); }

  /// The head's period and the jitter of the stamps, as estimated so far.
  const SweepClock& sweepClock() const { return estimator_.sweepClock(); }

 private:
  struct Source {
    bool used;
    bool needs_scan;  ///< measures after LocalMapRegistration::prepare()
    std::function<Measurement(const SweepPrediction&)> measure;
  };

  std::array<Source, kBuiltInSources.size()> makeSources();
  Pose T_cog_base() const { return params_.vehicle.T_base_cog().inverse(); }
  std::optional<SweepPrediction> predict(double stamp_s);
  SweepCorrectorReport deskew(Sweep& sweep, const SweepFindings& findings, const SweepPrediction& prediction);
  void measure(const SweepPrediction& prediction, SweepResult& result);
  void estimate(const SweepPrediction& prediction, const SweepFindings& findings, SweepResult& result);
  void describeState(SweepResult& result) const;
  SweepCondition condition(const SweepFindings& findings, const SweepResult& result);
  const MonitorOutput& judge(const SweepResult& result);
  void beginDrive();

  PipelineParameters params_;
  Pose T_cog_lidar_;
  SweepCheck check_;
  SweepCorrector corrector_;
  Estimator estimator_;
  LocalMapRegistration registration_;
  CornerSvd corner_svd_;
  FailAwareMonitor monitor_;
  struct Arena;                                         ///< TBB's: who includes this header does not need TBB
  std::unique_ptr<Arena> arena_;                        ///< the threads of the measurements
  std::array<Source, kBuiltInSources.size()> sources_;  ///< in the order of the fusion's inputs
  CorrectedSweep corrected_;
  MonitorOutput last_output_;
  int refused_sweeps_ = 0;                    ///< since the last accepted sweep
  std::optional<double> start_from_stamp_s_;  ///< t1 is requested and not reached yet
};

}  // namespace fail_aware
