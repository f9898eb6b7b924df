// Detects a clock jump: the interval between two stamps differs from the time that the vehicle drove (not in the
// paper).
//
// A clock that is set during a drive makes one interval too long or too short. The prediction follows the stamps, so
// registration may start, and end, metres beside the vehicle. The point clouds reveal the error. If an interval is
// unusual, or a stamp before it was refused, the detector also registers the sweep at the distance driven in another
// interval, at the last known speed. At a wrong pose, the road and other planes along the direction of travel still
// fit; the points that observe the position along the road do not. The detector therefore judges a pose by the ratio of
// points that fit and that inform on the weakest horizontal direction. It compares this pose with the one from the
// stamps and with the usual values. If both starts converge to the same pose, the start nearer to that pose is right.
//
// If the poses cannot be distinguished (tunnels, open country), the stamps are believed. A jump of less than half an
// interval is not detected: registration tolerates it. If the sweep after the unusual interval was not measured (empty,
// or too late), the next sweeps are tested: they follow the last inserted pose by several intervals, and any of these
// may be wrong. If the sweep fits badly, sweeps may have been lost while the clock was set: all poses up to 15 m ahead
// and behind are tried.
//
// Input: poses of the centre of gravity in odom; twists in m/s and rad/s.
// Failure: nullopt; the pose from the stamps stays.
// Cost: one single-seed registration every tenth sweep; two to six in a sweep after an unusual interval, until a sweep
// is inserted; some 40 more (0.2 s) where it fits badly.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/moving_median.hpp"
#include "core/stamp_difference.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

class ClockJumpDetector {
 public:
  struct Stamps {
    double dt_s = 0.0;  ///< between the two stamps
    /// a stamp in between was refused because it was this much older than the first one; 0: none
    double set_back_s = 0.0;
  };
  struct Interval {
    Stamps stamps;
    std::vector<Stamps> unplaced{};             ///< of the earlier sweeps since the one that was inserted last
    Pose T_odom_cog_placed = Pose::Identity();  ///< pose of the sweep that was inserted last
    Vector6d twist_cog = Vector6d::Zero();      ///< m/s and rad/s
    Pose T_odom_cog_predicted = Pose::Identity();
    std::optional<Pose> T_odom_cog_by_the_stamps{};  ///< the result from the stamps' pose; none: not found
  };

  /// Registers the sweep from a start pose.
  using Fit = std::function<Measurement(const Pose& T_odom_cog)>;

  /// Call for every interval, in order. Returns the sweep's pose if another interval than the stamps' explains it.
  std::optional<Pose> findOther(const Interval& interval, const Fit& fit);

  void reset() { *this = ClockJumpDetector(); }

 private:
  struct Place {
    double ratio = 0.0;        ///< inlier ratio; 0: no pose found
    double information = 0.0;  ///< likewise, of the points that inform on the weakest horizontal direction
    bool observed = false;     ///< in all directions
    double moved_m = 0.0;      ///< from the start pose to the registered pose
    Pose T_odom_cog = Pose::Identity();
  };
  static std::vector<double> otherTimes_s(const Interval& interval, double usual_s);
  static std::vector<double> allTimes_s(const Interval& interval, double usual_s);
  bool isMisfit(const Place& place) const;
  static Place placeFrom(const Pose& T_odom_cog, const Fit& fit);
  bool isRight(const Place& place, double reach_m, double clearly_m, const std::optional<Place>& by_the_stamps,
               const Pose& T_odom_cog_predicted) const;

  MovingMedian intervals_s_{kUsualIntervals};  ///< intervals without doubt
  Place usual_;                                ///< updated every few sweeps
  int sweeps_to_usual_ = 0;
};

}  // namespace fail_aware
