// Inflates the covariance of a sweep's increment when the measurements' R is not plausible. Not in the paper.
//
// Seven signs. The first three and the last must persist (medians over the last sweeps):
// - Measurements disagree. One of them is wrong, and the fused measurement may be wrong by the same distance. A single
//   disagreement can be chance; a lasting one leads the odometry astray. An outvoted measurement does not count, an
//   outnumbered one counts by its weight (FusionResult::undecided_m).
// - Measurements differ from the prediction in every sweep. A vehicle moves nearly as predicted, so the measurements
//   are as uncertain as this difference, and the difference stays in the map.
// - Almost nothing fits the map. The few points that fit were selected by the prediction and confirm it, whatever the
//   vehicle does. A speed estimated from them would diverge, so the velocity is unobservable from the first such sweep
//   on, unless nothing has fitted yet (a start in a place with few objects). A map of one or two sweeps is too young to
//   judge by.
// - The rotation jumps. A vehicle does not turn or tilt that fast by itself (the sensor was hit, or the pose is wrong),
//   so a fraction of the jump may be an error of the heading.
// - The position jumps: most measurements that agree are outside the gate. Sources that share the map can all settle in
//   the same wrong place, so the whole jump may be an error, unless the map confirms it and it is short or whole sweeps
//   ahead: then sweeps are lost which the stamps do not count.
// - Measurements disagree in the first two sweeps after a gap of a second or more. Little of the scenery was in view
//   before the gap, so the pose may settle half a metre off, and the next sweeps that enter the map keep this error.
//   Where it is right, the measurements agree within centimetres, however little fits.
// - The points are noisy: those that fit the map stay far from its surfaces (median of five sweeps). The map gets as
//   thick as the noise, and the pose slides through it: the errors of the sweeps' increments add up, where a map
//   usually ends them.
// Cost: under 1 us a sweep.
#pragma once

#include <cstddef>
#include <optional>

#include "core/estimation/fitting_ratio.hpp"
#include "core/estimation/lost_motion.hpp"
#include "core/moving_median.hpp"
#include "core/parameters/check.hpp"
#include "core/types/motion_doubt.hpp"

namespace fail_aware {

class ConsistencyMonitor {
 public:
  struct Params {
    double persistent_disagreement_m = 0.15;  ///< a lasting disagreement above this inflates the covariance
    double persistent_innovation_m = 0.1;     ///< a lasting innovation above this inflates the covariance; 0: off
    double fitting_ratio = 0.3;               ///< R is not trusted where less of the scenery fits; 0: off
    double unfitting_sigma_m = 0.25;          ///< sigma added by a sweep with no inlier: 2.5 m/s at 10 Hz
    double max_yaw_innovation_deg = 4.5;      ///< a larger innovation in one sweep inflates the covariance; 0: off
    double wrong_ratio_of_turn = 0.1;         ///< standard deviation of a heading jump's error, as a ratio of the jump

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("persistent_disagreement_m", self.persistent_disagreement_m, requirePositive);
      v("persistent_innovation_m", self.persistent_innovation_m, requireNotNegative);
      v("fitting_ratio", self.fitting_ratio, within(0.0, 1.0));
      v("max_yaw_innovation_deg", self.max_yaw_innovation_deg, requireNotNegative);
    }
  };

  struct Sweep {
    double dt_s = 0.0;
    double undecided_m = 0.0;            ///< FusionResult::undecided_m
    double innovation_m = 0.0;           ///< horizontal, of the fused measurement; 0 if the prediction is not reliable
    double turn_rad = 0.0;               ///< rotation part of the innovation; 0 likewise
    std::optional<double> inlier_ratio;  ///< of point-to-plane; none: it did not measure
    std::size_t inliers = 0;             ///< likewise; 0: not known
    double rms_residual_m = 0.0;         ///< likewise, of the inliers; 0: not known
    double increment_sigma_m = 0.0;      ///< standard deviation of the increment, along or across: the larger one
    double increment_sigma_yaw_rad = 0.0;
    double disagreement_m = 0.0;  ///< FusionResult::disagreement_m
    bool dead_reckoned = false;   ///< the speed before this sweep was not observed
    double time_sigma_m = 0.0;    ///< sigma of the prediction due to the uncertain interval between sweeps
    bool overruled = false;       ///< FusionResult::prediction_overruled
    double ahead_m = 0.0;         ///< part of the innovation along the vehicle; positive: farther than predicted
    double per_period_m = 0.0;    ///< distance that the prediction assumes per sweep; 0: not known
    double tilt_rad = 0.0;        ///< roll and pitch of the innovation, part of turn_rad
  };

  struct Inflation {
    MotionDoubt doubt;          ///< to add to the increment
    bool unbelievable = false;  ///< agreement between the measurements confirms nothing in this sweep
    /// Almost nothing fits the map, although it did before: the measurement only repeats the prediction.
    bool velocity_unobservable = false;
    bool sweeps_lost = false;  ///< that the stamps do not count: the increment is not a motion over the interval
    bool motion_lost = false;  ///< the map is useless after dead reckoning (lost_motion.hpp)
  };

  explicit ConsistencyMonitor(const Params& params) : params_(params), lost_motion_(params.fitting_ratio) {}

  Inflation add(const Sweep& sweep);

  /// Forgets the history: another pose was set, or another map begins.
  void clear();

 private:
  void forgetSweeps();
  bool fitsAsBefore(const Sweep& sweep, double fit) const;
  double persistentInnovation_m(double dt_s) const;
  double unfitting_m() const;

  Params params_;
  MovingMedian undecided_m_{5}, innovation_m_{10}, recent_fit_{3}, residual_m_{5};
  FittingRatio fitting_ratio_;
  LostMotion lost_motion_;
  bool fitted_ = false;            ///< most of the sweeps fitted the map at least once
  double without_planes_s_ = 0.0;  ///< since the last sweep that planes measured
  int sweeps_in_map_ = 0;          ///< that planes measured, since clear()
};

}  // namespace fail_aware
