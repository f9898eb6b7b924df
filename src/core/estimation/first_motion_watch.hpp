// Whether the first motion of a drive is known, and when the search for it must begin again. Not in the paper.
//
// Two first motions may be wrong though everything fits: a map that was made at a guessed speed (in a tunnel) later
// seems to confirm it; and a standstill that nothing observes (on highways), from the start or after one that was
// observed: the vehicle may have driven off unseen. The search repeats after 20, 40, 80, ... sweeps of such a standstill,
// as the vehicle may really stand.
// Cost: negligible.
#pragma once

#include "core/types/estimator_decisions.hpp"
#include "core/types/speed_error.hpp"

namespace fail_aware {

class FirstMotionWatch {
 public:
  /// For a new drive.
  void reset() { *this = FirstMotionWatch(); }

  /// A sweep that was measured, or the first, which defines the start pose.
  void addMeasured() { ++measured_sweeps_; }

  /// The motion was lost: what was measured before counts no more.
  void forget() { measured_sweeps_ = guessed_sweeps_ = 0; }

  bool isKnown() const { return measured_sweeps_ >= 2; }

  /// Once a sweep, with the filter's speed along the vehicle and its error.
  bool mustSearchAgain(MotionStatus status, double speed_mps, const SpeedError& error);

  /// The search begins again.
  void searchAgain();

 private:
  static constexpr int kFirstRepetition = 20;

  int measured_sweeps_ = 0;                     ///< since the start, or since the motion was lost
  int guessed_sweeps_ = 0;                      ///< likewise, at a speed that was not observed yet; kSpeedKnown: it was
  int search_after_sweeps_ = kFirstRepetition;  ///< after so many guessed sweeps
};

}  // namespace fail_aware
