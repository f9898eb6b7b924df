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

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/estimation/pose_setting.hpp"
#include "core/estimation/sweep_clock.hpp"
#include "core/geometry/pose.hpp"
#include "core/pipeline_parameters.hpp"
#include "core/preprocessing/vertical_reference.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/fusion_input.hpp"
#include "core/types/measurement.hpp"
#include "core/types/sweep_condition.hpp"
#include "core/types/timing_result.hpp"
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
  void startRedundant(double from_stamp_s = std::numeric_limits<double>::lowest());
  void stopRedundant();

  /// Resets everything; the next sweep is the first.
  void reset();

  /// Sets the pose of base_link in odom; the next sweep applies it (estimation/pose_setting.hpp). Returns why the pose
  /// is refused; empty: it is accepted. SweepResult::pose_set gives the outcome.
  std::string setPose(const ExternalPose& pose);

  /// A source of external poses (estimation/external_pose.hpp). Offer each pose no later than the sweep it belongs to.
  void addSource(const std::string& name, double tolerance_s);
  /// Returns why the pose cannot be used; empty: the pose waits for its sweep.
  std::string offer(const std::string& source, const ExternalPose& pose);

  /// The tilt and drift estimated so far.
  const VerticalReference& verticalReference() const;

  /// One line: how the clouds contradict the sensor's timing parameters (sweep_seam.hpp). Empty: no contradiction.
  std::string seamContradiction() const;

  /// The head's period and the jitter of the stamps, as estimated so far.
  const SweepClock& sweepClock() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace fail_aware
