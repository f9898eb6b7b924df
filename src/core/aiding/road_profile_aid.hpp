// The source road_profile: the distance driven since the last estimate, by the road's profile
// (road_profile_odometry.hpp), during dead reckoning. A partial measurement: it observes one direction. Not in the
// paper.
//
// Input: every sweep, deskewed for the prediction. Once the filter knows the speed (registration observed it, or it
// agreed with the road's), the sweep's place among the last sweeps gives the distance; where no place is found, the
// road's speed, which must stay near the filter's: on a field what travels with the sensor fits at standstill, and the
// search drifts there. Before, the speed alone gives it. The first speed may show that the sweeps in the map were
// inserted at a wrong speed. Later the map is not wrong.
// It shares the points and the predicted deskew with every other source, but not the map: heights of the last sweeps
// are compared, by the poses of the estimates.
// Cost: a few ms, only during dead reckoning.
#pragma once

#include <bitset>
#include <optional>

#include "core/aiding/road_profile_odometry.hpp"
#include "core/initial_guess/estimate_track.hpp"
#include "core/initial_guess/initial_guess.hpp"
#include "core/registration/registration_scan.hpp"

namespace fail_aware {

class RoadProfileAid {
 public:
  struct Distance {
    double distance_m = 0.0;  ///< since the last estimate, along the vehicle's mean heading
    double sigma_m = 0.0;
  };

  struct Result {
    std::optional<Distance> distance;
    bool map_is_wrong = false;  ///< its sweeps were inserted at wrong relative poses: its measurements are wrong
  };

  explicit RoadProfileAid(const RoadProfileOdometry::Params& params) : odometry_(params) {}

  /// `sweep`: the full sweep of the scan. track: the estimates before it.
  Result find(const CorrectedSweep& sweep, const RegistrationScan& scan, const SweepPrediction& prediction,
              const EstimateTrack& track);

  /// The estimated pose of the last sweep. Where it is far from the place on the road, something else moved the vehicle
  /// (a registration that holds again, a pose from elsewhere), and the earlier sweeps move with it: else the next
  /// sweeps' places would take the correction back.
  void setPose(const Pose& T_odom_cog);

  /// Forgets the sweeps: after a reset of odom, or where the stamps, which it relies on, are wrong.
  void clear() {
    odometry_.clear();
    T_odom_cog_road_.reset();
    has_agreed_ = false;
  }

  /// For a new drive.
  void reset() {
    clear();
    eighths_seen_.reset();
  }

 private:
  RoadProfileOdometry odometry_;
  std::optional<Pose> T_odom_cog_road_;  ///< where the last sweep is on the road
  bool has_agreed_ = false;              ///< the road's speed with the filter's, since the motion is known
  std::bitset<8> eighths_seen_;          ///< eighths of the azimuth with points in the last sweep
};

/// Observes the vehicle's mean heading between the last estimate and the start pose; the rest is that of the start
/// pose, with kUnobservedVariance. kNoReference without a distance.
Measurement roadProfileMeasurement(const std::optional<RoadProfileAid::Distance>& distance,
                                   const Pose& T_odom_cog_previous, const Pose& T_odom_cog_start);

}  // namespace fail_aware
