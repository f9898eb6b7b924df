// What the references (local map, corners seen so far) do with a sweep. Not in the article.
//
// Insert: the sweep was measured, roll and pitch too; or a reference begins with it (the first sweep, and before a motion
// is known those that had nothing to be registered against); or it follows a measured sweep, so that its prediction is
// good, and shows what the references do not hold: the other half of a revolution.
// Restart, at an estimate whose error is in all that is measured from there on:
// - after sweeps in a row that were sought and fitted nowhere: the reference is out of sight;
// - after sweeps in a row from which the velocity was not observable: those that joined spoil the reference;
// - where both ICPs have no reference, but for a pose that was set: that moves odom, and they must begin anew. One ICP
//   alone without a reference is a nodelet that was started again.
// Skip: every other sweep.
// Cost: under 1 us a sweep.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/types/fusion_input.hpp"
#include "fail_aware_lidar_odometry/core/types/map_update.hpp"

namespace fail_aware {

class MapUpdatePolicy {
 public:
  struct Sweep {
    bool motion_known = false;     ///< SweepPrediction's
    bool observed = false;         ///< corrected by what observes roll and pitch
    bool velocity_unobservable = false;  ///< ConsistencyMonitor::Doubt's, of the last sweep that was corrected
    bool follows = false;          ///< a measured sweep, by no long interval
  };

  struct Decision {
    MapUpdate update = MapUpdate::kSkip;
    bool begins = false;        ///< there was no reference before
    bool out_of_sight = false;  ///< why it is a restart
  };

  Decision add(const std::vector<FusionInput>& measurements, const Sweep& sweep);

  /// odom was moved under the vehicle since the last sweep.
  void setPose() { pose_set_ = true; }

  void clear() { *this = MapUpdatePolicy(); }

 private:
  bool started_ = false;
  bool pose_set_ = false;
  int skipped_sweeps_ = 0;  ///< in a row, that were sought in the reference
  int held_sweeps_ = 0;     ///< in a row, that told no motion
};

}  // namespace fail_aware
