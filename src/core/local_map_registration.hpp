// Coordinates what the sources that use the local map share in a sweep: the scan, the map, the initial guess.
//
//   prepare: scan -> road speed -> initial guess (initial_guess.hpp) -> redeskew -> open country
//   align:   one ICP from the start pose
//   roadProfile, aboveGround: the partial measurements (aiding/), where there are any
//   place:   redeskew for the estimated motion -> insert into the map (local_map.hpp)
//
// Offline one instance serves both ICPs. On the vehicle each ICP nodelet has its own instance; both instances hold the
// same data because everything here depends only on the corrected sweeps and the filter's states. For each sweep call
// prepare(), measure, then place() with the filter's estimate. The inserted sweep keeps the turn rate that it was
// measured with; a compensated sweep (sensor.timing.source none) is deskewed for that turn rate only. A sweep that
// could not be registered is not inserted (FilterState::map_update). While no motion is known, sweep 0 is deskewed
// again when the search between sweeps 0 and 1 finds the motion; a second later, another sweep becomes sweep 0.
// Frames: points of the centre of gravity; poses in odom.
// Failure: the status of the Measurement. Cost: that of the stages.
#pragma once

#include <vector>

#include "core/aiding/open_country_aid.hpp"
#include "core/aiding/road_profile_aid.hpp"
#include "core/initial_guess/estimate_track.hpp"
#include "core/initial_guess/initial_guess.hpp"
#include "core/map/local_map.hpp"
#include "core/registration/registration_scan.hpp"
#include "core/registration_parameters.hpp"
#include "core/types/corrected_sweep.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/measurement.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

class LocalMapRegistration {
 public:
  /// timing: SensorParameters::correctedTiming(); says whether sweeps come compensated, and how the head rotates.
  explicit LocalMapRegistration(const RegistrationParameters& params, const SweepTimingParams& timing);

  /// Thins the sweep. False: too few points in range; the sweep cannot be registered and will not be inserted.
  bool prepare(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);

  const RegistrationCloud& cloud() const { return scan_.cloud; }
  const VoxelMap& map() const { return map_.map(); }
  /// Where both ICPs start: the initial guess or, in open country, the above-ground match.
  const Pose& T_odom_cog_start() const {
    return open_country_.pose ? open_country_.pose->T_odom_cog : guess_.T_odom_cog;
  }

  /// Registers the prepared sweep against the map from the start pose. kTooFewPoints if prepare() returned false;
  /// kNotConverged while tracking is lost after a gap.
  Measurement align(const IcpPointToPoint& icp, std::vector<SeedTrack>* tracks = nullptr) const;
  Measurement align(const IcpPointToPlane& icp, double sigma_yaw_rad) const;

  /// The partial measurements of the prepared sweep; kNoReference: there is none.
  Measurement roadProfile() const;
  Measurement aboveGround() const;

  /// Inserts the prepared sweep into the map at the estimate, deskewed for the estimated motion (unless it came
  /// compensated).
  void place(const FilterState& state);

  /// Call in place of place(), with the estimate of a sweep that was not prepared.
  void skip(const FilterState& state);

  void reset();

 private:
  void enterOdom(int odom_reset_count);
  void resolveGuess(const CorrectedSweep& sweep, const SweepPrediction& prediction);
  void applyGuess();
  void findOpenCountry(const SweepPrediction& prediction);
  void refine(const EstimateTrack::Increment& increment);
  MeasurementStatus readiness() const;
  /// Adds the position from the search for the first motion. Inflates the covariance while the speed is unknown, and in
  /// open country.
  void applyGuessUncertainty(Measurement& measurement) const;

  RegistrationParameters params_;
  RegistrationScanBuilder builder_;
  LocalMap map_;
  EstimateTrack track_;
  InitialGuessResolver resolver_;
  RoadProfileAid road_profile_aid_;
  OpenCountryAid open_country_aid_;
  // Of the prepared sweep:
  bool prepared_ = false;
  RegistrationScan scan_;
  InitialGuess guess_;
  RoadProfileAid::Result road_profile_;
  OpenCountryAid::Result open_country_;
};

}  // namespace fail_aware
