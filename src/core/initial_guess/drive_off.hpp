// Follows a vehicle that stands when the drive begins and drives off (not in the paper).
//
// Where little is seen along the road (highways, open country, tunnels, few beams), registration goes on measuring a
// standstill after the vehicle has driven off: what single beams draw on the ground, on rails and walls lies at the
// same place in every sweep. So the search for the first motion goes on, with the first sweep of the drive, until the
// vehicle is some metres away:
// - The vehicle stands if nearly all that stands above the ground meets the first sweep. At a true standstill 0.92 or
//   more of the places do, after 0.1 m 0.2 to 0.9 of them, after 0.3 m less than 0.8.
// - It has driven off if the log likelihood of another distance stands out of all those that are not next to it, and
//   out of that of a standstill.
// - In between, for 0.2 to 0.7 s, and in tunnels, neither is the case. Then a standstill is not believed either: the
//   vehicle may have gone as far as one that drives off.
// It begins only at a standstill that 0.18 s confirm. By then at most 0.76 of the places meet at standstill if the
// vehicle is in motion in a tunnel, 0.61 amid vehicles that travel along (16 simulated starts in motion).
// The other figures are of 53 simulated drive-offs with 16 to 128 beams, in all scenes.
// Limits: if all that is above the ground drives off together with the vehicle, it is taken to stand. So is one that
// drives through a smooth tunnel, so first_motion.hpp asks for more before the first speed is believed. A vehicle that
// creeps by 0.1 to 0.2 m is lost.
// Failure: nullopt. Cost: about 8 ms a sweep while the vehicle stands, 20 ms while it drives off or stands within 7 m;
// 0 after that.
#pragma once

#include <functional>
#include <optional>

#include "core/initial_guess/first_sweep_matcher.hpp"

namespace fail_aware {

struct DistanceKernels {
  double coarse_m = 0.5;  ///< of the search, and of the last step, as in FirstSweepMatcher::match()
  double fine_m = 0.15;
};

/// The distance from the first sweep, -1 to 8 m along the arc of a vehicle that has turned by turned_rad: 0 if at least
/// standing_ratio of the places meets there. Returns nullopt if none stands out.
std::optional<double> findDrivenOff(const FirstSweepMatcher& matcher, const DistanceKernels& kernels, double turned_rad,
                                    double standing_ratio);

class DriveOff {
 public:
  struct Place {
    std::optional<double> distance_m;  ///< from the first sweep, along the arc; nullopt: nothing stood out
    /// Of the distance; without one, of what the vehicle may have gone since it was last found.
    double sigma_m = 0.0;
  };

  struct Sweep {
    double since_first_s = 0.0;
    double dt_s = 0.0;         ///< since the last sweep
    double predicted_m = 0.0;  ///< the distance from the first sweep, along the arc
  };

  /// Finds the distance; its argument: findDrivenOff()'s standing_ratio.
  using Search = std::function<std::optional<double>(double)>;

  /// Once a sweep. Returns nullopt if the vehicle did not stand at the first sweep, or has left it.
  std::optional<Place> add(const Sweep& sweep, const Search& search);

  /// The vehicle stood at the first sweep, has not left it, and is not lost.
  bool isFollowing() const { return state_ == State::kFollowing; }
  /// It stands, as far as can be told.
  bool stands() const { return isFollowing() && stands_; }

  void clear() { *this = DriveOff(); }

 private:
  /// kLost: the distances contradict each other, or none was found for long. No longer searched for, as a standstill amid
  /// vehicles that travel along seems to come back, too.
  enum class State { kIdle, kFollowing, kLost };

  State state_ = State::kIdle;
  bool stands_ = false;
  double found_after_s_ = 0.0;  ///< when the distance was found last: s since the first sweep
  double farthest_m_ = 0.0;     ///< the largest distance so far
};

}  // namespace fail_aware
