// Whether the time between two stamps is the time that the car drove (not in the paper).
//
// A clock that is set in a drive makes one interval too long or too short; the prediction goes by the stamps, and
// registration that starts there may end metres beside the car. But the clouds know: where an interval is unusual, or
// stamps did not advance before it, the way of the other interval, at the speed so far, is tried, too. At a wrong
// place the road and other planes along the way fit as well as ever; what tells where along it the car is does not.
// So a place is judged by how much of the sweep fits and informs on the weakest horizontal direction, against the
// place that the stamps ask for and against what is usual. Where both ways lead to the same place, the one that ends
// nearer to it is right.
//
// Where the places cannot be told from each other (tunnels, open country) the stamps are believed. A clock that is set
// by less than half an interval is not looked for: registration bears that. Where the sweep after the doubtful interval
// was not measured (empty, or answered too late) the next ones are asked: they are as many intervals after the pose that
// was placed last, and any of those may be the wrong one.
// Cost: a registration from one seed every tenth sweep, and two to six in a sweep that comes after an unusual interval,
// until one is placed.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/moving_median.hpp"
#include "fail_aware_lidar_odometry/core/stamp_difference.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"

namespace fail_aware {

class ClockJumpDetector {
 public:
  struct Stamps {
    double dt_s = 0.0;        ///< between them
    double set_back_s = 0.0;  ///< one was refused meanwhile that was so much older than the first; 0: none was
  };
  struct Interval {
    Stamps stamps;
    std::vector<Stamps> unplaced{};             ///< of the sweeps before it, since the one that was placed last
    Pose T_odom_cog_placed = Pose::Identity();  ///< its pose
    Vector6d twist_cog = Vector6d::Zero();      ///< m/s and rad/s
    Pose T_odom_cog_predicted = Pose::Identity();
    std::optional<Pose> T_odom_cog_by_the_stamps{};  ///< what was found from there; none: nothing was
  };

  /// The sweep, registered from a pose on.
  using Fit = std::function<Measurement(const Pose& T_odom_cog)>;

  /// Each interval in turn. Where the sweep is, if it is by another interval than the stamps'.
  std::optional<Pose> findOther(const Interval& interval, const Fit& fit);

  void reset() { *this = ClockJumpDetector(); }

 private:
  struct Place {
    double share = 0.0;        ///< of the sweep's points that fit; 0: none found
    double information = 0.0;  ///< likewise, of those that inform on the weakest horizontal direction
    bool observed = false;     ///< in all directions
    double moved_m = 0.0;      ///< by registration
    Pose T_odom_cog = Pose::Identity();
  };
  static std::vector<double> otherTimes_s(const Interval& interval, double usual_s);
  static Place placeFrom(const Pose& T_odom_cog, const Fit& fit);
  bool isRight(const Place& place, double reach_m, double clearly_m, const std::optional<Place>& by_the_stamps,
               const Pose& T_odom_cog_predicted) const;

  MovingMedian intervals_s_{kUsualIntervals};  ///< that were not doubted
  Place usual_;                                ///< looked at every some sweeps
  int sweeps_to_usual_ = 0;
};

}  // namespace fail_aware
