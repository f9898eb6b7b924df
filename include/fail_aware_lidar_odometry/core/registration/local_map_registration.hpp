// What the two ICPs share in a sweep: the scan, the local map, the initial guess, the aids. Their coordinator.
//
//   prepare: scan -> road speed -> initial guess (initial_guess.hpp) -> redeskew -> open country
//   align:   an ICP from the start pose on, with what else is known taken in
//   place:   redeskew for the estimated motion -> insert into the map (local_map.hpp)
//
// Offline one front serves both ICPs; on the vehicle each ICP nodelet holds its own and, since everything here is a
// function of the corrected sweeps and the filter's states alone, both hold the same.
// A sweep is prepare()d, measured, then place()d at the filter's estimate. It keeps the turn that it was measured with;
// of sweeps that come compensated (sensor.timing.source none) that turn is all that is taken out. What could not be
// registered does not join the map (FilterState::map_update).
// While no motion is known sweep 0 is deskewed once more when the search between sweeps 0 and 1 finds it; a second later,
// another sweep is sweep 0.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/registration/estimate_track.hpp"
#include "fail_aware_lidar_odometry/core/registration/initial_guess.hpp"
#include "fail_aware_lidar_odometry/core/registration/local_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/open_country_aid.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_parameters.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_scan.hpp"
#include "fail_aware_lidar_odometry/core/registration/road_speed_aid.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_prediction.hpp"

namespace fail_aware {

class LocalMapRegistration {
 public:
  /// timing: SensorParameters::correctedTiming(); says whether sweeps come compensated, and how the head turns.
  explicit LocalMapRegistration(const RegistrationParameters& params, const SweepTimingParams& timing);

  /// Thins the sweep. False: too few points in range, the sweep cannot be registered (nor will it be placed).
  bool prepare(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);

  const RegistrationCloud& cloud() const { return scan_.cloud; }
  const VoxelMap& map() const { return map_.map(); }
  /// Where registration starts: the initial guess, or, in open country, the above-ground match.
  const Pose& T_odom_cog_initial_guess() const {
    return open_country_.pose ? open_country_.pose->T_odom_cog : guess_.T_odom_cog;
  }

  /// The prepared sweep against the map, from the start pose; kTooFewPoints if prepare() said false, kNotConverged as
  /// long as tracking is lost after a gap.
  Measurement align(const IcpPointToPoint& icp, std::vector<SeedTrack>* tracks = nullptr) const;
  Measurement align(const IcpPointToPlane& icp, double sigma_yaw_rad) const;

  /// Takes the prepared sweep into the map, at the estimate, deskewed for the motion that was estimated (but for one
  /// that came compensated).
  void place(const FilterState& state);

  /// In place of place(): the estimate of a sweep that was not prepared.
  void skip(const FilterState& state);

  void reset();

 private:
  void enterOdom(int epoch);
  void findRoadSpeed(const CorrectedSweep& sweep, const SweepPrediction& prediction);
  void resolveGuess(const CorrectedSweep& sweep, const SweepPrediction& prediction);
  void applyGuess();
  void findOpenCountry(const SweepPrediction& prediction);
  void refine(const EstimateTrack::Increment& increment);
  MeasurementStatus readiness() const;
  void addFirstMotion(Measurement& measurement) const;

  RegistrationParameters params_;
  RegistrationScanBuilder builder_;
  LocalMap map_;
  EstimateTrack track_;
  InitialGuessResolver resolver_;
  RoadSpeedAid road_speed_aid_;
  OpenCountryAid open_country_aid_;
  // Of the prepared sweep:
  bool prepared_ = false;
  RegistrationScan scan_;
  InitialGuess guess_;
  RoadSpeedAid::Result road_speed_;
  OpenCountryAid::Result open_country_;
};

}  // namespace fail_aware
