// The odometry, sweep by sweep: the stages of the article's architecture in order. This is the offline twin of the
// nodelets; both are made of the same objects.
//
//   predict -> correct the sweep -> three measurements -> fuse, correct the filter -> place the reference -> monitor
//
// Deterministic: the same sweeps give the same bits for any number of threads (what runs beside each other, and in which
// order it is added up, does not depend on it). Failure is data: SweepResult says what a sweep gave; every sweep whose
// stamp advances has a pose, from the first one with usable points on.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/pipeline_parameters.hpp"
#include "fail_aware_lidar_odometry/core/sweep/vertical_reference.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_clock.hpp"
#include "fail_aware_lidar_odometry/core/types/external_pose.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"
#include "fail_aware_lidar_odometry/core/types/monitor_output.hpp"
#include "fail_aware_lidar_odometry/core/types/pose_set.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_condition.hpp"
#include "fail_aware_lidar_odometry/core/types/timing_result.hpp"
#include "fail_aware_lidar_odometry/result.hpp"

namespace fail_aware {

struct StageTimes {
  double correction_ms = 0.0;  ///< prediction, timing, sweep correction, thinning
  double point_ms = 0.0;
  double plane_ms = 0.0;
  double corners_ms = 0.0;
  double fusion_ms = 0.0;
  double reference_ms = 0.0;
  double total_ms = 0.0;
};

struct SweepResult {
  SweepStatus status = SweepStatus::kFirst;
  FilterState state;
  Pose T_odom_base = Pose::Identity();
  Matrix6d odometry_covariance = Matrix6d::Zero();  ///< accumulated, of T_odom_base, geometry/pose.hpp's convention
  PoseSet pose_set;                                 ///< what became of a pose that was set
  Measurement point;
  Measurement plane;
  Measurement corners;
  TimingResult timing;       ///< of its points
  SweepCondition condition;  ///< what the monitor heard beside `state`
  MonitorOutput monitor;
  StageTimes times;
};

class OdometryPipeline {
 public:
  static constexpr std::size_t kPoint = 0, kPlane = 1, kCorners = 2;  ///< order of the fusion's inputs and weights

  /// Validates; throws ParameterError. threads >= 1.
  OdometryPipeline(const PipelineParameters& params, int threads);
  ~OdometryPipeline();

  /// A stamp that jumped (stamp_order.hpp) begins a drive at the last pose: reference, motion and t1 anew.
  /// `sweep` may be empty (a dropped or unreadable scan): the vehicle model carries the pose. It is used up.
  SweepResult step(Sweep& sweep);

  /// t1: the next sweep that is taken and not before `from_stamp_s`; from it on the odometry serves as the localisation.
  /// MonitorOutput says which it was.
  void startRedundant(double from_stamp_s = std::numeric_limits<double>::lowest());

  /// Everything anew; the next sweep is the first.
  void reset();

  /// Where base_link is in odom, said from outside; taken with the next sweep (filter/pose_setting.hpp). Why it is
  /// refused; empty: it is not. SweepResult::pose_set tells what became of it.
  std::string setPose(const ExternalPose& pose);

  /// A source of poses from elsewhere (fusion/external_pose.hpp), and its poses: no later than the sweep they are for.
  void addSource(const std::string& name, double tolerance_s);
  /// Why the pose cannot be used; empty: it waits for its sweep.
  std::string offer(const std::string& source, const ExternalPose& pose);

  /// What has been found of tilt and drift so far.
  const VerticalReference& verticalReference() const;

  /// One line: how the clouds contradict the sensor's timing parameters (sweep_seam.hpp). Empty: they do not.
  std::string seamContradiction() const;

  /// Period of the head and jitter of the stamps, as found so far.
  const SweepClock& sweepClock() const;

  /// The reference's points in odom.
  std::vector<Eigen::Vector3d> referencePoints() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace fail_aware
