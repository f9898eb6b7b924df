// Whether the references (local map, corners seen so far) take a sweep in, and when they begin anew. Not in the article.
//
// A sweep is placed if it was measured, in roll and pitch, too, or if a reference begins with it: the first sweep, and
// those before a motion is known that had nothing to be registered against. Also if it follows a measured sweep, so that
// its prediction is good, and shows what the references do not hold: the other half of a revolution.
// References begin anew, at an estimate whose error is in all that is measured from there on:
// - after sweeps in a row that were sought and fitted nowhere: the reference is out of sight;
// - after sweeps in a row that told no motion: what was placed of them spoils the reference;
// - where both ICPs began theirs by themselves (road_relief.hpp), but for a pose that was set: that moves odom, and they
//   must. One that says so alone is another one that was started.
// Cost: under 1 us a sweep.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/types/fusion_input.hpp"

namespace fail_aware {

class ReferencePlacement {
 public:
  struct Sweep {
    bool motion_known = false;     ///< SweepPrediction's
    bool observed = false;         ///< corrected by what observes roll and pitch
    bool tells_no_motion = false;  ///< MotionPlausibility::Doubt's, of the last sweep that was corrected
    bool follows = false;          ///< a measured sweep, by no long interval
  };

  struct Placement {
    bool begins = false;        ///< there was no reference before
    bool placed = false;        ///< the references take it in
    bool anew = false;          ///< another reference than the one before
    bool out_of_sight = false;  ///< the one before, therefore
  };

  Placement add(const std::vector<FusionInput>& measurements, const Sweep& sweep);

  /// odom was moved under the vehicle since the last sweep.
  void setPose() { pose_set_ = true; }

  void clear() { *this = ReferencePlacement(); }

 private:
  bool started_ = false;
  bool pose_set_ = false;
  int unplaced_sweeps_ = 0;  ///< in a row, that were sought in the reference
  int held_sweeps_ = 0;      ///< in a row, that told no motion
};

}  // namespace fail_aware
