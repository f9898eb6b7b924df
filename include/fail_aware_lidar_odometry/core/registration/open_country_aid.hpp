// Open country: whether a sweep is in it, and the above-ground match (above_ground_matcher.hpp) as an aid to both ICPs there.
//
// Open country begins where planes hold little and next to nothing stands; it ends later: a sweep with a little more to
// hold on to does not end it, as its planes are sure of the heading, and often wrong. Both ICPs start at the matched
// pose, are less sure of what surfaces tell badly there, and take the match in. Shared with them: the points, the deskew.
// Cost: above_ground_matcher.hpp's.
#pragma once

#include <optional>

#include "fail_aware_lidar_odometry/core/registration/initial_guess.hpp"
#include "fail_aware_lidar_odometry/core/registration/local_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_scan.hpp"
#include "fail_aware_lidar_odometry/core/registration/above_ground_matcher.hpp"

namespace fail_aware {

class OpenCountryAid {
 public:
  struct Result {
    bool open_country = false;
    std::optional<StandingPose> pose;  ///< of the match
  };

  OpenCountryAid(const AboveGroundMatcher::Params& params, const IcpPointToPlane::Params& planes)
      : match_(params, planes) {}

  /// The scan, deskewed for the guess.
  Result find(const RegistrationScan& scan, const LocalMap& map, const InitialGuess& guess, double sigma_yaw_rad);

  /// What stands in the last sweep is worth keeping.
  bool nearlyOpen() const { return nearly_open_; }

  void reset();

 private:
  AboveGroundMatcher match_;
  int open_sweeps_left_ = 0;  ///< in which planes may tell more than where open country begins
  bool nearly_open_ = true;   ///< the last sweep's planes told little
};

/// Surfaces keep height, roll and pitch; of the rest they know little in open country, whatever their R says.
void addOpenCountry(const OpenCountryAid::Result& found, const AboveGroundMatcher::Params& params, const InitialGuess& guess,
                    Measurement& measurement);

}  // namespace fail_aware
