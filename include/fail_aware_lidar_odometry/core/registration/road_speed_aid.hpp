// The speed in the road's relief (road_profile_odometry.hpp) as an aid to the point-to-plane measurement, where the filter coasts.
//
// Input: every sweep, as it was deskewed for the prediction. The first speed may tell that the sweeps in the map were
// placed at a wrong one. Shared with the measurement that it is added to: the points and the predicted deskew.
// Cost: a few ms, only while the filter coasts.
#pragma once

#include <bitset>
#include <optional>

#include "fail_aware_lidar_odometry/core/registration/estimate_track.hpp"
#include "fail_aware_lidar_odometry/core/registration/initial_guess.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_scan.hpp"
#include "fail_aware_lidar_odometry/core/registration/road_profile_odometry.hpp"

namespace fail_aware {

class RoadSpeedAid {
 public:
  struct Result {
    std::optional<RoadProfileOdometry::Speed> speed;
    bool map_is_wrong = false;  ///< its sweeps were placed beside each other: what it gives now is false
  };

  explicit RoadSpeedAid(const RoadProfileOdometry::Params& params) : odometry_(params) {}

  /// `sweep`: the scan's, not thinned. track: the estimates before it.
  Result find(const CorrectedSweep& sweep, const RegistrationScan& scan, const SweepPrediction& prediction,
              const EstimateTrack& track);

  /// The estimated heading of the sweep that was looked at last.
  void setYaw(double yaw_rad) { odometry_.setYaw(yaw_rad); }

  /// Forgets the sweeps: in another odom, or where the stamps are wrong, which it goes by.
  void clear() { odometry_.clear(); }

 private:
  RoadProfileOdometry odometry_;
  std::bitset<8> eighths_seen_;  ///< of the azimuth, in the last sweep
};

/// The way driven since the last estimate, along the vehicle's heading half-way to where registration starts.
void addRoadSpeed(const RoadProfileOdometry::Speed& speed, const InitialGuess& guess, const Pose& T_odom_cog_initial_guess,
                  Measurement& measurement);

}  // namespace fail_aware
