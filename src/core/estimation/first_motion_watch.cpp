#include "core/estimation/first_motion_watch.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr int kSpeedKnown = -1;
constexpr double kGuessed_mps = 5.0;     // sigma of the first speed: 2 m/s at most if a search found it, else 15
constexpr double kMeasured_mps = 3.0;    // with a smaller sigma the speed is measured, though not precisely
constexpr double kStands_mps = 0.5;      // an observed standstill may end unseen: the search may begin again
constexpr int kManyGuessed = 10;         // sweeps: a guess over fewer is hardly in the map
constexpr int kLatestRepetition = 1000;  // sweeps between two searches

}  // namespace

bool FirstMotionWatch::mustSearchAgain(MotionStatus status, double speed_mps, const SpeedError& error) {
  if (guessed_sweeps_ == kSpeedKnown || status == MotionStatus::kUnknown) return false;
  const bool slow = std::abs(speed_mps) < kGuessed_mps;
  const double variance_m2_s2 = error.variance_m2_s2;
  if (status == MotionStatus::kDeadReckoning) {
    const bool found = guessed_sweeps_ == 0 && variance_m2_s2 < kGuessed_mps * kGuessed_mps;
    if (found && !slow) {  // one that stood may have driven off
      guessed_sweeps_ = kSpeedKnown;
    } else if (variance_m2_s2 >= kMeasured_mps * kMeasured_mps) {
      ++guessed_sweeps_;
    }
    return guessed_sweeps_ >= search_after_sweeps_ && slow;
  }
  const bool guessed_long = guessed_sweeps_ >= kManyGuessed;
  const bool stands = std::abs(speed_mps) < kStands_mps;
  guessed_sweeps_ = stands && !guessed_long ? 0 : kSpeedKnown;
  return guessed_long;
}

void FirstMotionWatch::searchAgain() {
  measured_sweeps_ = 0;
  search_after_sweeps_ = std::min(2 * search_after_sweeps_, kLatestRepetition);
  guessed_sweeps_ = 1;  // it was believed, so its variance is too small to tell whether the search finds another
}

}  // namespace fail_aware
