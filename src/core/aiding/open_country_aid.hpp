// Detects open country and matches the points above the ground there (above_ground_matcher.hpp): the source
// above_ground, a partial measurement of horizontal position and heading. Not in the paper.
//
// Open country begins where planes hold little of any horizontal direction and almost nothing stands. It ends with a
// delay: in a sweep with a little more structure the planes determine the heading precisely and often wrongly. In open
// country both ICPs start at the matched pose, and the covariance of what surfaces observe badly is inflated.
// The match shares the points and the deskew with every other source and the initial guess with the ICPs, but not their
// map: it is matched with one kept sweep.
// Cost: that of above_ground_matcher.hpp.
#pragma once

#include <optional>

#include "core/aiding/above_ground_matcher.hpp"
#include "core/initial_guess/initial_guess.hpp"
#include "core/map/local_map.hpp"
#include "core/registration/registration_scan.hpp"

namespace fail_aware {

class OpenCountryAid {
 public:
  struct Result {
    bool open_country = false;
    std::optional<AboveGroundPose> pose;  ///< from the above-ground match
  };

  OpenCountryAid(const AboveGroundMatcher::Params& params, const IcpPointToPlane::Params& planes)
      : match_(params, planes) {}

  /// The scan must be deskewed for the guess.
  Result find(const RegistrationScan& scan, const LocalMap& map, const InitialGuess& guess, double sigma_yaw_rad);

  /// The above-ground points of the last sweep are worth keeping.
  bool nearlyOpen() const { return nearly_open_; }

  void reset();

 private:
  AboveGroundMatcher match_;
  int open_sweeps_left_ = 0;  ///< in which planes may hold more information than at the start of open country
  bool nearly_open_ = true;   ///< the last sweep's planes held little information
};

/// In open country surfaces determine height, roll and pitch; the rest gets a larger covariance, whatever R says.
void inflateInOpenCountry(const AboveGroundMatcher::Params& params, const InitialGuess& guess,
                          Measurement& measurement);

/// Observes x, y and yaw; the rest has kUnobservedVariance.
Measurement aboveGroundMeasurement(const AboveGroundPose& pose);

}  // namespace fail_aware
