#include "core/initial_guess/initial_guess.hpp"

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

// with this many agreeing cells the search for the first motion is as precise as its last step
constexpr double kSurePlaces = 10.0;

}  // namespace

InitialGuess predictedGuess(const RegistrationScan& scan, const SweepPrediction& prediction) {
  InitialGuess guess;
  guess.T_odom_cog = prediction.T_odom_cog;
  guess.covariance = prediction.covariance;
  guess.twist_cog = scan.twist_cog;
  guess.T_odom_cog_previous = prediction.T_odom_cog_previous;
  guess.dt_s = prediction.dt_s;
  return guess;
}

InitialGuess InitialGuessResolver::resolve(const CorrectedSweep& sweep, const RegistrationScan& scan,
                                           const LocalMap& map, const EstimateTrack& track,
                                           const SweepPrediction& prediction) {
  InitialGuess guess = predictedGuess(scan, prediction);
  const auto take = [&guess](const Better& better) { guess = better.value_or(guess); };
  if (!prediction.motionKnown()) {
    take(findFirstMotion(sweep, scan, map, prediction.time_s(), guess));
    return guess;
  }
  take(followDriveOff(sweep, scan, map, prediction.time_s(), guess));
  take(relocalize(scan, map, track, guess));
  take(detectClockJump(scan, map, track, prediction, guess));
  take(refineDeskew(scan, map, prediction.sigma_yaw_rad, guess));
  return guess;
}

InitialGuessResolver::Better InitialGuessResolver::findFirstMotion(const CorrectedSweep& sweep,
                                                                   const RegistrationScan& scan, const LocalMap& map,
                                                                   double time_s, const InitialGuess& guess) {
  if (map.empty()) {
    first_motion_.setFirst(sweep, scan.T_cog_lidar);
    drive_off_.clear();
    first_time_s_ = time_s;
    return std::nullopt;
  }
  const double since_first_s = secondsBetween(map.first().time_s, time_s);
  const std::optional<MotionInitialization::Found> motion = first_motion_.find(sweep, scan.T_cog_lidar, since_first_s);
  if (!motion) return std::nullopt;
  InitialGuess found = guess;
  found.twist_cog = motion->twist_cog;
  found.twist_found = InitialGuess::Found::kFirstMotion;
  // from the first sweep: the last estimate may be a prediction at standstill
  found.T_odom_cog = map.first().T_odom_cog * expSe3(motion->twist_cog * since_first_s);
  const double step_m = first_motion_.params().step_mps * since_first_s;
  found.searched_sigma_m = (motion->places_met >= kSurePlaces ? MotionInitialization::kFineStep : 1.0) * step_m;
  found.covariance.topRows<2>().setZero();
  found.covariance.leftCols<2>().setZero();
  found.covariance.topLeftCorner<2, 2>().diagonal().setConstant(step_m * step_m);
  return found;
}

InitialGuessResolver::Better InitialGuessResolver::followDriveOff(const CorrectedSweep& sweep,
                                                                  const RegistrationScan& scan, const LocalMap& map,
                                                                  double time_s, const InitialGuess& guess) {
  if (first_motion_.params().standstill_m == 0.0) return std::nullopt;
  if (map.empty() && drive_off_.stands()) {  // after set_pose: this sweep becomes the first one
    first_motion_.setFirst(sweep, scan.T_cog_lidar);
    first_time_s_ = time_s;
  }
  if (map.empty() || !searchesFrom(map.first())) {
    drive_off_.clear();
    return std::nullopt;
  }
  const Vector6d step_m_rad = logSe3(map.first().T_odom_cog.inverse() * guess.T_odom_cog);
  InitialGuess found = guess;
  found.start = drive_off_.add(
      {secondsBetween(map.first().time_s, time_s), guess.dt_s, step_m_rad[0]},
      [&](double ratio) { return first_motion_.findDistance(sweep, scan.T_cog_lidar, step_m_rad[5], ratio); });
  if (!found.start) return std::nullopt;
  if (found.start->distance_m) {
    const double ahead_m = *found.start->distance_m - step_m_rad[0];
    found.T_odom_cog.translation() += ahead_m * guess.T_odom_cog.linear().col(0);
  }
  return found;
}

// Without relocalization the measurements would converge to a nearby minimum; a few sweeps later they may.
InitialGuessResolver::Better InitialGuessResolver::relocalize(const RegistrationScan& scan, const LocalMap& map,
                                                              const EstimateTrack& track,
                                                              const InitialGuess& guess) const {
  const bool after_gap = !track.measured() || guess.dt_s > kLongInterval_s;
  if (!after_gap || map.empty() || !relocalization_.isNeeded(guess.covariance)) return std::nullopt;
  const LocalMap::Sweep& newest = map.newest();
  const Relocalization::Gap gap{secondsBetween(newest.time_s, scan.cloud.stamp_s),
                                (guess.T_odom_cog.translation() - newest.T_odom_cog.translation()).norm()};
  const std::optional<Pose> T_odom_cog =
      relocalization_.find(scan.cloud, map.map(), guess.T_odom_cog, guess.covariance, gap);
  InitialGuess found = guess;
  found.T_odom_cog = T_odom_cog.value_or(guess.T_odom_cog);
  found.start.reset();
  found.lost = !T_odom_cog;
  return found;
}

InitialGuessResolver::Better InitialGuessResolver::detectClockJump(const RegistrationScan& scan, const LocalMap& map,
                                                                   const EstimateTrack& track,
                                                                   const SweepPrediction& prediction,
                                                                   const InitialGuess& guess) {
  if (map.empty() || track.tooManyUnplaced()) return std::nullopt;
  ClockJumpDetector::Interval interval;
  interval.stamps = {prediction.dt_s, prediction.set_back_s};
  interval.unplaced = track.unplaced();
  interval.T_odom_cog_placed = track.T_odom_cog_placed();
  interval.twist_cog = track.placedTwist().value_or(guess.twist_cog);
  interval.T_odom_cog_predicted = prediction.T_odom_cog;
  if (!guess.lost) interval.T_odom_cog_by_the_stamps = guess.T_odom_cog;
  const std::optional<Pose> T_odom_cog = clock_jump_detector_.findOther(
      interval, [&](const Pose& T) { return relocalization_.fit(scan.cloud, map.map(), T, guess.covariance); });
  if (!T_odom_cog) return std::nullopt;
  InitialGuess found = guess;
  found.T_odom_cog = *T_odom_cog;
  found.start.reset();
  found.lost = false;
  found.clock_jump_suspected = true;
  return found;
}

InitialGuessResolver::Better InitialGuessResolver::refineDeskew(const RegistrationScan& scan, const LocalMap& map,
                                                                double sigma_yaw_rad, const InitialGuess& guess) const {
  if (guess.lost) return std::nullopt;
  const std::optional<Eigen::Vector3d> rate_rad_s =
      deskew_refinement_.find(scan.cloud.plane_points_cog, scan.cloud.plane_times_s, scan.cloud.middle_s, map.map(),
                              guess.T_odom_cog, sigma_yaw_rad);
  if (!rate_rad_s) return std::nullopt;
  InitialGuess found = guess;
  found.twist_cog.tail<3>() += *rate_rad_s;
  found.twist_found = InitialGuess::Found::kTurn;
  return found;
}

void InitialGuessResolver::reset() {
  first_motion_.reset();
  first_time_s_.reset();
  drive_off_.clear();
  clock_jump_detector_.reset();
}

}  // namespace fail_aware
