// Decides whether the references (local map, past corners) insert a sweep, skip it or restart. Not in the paper.
//
// Insert, if one of these holds:
// - the sweep is measured, including roll and pitch, and is not one of the first two after a long gap;
// - a reference begins with it: the first sweep, and, before a motion is known, a sweep that had no reference to
//   register against;
// - the sweep follows a measured one, so its prediction is good, and shows what the references do not hold: the other
//   half of a revolution.
// Restart, at an estimate whose error stays in every later pose:
// - after consecutive sweeps that were registered and fitted nowhere: the reference is out of sight;
// - after measured sweeps in which the velocity was unobservable, one after the other: the inserted ones spoil the
//   reference;
// - when the motion is lost (lost_motion.hpp): the sweeps inserted during dead reckoning spoil the reference;
// - when both ICPs have no reference, unless a pose was set: setting a pose moves odom, and both ICPs must begin again.
//   If only one ICP has no reference, its nodelet was restarted.
// Skip: every other sweep. The first two after a long gap are deskewed with the motion before the gap, or with the mean
// over it. Where they show what the references do not hold, the next sweeps fit them at a wrong motion, and the error
// goes on. Those two are registered against what was there before the gap.
// Cost: under 1 us a sweep.
#pragma once

#include <vector>

#include "core/types/estimator_decisions.hpp"
#include "core/types/fusion_input.hpp"

namespace fail_aware {

/// Whether a drive can begin with these measurements' sweep. False for an empty sweep or without an answer from the
/// ICPs: the next sweep would have nothing to register against.
bool canBegin(const std::vector<FusionInput>& measurements);

class MapUpdatePolicy {
 public:
  struct Sweep {
    bool motion_known = false;           ///< SweepPrediction::motionKnown()
    bool measured = false;               ///< FilterState::measurement_applied
    bool observed = false;               ///< corrected by a measurement that observes roll and pitch
    bool velocity_unobservable = false;  ///< ConsistencyMonitor::Inflation's, of the last corrected sweep
    bool follows = false;                ///< the last sweep was measured, and the interval to it is not long
    bool motion_lost = false;            ///< ConsistencyMonitor::Inflation's
    double dt_s = 0.0;                   ///< since the last sweep
  };

  struct Decision {
    MapUpdate update = MapUpdate::kSkip;
    bool begins = false;        ///< there was no reference before
    bool out_of_sight = false;  ///< reason of the restart
  };

  Decision add(const std::vector<FusionInput>& measurements, const Sweep& sweep);

  /// odom was moved under the vehicle since the last sweep.
  void setPose() { pose_set_ = true; }

  void clear() { *this = MapUpdatePolicy(); }

 private:
  /// Whether the sweep is one of the first two measured ones after a long gap.
  bool followsGap(const Sweep& sweep);

  bool started_ = false;
  bool pose_set_ = false;
  double unmeasured_s_ = 0.0;  ///< since the last measured estimate
  int after_gap_sweeps_ = 0;   ///< measured ones that are still to be skipped
  int skipped_sweeps_ = 0;     ///< consecutive, registered against the reference without success
  int held_sweeps_ = 0;        ///< of consecutive ones with unobservable velocity, the measured ones
};

}  // namespace fail_aware
