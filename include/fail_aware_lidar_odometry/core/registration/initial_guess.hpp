// Where registration of a sweep starts: the prediction, or a better guess that is found in the sweep and the map before
// anything is measured. It is resolved once a sweep and is constant then; whoever registers starts there.
//
// In this order, each a function of scan, map and guess that may return a better guess:
// - while no motion is known: a search for the first motion (motion_initialization.hpp);
// - after a gap: a search for the place in the map (relocalization.hpp);
// - where the clouds tell that the stamps are wrong: the place by another interval (clock_jump_detector.hpp);
// - unless tracking is lost: the turn that the deskew missed (deskew_refinement.hpp).
// Frames: poses of the centre of gravity in odom. Failure: the prediction, or `lost`.
// Cost: a turn search a sweep (a point-to-plane registration), the others where they are needed (up to 200 ms).
#pragma once

#include <optional>

#include "fail_aware_lidar_odometry/core/registration/estimate_track.hpp"
#include "fail_aware_lidar_odometry/core/registration/clock_jump_detector.hpp"
#include "fail_aware_lidar_odometry/core/registration/local_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/motion_initialization.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_scan.hpp"
#include "fail_aware_lidar_odometry/core/registration/relocalization.hpp"
#include "fail_aware_lidar_odometry/core/registration/deskew_refinement.hpp"

namespace fail_aware {

struct InitialGuess {
  /// What of twist_cog was found in the sweep.
  enum class Found { kNothing, kFirstMotion, kTurn };

  Pose T_odom_cog = Pose::Identity();
  /// Of T_odom_cog: the prediction's, but as sure of the position as a search for the first motion.
  Matrix6d covariance = Matrix6d::Identity();
  Vector6d twist_cog = Vector6d::Zero();        ///< m/s and rad/s
  Found twist_found = Found::kNothing;          ///< otherwise twist_cog is the prediction's
  double searched_sigma_m = 0.0;                ///< of the position, if the search for the first motion gave it; else 0
  bool clock_jump_suspected = false;                ///< the pose is that of another interval than the stamps'
  bool lost = false;                            ///< tracking is lost after a gap
  Pose T_odom_cog_previous = Pose::Identity();  ///< the last estimate,
  double dt_s = 0.0;                            ///< so long ago; 0: there is none
};

/// As the filter predicts, and as the scan is deskewed.
InitialGuess predictedGuess(const RegistrationScan& scan, const SweepPrediction& prediction);

class InitialGuessResolver {
 public:
  explicit InitialGuessResolver(const RegistrationParameters& params);

  /// `sweep`: the scan's, not thinned. track: the estimates before it.
  InitialGuess resolve(const CorrectedSweep& sweep, const RegistrationScan& scan, const LocalMap& map,
                       const EstimateTrack& track, const SweepPrediction& prediction);

  void reset();

 private:
  using Better = std::optional<InitialGuess>;
  Better findFirstMotion(const CorrectedSweep& sweep, const RegistrationScan& scan, const LocalMap& map, double time_s,
                         const InitialGuess& guess);
  Better relocalize(const RegistrationScan& scan, const LocalMap& map, const EstimateTrack& track,
                    const InitialGuess& guess) const;
  Better detectClockJump(const RegistrationScan& scan, const LocalMap& map, const EstimateTrack& track,
                       const SweepPrediction& prediction, const InitialGuess& guess);
  Better refineDeskew(const RegistrationScan& scan, const LocalMap& map, double sigma_yaw_rad,
                  const InitialGuess& guess) const;

  MotionInitialization first_motion_;
  Relocalization relocalization_;
  ClockJumpDetector clock_jump_detector_;
  DeskewRefinement deskew_refinement_;
};

}  // namespace fail_aware
