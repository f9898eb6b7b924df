// The source road_profile: the distance driven since the last estimate, by the speed from the road profile
// (road_profile_odometry.hpp), during dead reckoning. A partial measurement: it observes one direction. Not in the
// paper.
//
// Input: every sweep, deskewed for the prediction. The first speed may show that the sweeps in the map were inserted at
// a wrong speed. Once the filter knows the speed (registration observed it, or it agreed with the road's), the road's
// must stay near it: on a field what travels with the sensor fits at standstill, and the search drifts there. From then
// on the map is not wrong either.
// It shares the points and the predicted deskew with every other source, but not the map: heights of the last sweeps
// are compared, by the headings of the estimates.
// Cost: a few ms, only during dead reckoning.
#pragma once

#include <bitset>
#include <optional>

#include "core/aiding/road_profile_odometry.hpp"
#include "core/initial_guess/estimate_track.hpp"
#include "core/initial_guess/initial_guess.hpp"
#include "core/registration/registration_scan.hpp"

namespace fail_aware {

class RoadSpeedAid {
 public:
  struct Result {
    std::optional<RoadProfileOdometry::Speed> speed;
    bool map_is_wrong = false;  ///< its sweeps were inserted at wrong relative poses: its measurements are wrong
  };

  explicit RoadSpeedAid(const RoadProfileOdometry::Params& params) : odometry_(params) {}

  /// `sweep`: the full sweep of the scan. track: the estimates before it.
  Result find(const CorrectedSweep& sweep, const RegistrationScan& scan, const SweepPrediction& prediction,
              const EstimateTrack& track);

  /// The estimated heading of the last sweep.
  void setYaw(double yaw_rad) { odometry_.setYaw(yaw_rad); }

  /// Forgets the sweeps: after a reset of odom, or where the stamps, which it relies on, are wrong.
  void clear() {
    odometry_.clear();
    has_agreed_ = false;
  }

  /// For a new drive.
  void reset() {
    clear();
    eighths_seen_.reset();
  }

 private:
  RoadProfileOdometry odometry_;
  bool has_agreed_ = false;      ///< the road's speed with the filter's, since the motion is known
  std::bitset<8> eighths_seen_;  ///< eighths of the azimuth with points in the last sweep
};

/// Observes the vehicle's mean heading between the last estimate and the initial guess; the rest is that of the guess,
/// with kUnobservedVariance. kNoReference without a last estimate.
Measurement roadProfileMeasurement(const RoadProfileOdometry::Speed& speed, const InitialGuess& guess,
                                   const Pose& T_odom_cog_start);

}  // namespace fail_aware
