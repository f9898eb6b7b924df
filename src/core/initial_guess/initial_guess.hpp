// The initial guess of a sweep's registration: the prediction, or a better guess from the sweep and the map. The guess
// is resolved once per sweep, before any measurement. Both ICPs start from it, unless open country has a better pose
// (aiding/open_country_aid.hpp); the corners start from the prediction. Not in the paper.
//
// Each of these functions of scan, map and guess may return a better guess, in this order:
// - while no motion is known: search for the first motion (motion_initialization.hpp);
// - near the first sweep of a drive that began at standstill: its distance (drive_off.hpp);
// - after a gap: relocalization in the map (relocalization.hpp);
// - where the point clouds contradict the stamps: the pose by another interval (clock_jump_detector.hpp);
// - unless tracking is lost: deskew refinement (deskew_refinement.hpp).
// Frames: poses of the centre of gravity in odom.
// Failure: the prediction, or `lost`.
// Cost: one deskew refinement per sweep (a point-to-plane registration); the others only where needed (up to 200 ms;
// near the start of a drive that began at standstill 8 to 20 ms).
#pragma once

#include <optional>

#include "core/initial_guess/clock_jump_detector.hpp"
#include "core/initial_guess/deskew_refinement.hpp"
#include "core/initial_guess/drive_off.hpp"
#include "core/initial_guess/estimate_track.hpp"
#include "core/initial_guess/motion_initialization.hpp"
#include "core/initial_guess/relocalization.hpp"
#include "core/map/local_map.hpp"
#include "core/registration/registration_scan.hpp"

namespace fail_aware {

struct InitialGuess {
  /// The part of twist_cog that was found in the sweep.
  enum class Found { kNothing, kFirstMotion, kTurn };

  Pose T_odom_cog = Pose::Identity();
  /// Of T_odom_cog: the prediction's; with the position variance of the search if the first motion was found.
  Matrix6d covariance = Matrix6d::Identity();
  Vector6d twist_cog = Vector6d::Zero();  ///< m/s and rad/s
  Found twist_found = Found::kNothing;    ///< otherwise twist_cog is the prediction's
  double searched_sigma_m = 0.0;          ///< sigma of the position from the search for the first motion; 0: no search
  /// Near the first sweep of a drive that began at standstill; T_odom_cog has the distance, if one was found.
  std::optional<DriveOff::Place> start;
  bool clock_jump_suspected = false;            ///< the pose follows another interval than the stamps'
  bool lost = false;                            ///< tracking is lost after a gap
  Pose T_odom_cog_previous = Pose::Identity();  ///< the last estimate
  double dt_s = 0.0;                            ///< time since the last estimate; 0: there is none
};

/// The prediction, and the twist that the scan is deskewed for.
InitialGuess predictedGuess(const RegistrationScan& scan, const SweepPrediction& prediction);

class InitialGuessResolver {
 public:
  InitialGuessResolver(const MotionInitialization& first_motion, const Relocalization& relocalization,
                       const DeskewRefinement& deskew_refinement)
      : first_motion_(first_motion), relocalization_(relocalization), deskew_refinement_(deskew_refinement) {}

  /// `sweep`: the full sweep of the scan. track: the estimates before it.
  InitialGuess resolve(const CorrectedSweep& sweep, const RegistrationScan& scan, const LocalMap& map,
                       const EstimateTrack& track, const SweepPrediction& prediction);

  /// The search for the first motion begins at the map's first sweep.
  bool searchesFrom(const LocalMap::Sweep& first) const { return first_time_s_ == first.time_s; }

  /// A vehicle that stood at the first sweep is still near it, and not seen to stand.
  bool mayDriveOff() const { return drive_off_.isFollowing() && !drive_off_.stands(); }

  void reset();

 private:
  using Better = std::optional<InitialGuess>;
  Better findFirstMotion(const CorrectedSweep& sweep, const RegistrationScan& scan, const LocalMap& map, double time_s,
                         const InitialGuess& guess);
  Better followDriveOff(const CorrectedSweep& sweep, const RegistrationScan& scan, const LocalMap& map, double time_s,
                        const InitialGuess& guess);
  Better relocalize(const RegistrationScan& scan, const LocalMap& map, const EstimateTrack& track,
                    const InitialGuess& guess) const;
  Better detectClockJump(const RegistrationScan& scan, const LocalMap& map, const EstimateTrack& track,
                         const SweepPrediction& prediction, const InitialGuess& guess);
  Better refineDeskew(const RegistrationScan& scan, const LocalMap& map, double sigma_yaw_rad,
                      const InitialGuess& guess) const;

  MotionInitialization first_motion_;
  std::optional<double> first_time_s_;  ///< time of the sweep that first_motion_ holds
  DriveOff drive_off_;
  Relocalization relocalization_;
  ClockJumpDetector clock_jump_detector_;
  DeskewRefinement deskew_refinement_;
};

}  // namespace fail_aware
