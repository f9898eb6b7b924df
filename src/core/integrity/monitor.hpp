// The fail-aware monitor of one sweep (paper, section "Fail-Aware Odometry System"): eta with its time to failure, the
// covariance's time to failure, their combination, state and reasons. What the FailAwareMonitor nodelet holds.
//
// t1, when the odometry begins to serve as the localisation, is the first sweep after start(). If its motion is not
// observed, or a gap is before it, the error since the sweep before counts. If no motion is known at start(), t1 is the
// first sweep whose motion is observed: before, the error has no bound. Until t1 times are unknown; `standby` says what
// they would be if t1 were now.
// Failure: an increment that cannot be added (pose, covariance or interval not finite), or states that were lost (this
// one does not begin where the last one ended), leave the error without a bound: FAILED (COVARIANCE_LIMIT) until the
// next t1, or UNKNOWN as long as the rate of growth is not known. Cost: < 0.1 ms.
#pragma once

#include <cstdint>
#include <optional>

#include "core/estimation/odometry_covariance.hpp"
#include "core/integrity/covariance_predictor.hpp"
#include "core/integrity/failure_state.hpp"
#include "core/integrity/growth_rate.hpp"
#include "core/integrity/indicator.hpp"
#include "core/integrity/recent_shortest_time.hpp"
#include "core/moving_median.hpp"
#include "core/parameters/check.hpp"
#include "core/stamp_difference.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/sweep_condition.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

struct MonitorParameters {
  FailAwareIndicator::Params indicator;
  CovariancePredictor::Params predictor;
  DriftModel drift;  ///< also of the published odometry's covariance
  FailureThresholds thresholds;
  double rate_window_s = 3.0;  ///< over which the increments' covariance rate is averaged
  int sweeps_to_recover = 10;
  double disagreement_m = 0.3;          ///< measurements farther apart than this disagree
  double min_information_ratio = 0.01;  ///< less in the weakest horizontal direction: reason WEAK_DIRECTION
  double gap_ratio = 1.7;               ///< a sweep that comes after so many times the usual period: sweeps are missing

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("indicator", self.indicator);
    v("predictor", self.predictor);
    v("drift", self.drift);
    v("thresholds", self.thresholds);
    v("rate_window_s", self.rate_window_s, requirePositive);
    v("sweeps_to_recover", self.sweeps_to_recover, within(1, 10000));
    v("disagreement_m", self.disagreement_m, requirePositive);
    v("min_information_ratio", self.min_information_ratio, within(0.0, 1.0));
    v("gap_ratio", self.gap_ratio, within(1.0, 1e6));
  }
  void checkRules() const;
};

/// Orders outputs, larger: later. The time (s); where it is 0, which orders no further, minus the protection level (m).
/// nullopt: unknown. `time`: one of the output's.
std::optional<double> failureOrder(const TimeToFailure& time, const MonitorOutput& output);

class FailAwareMonitor {
 public:
  explicit FailAwareMonitor(const MonitorParameters& params);

  /// t1 = the stamp of the next update(), or of the next one whose motion is observed, see above. An earlier t1 ends
  /// now, and its state with it. Once it serves, a pose set from outside (FilterState::odom_reset_count) is a new t1.
  void start();
  /// No t1 any more: the state is UNKNOWN, and standby is given again.
  void stop();
  bool started() const { return indicator_.started() || startPending(); }
  /// Asked for, but not begun: no sweep came, or no motion is known.
  bool startPending() const { return requested_ != Start::kNot; }

  /// Limits that may change in flight: predictor, thresholds, disagreement_m, min_information_ratio. What was estimated
  /// stays.
  void setLimits(const MonitorParameters& params);

  MonitorOutput update(const FilterState& state, const SweepCondition& condition);

  /// Whether the state's pose is that of the last update(): odom was not moved between them. True before the first.
  bool isWhereItWas(const FilterState& state) const;

  /// The covariance of (x, y) accumulated since t1, m^2, about odom's axes; zero before t1.
  Eigen::Matrix2d horizontalCovarianceOdom() const;

  void reset();

 private:
  std::uint32_t reasonsFor(const FilterState& state, const SweepCondition& condition) const;
  bool isAfterGap(double dt_s);
  bool follows(const FilterState& state) const;
  bool enter(const FilterState& state);  ///< true: states were lost before this one
  void accumulate(const FilterState& state);
  void judge(const FilterState& state, MonitorOutput& output);
  void keepMotion(const FilterState& state);
  void begin(const FilterState& state, const Pose& T_odom_mark);
  CovarianceGrowth growth(const FilterState& state, const DriftState& since_mark, const Pose& T_odom_mark) const;
  void addStandby(const FilterState& state, MonitorOutput& output) const;
  TimeToFailure predictFailure(const FilterState& state, MonitorOutput& output);

  MonitorParameters params_;
  FailAwareIndicator indicator_;
  CovariancePredictor predictor_;
  GrowthRate growth_rate_;
  OdometryCovariance covariance_;
  StateHysteresis hysteresis_;
  RecentShortestTime shortest_time_;
  struct Mark {
    Pose T_odom = Pose::Identity();
    double t1_stamp_s = -1.0;
    DriftSinceMark since;
    DriftState drift;  ///< of `since`, when the error last could not be taken back at once: what the time counts from
  };
  Mark mark_;
  int odom_reset_count_ = 0;
  MovingMedian intervals_s_{kUsualIntervals};  ///< of the last sweeps
  struct Motion {
    Pose T_previous_now = Pose::Identity();
    double dt_s = 0.0;
    double speed_mps() const { return dt_s > 0.0 ? T_previous_now.translation().norm() / dt_s : 0.0; }
  };
  Motion motion_;
  struct Last {
    Pose T_odom_cog = Pose::Identity();
    bool measured = false;  ///< or the first
    bool motion_known = false;
  };
  std::optional<Last> last_;      ///< of the last update()
  bool error_unbounded_ = false;  ///< since t1 an increment could not be added, or states were lost
  enum class Start { kNot, kWithNextSweep, kOnceObserved };
  Start requested_ = Start::kNot;
};

}  // namespace fail_aware
