// What a sweep's increment is to be doubted for, whatever the measurements' R says. Not in the article.
//
// Four signs, of which three must last:
// - Measurements that stay apart: one of two is wrong, and the fused one may be as wrong as they are apart. Now and then
//   that is chance; where it lasts the odometry is being led astray. What is outvoted is not counted, what is
//   outnumbered by its weight (FusionResult::undecided_m).
// - A vehicle moves nearly as it was predicted to: measurements that lie off that sweep after sweep are as uncertain as
//   that, and what they are off by stays in the map.
// - Where next to nothing of the sweeps fits the map, what does was selected by the prediction and confirms it, whatever
//   the vehicle does. A speed taken from that would run away: from the first such sweep on it tells no motion, unless
//   nothing has fitted yet (a start where little stands).
// - What turns the vehicle at once is none of its own doing (a blow to the head, a wrong place): a share of that may be
//   an error.
// "Lasting" is the median of the last sweeps. Cost: under 1 us a sweep.
#pragma once

#include <optional>

#include "fail_aware_lidar_odometry/core/moving_median.hpp"

namespace fail_aware {

class ConsistencyMonitor {
 public:
  struct Params {
    double persistent_disagreement_m = 0.15;  ///< what measurements stay farther apart than this is an error, too
    double persistent_innovation_m = 0.07;    ///< so far off the prediction, sweep after sweep, is an error, too; 0: off
    double fitting_ratio = 0.3;        ///< of the planes' points: where less fits the map, R is not believed; 0: off
    double unfitting_sigma_m = 0.25;   ///< sigma that a sweep adds of which nothing fits: 2.5 m/s at 10 Hz
    double max_yaw_innovation_deg = 4.5;       ///< off the prediction, of one sweep: more is an error, too; 0: off
    double wrong_ratio_of_turn = 0.1;  ///< standard deviation of a sudden turn's error, as a ratio of the turn

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("persistent_disagreement_m", self.persistent_disagreement_m);
      v("persistent_innovation_m", self.persistent_innovation_m);
      v("fitting_ratio", self.fitting_ratio);
      v("max_yaw_innovation_deg", self.max_yaw_innovation_deg);
    }
    void validate() const;
  };

  struct Sweep {
    double dt_s = 0.0;
    double undecided_m = 0.0;   ///< FusionResult's
    double innovation_m = 0.0;  ///< horizontally, of the fused measurement; 0 where no good prediction was expected
    double turn_rad = 0.0;      ///< likewise
    std::optional<double> fitting_ratio;  ///< of the planes' points; none: nothing was measured by planes
    double time_sigma_m = 0.0;            ///< of the prediction, because the interval is not known better
  };

  struct Inflation {
    double sigma_m = 0.0;  ///< of an error more in the increment, along the way and across it each
    double sigma_yaw_rad = 0.0;
    bool unbelievable = false;  ///< measurements that agree in this confirm nothing
    /// Next to nothing fits the map, which once fitted: what is measured is what was predicted.
    bool velocity_unobservable = false;
  };

  explicit ConsistencyMonitor(const Params& params);

  Inflation add(const Sweep& sweep);

  /// What lasted ends here: another pose was set, or another map begins.
  void clear();

 private:
  double persistentInnovation_m(double dt_s) const;
  double unfitting_m() const;

  Params params_;
  MovingMedian undecided_m_{5}, innovation_m_{10}, fitting_ratio_{3};
  bool fitted_ = false;            ///< most of the sweeps did once
  int sweeps_without_planes_ = 0;  ///< in a row
};

}  // namespace fail_aware
