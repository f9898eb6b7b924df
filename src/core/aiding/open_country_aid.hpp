// Detects open country and adds the above-ground match (above_ground_matcher.hpp) to both ICPs there. Not in the paper.
//
// Open country begins where planes hold little information and almost nothing stands above the ground. It ends with a
// delay: in a sweep with a little more structure the planes determine the heading precisely and often wrongly. In open
// country both ICPs start at the matched pose, inflate the covariance of what surfaces observe badly, and add the
// match. The match and the ICPs share the points and the deskew.
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
    std::optional<StandingPose> pose;  ///< from the above-ground match
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

/// Surfaces determine height, roll and pitch; in open country the rest gets a larger covariance, whatever R says.
void addOpenCountry(const OpenCountryAid::Result& found, const AboveGroundMatcher::Params& params,
                    const InitialGuess& guess, Measurement& measurement);

}  // namespace fail_aware
