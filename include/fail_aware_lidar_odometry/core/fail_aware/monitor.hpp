// The fail-aware monitor of one sweep (paper, section "Fail-Aware Odometry System"): eta with its time to failure, the
// covariance's time to failure, their combination, state and reasons. What the FailAwareMonitor nodelet holds.
//
// t1, when the odometry begins to serve as the localisation, is the first sweep after start() whose motion is observed:
// before, the error has no bound that later sweeps would not lower. Until then times are unknown; `standby` says what
// they would be if t1 were now.
// Failure: an increment that cannot be added (pose, covariance or interval not finite) leaves the error without a bound:
// FAILED (COVARIANCE_LIMIT) until the next t1. Cost: < 0.1 ms.
#pragma once

#include <cstdint>
#include <optional>

#include "fail_aware_lidar_odometry/core/fail_aware/covariance_predictor.hpp"
#include "fail_aware_lidar_odometry/core/fail_aware/failure_state.hpp"
#include "fail_aware_lidar_odometry/core/fail_aware/indicator.hpp"
#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"
#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"
#include "fail_aware_lidar_odometry/core/moving_median.hpp"
#include "fail_aware_lidar_odometry/core/sweep/stamp_difference.hpp"

namespace fail_aware {

struct MonitorParameters {
  FailAwareIndicator::Params indicator;
  CovariancePredictor::Params predictor;
  DriftModel::Params drift;  ///< also of the published odometry's covariance
  FailureThresholds thresholds;
  double rate_window_s = 3.0;  ///< over which the increments' covariance rate is averaged
  int sweeps_to_recover = 10;
  double disagreement_m = 0.3;          ///< measurements farther apart than this disagree
  double min_information_share = 0.01;  ///< less in the weakest horizontal direction: reason WEAK_DIRECTION
  double gap_ratio = 1.7;               ///< a sweep that comes after so many times the usual period: sweeps are missing

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("indicator", self.indicator);
    v("predictor", self.predictor);
    v("drift", self.drift);
    v("thresholds", self.thresholds);
    v("rate_window_s", self.rate_window_s);
    v("sweeps_to_recover", self.sweeps_to_recover);
    v("disagreement_m", self.disagreement_m);
    v("min_information_share", self.min_information_share);
    v("gap_ratio", self.gap_ratio);
  }
  void validate() const;
};

/// What is known of a sweep beside the filter's state.
struct SweepCondition {
  bool empty = false;       ///< no usable point
  bool incomplete = false;  ///< part of the revolution is missing
  bool low_visibility = false;
  bool frozen = false;              ///< the sensor repeats itself
  bool time_jump = false;           ///< of the stamps, back or ahead
  bool time_field_refused = false;  ///< the points are timed by a guess
  bool no_answer = false;           ///< of a stage of the live graph, by the deadline
  int dropped_before = 0;           ///< sweeps lost since the last one
  bool point_missing = false;
  bool plane_missing = false;
  bool corners_missing = false;
  double min_information_share = 1.0;  ///< weakest horizontal direction, point to plane; 1: not known

  /// Every field: what the monitor's log is made of.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("empty", self.empty);
    v("incomplete", self.incomplete);
    v("low_visibility", self.low_visibility);
    v("frozen", self.frozen);
    v("time_jump", self.time_jump);
    v("time_field_refused", self.time_field_refused);
    v("no_answer", self.no_answer);
    v("dropped_before", self.dropped_before);
    v("point_missing", self.point_missing);
    v("plane_missing", self.plane_missing);
    v("corners_missing", self.corners_missing);
    v("min_information_share", self.min_information_share);
  }
};

struct MonitorOutput {
  double stamp_s = 0.0;
  double t1_stamp_s = -1.0;  ///< -1: does not serve
  FailAwareState state = FailAwareState::kUnknown;
  std::uint32_t reasons = 0;
  TimeToFailure time_to_failure;             ///< what the planner acts on: the earlier of the two
  TimeToFailure time_to_failure_indicator;   ///< from eta
  TimeToFailure time_to_failure_covariance;  ///< from the covariance's growth
  double eta = 0.0;
  double eta_rate_per_s = -1.0;  ///< -1: unknown
  double sigma_yaw_rad = 0.0;    ///< the filter's; -1: unknown
  double sigma_x_m = 0.0;        ///< accumulated since t1, in the frame at t1
  double sigma_y_m = 0.0;
  Matrix6d covariance_since_start = Matrix6d::Zero();  ///< what sigma_x_m, sigma_y_m are of; geometry/pose.hpp's order
  /// Bounds the horizontal error, with the predictor's confidence; 1e6: nothing does; -1: unknown.
  double protection_level_m = -1.0;
  FailAwareState standby_state = FailAwareState::kUnknown;  ///< before t1: if t1 were now
  TimeToFailure standby_time_to_failure;                    ///< likewise
};

/// Orders outputs, larger: later. The time (s); where it is 0, which orders no further, minus the protection level (m).
/// nullopt: unknown. `time`: one of the output's.
std::optional<double> failureOrder(const TimeToFailure& time, const MonitorOutput& output);

class FailAwareMonitor {
 public:
  explicit FailAwareMonitor(const MonitorParameters& params);

  /// t1 = the stamp of the next update() whose motion is observed. Once it serves, a pose set from outside (FilterState::odom_epoch) is a new
  /// t1: what went wrong before is mended by it.
  void start() { start_pending_ = true; }
  bool started() const { return indicator_.started() || start_pending_; }
  /// Asked for, but the motion has not been observed since.
  bool startPending() const { return start_pending_; }

  /// Limits that may change in flight: predictor, thresholds, disagreement_m, min_information_share. What was estimated
  /// stays. Throws ParameterError and changes nothing.
  void setLimits(const MonitorParameters& params);

  MonitorOutput update(const FilterState& state, const SweepCondition& condition);

  /// The covariance of T_odom_cog since the first sweep (FusionUkf publishes its own, from the start pose's on), geometry/pose.hpp's convention.
  const Matrix6d& odometryCovariance() const { return covariance_.covariance(); }

  /// The covariance of (x, y) accumulated since t1, m^2, about odom's axes; zero before t1.
  Eigen::Matrix2d horizontalCovarianceOdom() const;

  void reset();

 private:
  std::uint32_t reasonsFor(const FilterState& state, const SweepCondition& condition) const;
  bool isAfterGap(double dt_s);
  void begin(const FilterState& state);
  CovarianceGrowth growth(const FilterState& state, const DriftState& since_mark, const Pose& T_odom_mark) const;
  void addStandby(const FilterState& state, MonitorOutput& output) const;

  MonitorParameters params_;
  FailAwareIndicator indicator_;
  CovariancePredictor predictor_;
  DriftModel drift_;
  IncrementRate rate_;
  OdometryCovariance covariance_;
  StateHysteresis hysteresis_;
  Pose T_odom_mark_ = Pose::Identity();
  double t1_stamp_s_ = -1.0;
  int odom_epoch_ = 0;
  MovingMedian intervals_s_{kUsualIntervals};  ///< of the last sweeps
  bool has_previous_ = false;
  double speed_wander_ = 0.0;     ///< growth of the speed error's variance in the last sweep, m^2/s^3
  bool error_unbounded_ = false;  ///< since t1 there was an increment that could not be added
  bool start_pending_ = false;
};

}  // namespace fail_aware
