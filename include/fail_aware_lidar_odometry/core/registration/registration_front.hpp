// What the two ICPs share in a sweep: the thinned clouds, the reference map, the search for the first motion.
//
// Offline one front serves both ICPs; on the vehicle each ICP nodelet holds its own and, since everything here is a
// function of the corrected sweeps and the filter's states alone, both hold the same.
// When odom was moved under the vehicle (FilterState::odom_epoch) the reference starts anew from the next placed sweep.
// Where the filter coasts (filter/coasting.hpp), the front looks for the speed in the road's relief (road_relief.hpp)
// and adds what it finds to the point-to-plane measurement.
// After a gap the start pose is searched for in the map (relocalization.hpp), and where the clouds tell that the
// stamps are wrong it is that of another interval (interval_check.hpp); what could not be registered does not
// join it (FilterState::placed). When nothing has fitted for a while the filter begins another reference
// (FilterState::reference_epoch), from one sweep at a prediction.
// Once the motion is known, the sweep is corrected anew for the turn that is found in it (turn_search.hpp) before it is
// measured, and keeps that turn when it joins the map. Of sweeps that come compensated (sensor.timing.source none) that
// turn is all that is taken out: for which motion they were moved is not known. The ranges of the ICPs' clouds are
// corrected for what the beams were found to be off by (beam_ranges.hpp).
// A sweep is prepare()d, measured, then place()d at the filter's estimate. Between sweeps 0 and 1 the speed is found
// (motion_initialization.hpp) and sweep 0 is corrected for it afterwards; a second later, another sweep is sweep 0.
#pragma once

#include <bitset>
#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/registration/estimate_track.hpp"
#include "fail_aware_lidar_odometry/core/registration/interval_check.hpp"
#include "fail_aware_lidar_odometry/core/registration/local_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_parameters.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_prediction.hpp"

namespace fail_aware {

class RegistrationFront {
 public:
  /// timing: SensorParameters::correctedTiming(); says whether sweeps come compensated, and how the head turns.
  explicit RegistrationFront(const RegistrationParameters& params, const SweepTimingParams& timing);

  /// Thins the sweep. False: too few points in range, the sweep cannot be registered (nor will it be placed).
  bool prepare(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);

  const RegistrationCloud& cloud() const { return cloud_; }
  const VoxelMap& map() const { return map_.map(); }
  /// Where registration starts: the prediction, or, while no motion is known, what the search found.
  const Pose& T_odom_cog_start() const { return T_odom_cog_start_; }

  /// The prepared sweep against the reference, from the start pose; kTooFewPoints if prepare() said false,
  /// kNotConverged as long as the way is lost after a gap.
  Measurement align(const MultiplexIcp& icp, std::vector<SeedTrack>* tracks = nullptr) const;
  Measurement align(const NormalFilteredIcp& icp, double sigma_yaw_rad) const;

  /// Takes the prepared sweep into the reference, at the estimate, corrected for the motion that was estimated (but for
  /// one that came compensated).
  void place(const FilterState& state);

  /// In place of place(): the estimate of a sweep that was not prepared.
  void skip(const FilterState& state);

  void reset();

 private:
  void initializeMotion(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);
  void recorrectFor(const Vector6d& twist_cog, double middle_s = 0.0);
  void findTurn(double sigma_yaw_rad);
  void matchStanding(double sigma_yaw_rad);
  void addStanding(Measurement& measurement) const;
  void enterOdom(int epoch);
  void relocalize();
  void checkInterval(const SweepPrediction& prediction);
  void updateRelief(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);
  void doubtStandstill(Measurement& measurement) const;
  void addReliefSpeed(Measurement& measurement) const;
  void addSearchedMotion(Measurement& measurement) const;

  RegistrationCloudBuilder builder_;
  LocalMap map_;
  EstimateTrack track_;
  Relocalization relocalization_;
  MotionInitialization initialization_;
  RoadRelief relief_;
  IntervalCheck interval_check_;
  TurnSearch turn_search_;
  BeamRanges beam_ranges_;
  StandingMatch standing_;
  bool refine_correction_;
  RegistrationCloud cloud_;
  bool lost_ = false;  ///< after a gap, not found again yet
  Pose T_odom_cog_start_ = Pose::Identity();
  /// Of T_odom_cog_start_: the prediction's, but as sure of the position as the search.
  Matrix6d start_covariance_ = Matrix6d::Identity();
  /// The motion that cloud_ is corrected for (compensated: the predicted one), m/s and rad/s.
  Vector6d corrected_twist_cog_ = Vector6d::Zero();
  bool prepared_ = false;
  bool turn_found_ = false;                        ///< in the prepared sweep: it is corrected for that turn
  std::optional<RoadRelief::Speed> relief_speed_;  ///< of the prepared sweep
  std::optional<StandingPose> standing_pose_;      ///< likewise
  bool open_country_ = false;                      ///< of the prepared sweep: see standing_match.hpp
  int open_sweeps_left_ = 0;                       ///< in which planes may tell more than where open country begins
  bool nearly_open_ = true;                        ///< the last one's planes told little: what stands in it is kept
  double searched_sigma_m_ = 0.0;                  ///< of the start pose, if the search gave it; else 0
  Eigen::Vector3d lidar_in_cog_ = Eigen::Vector3d::Zero();
  Pose T_odom_cog_previous_ = Pose::Identity();
  double dt_s_ = 0.0;
  std::bitset<8> eighths_seen_;    ///< of the azimuth, in the last sweep
  bool interval_doubted_ = false;  ///< the prepared sweep's start pose is that of another interval than the stamps'
};

}  // namespace fail_aware
