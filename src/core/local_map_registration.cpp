#include "core/local_map_registration.hpp"

#include <optional>

#include "core/initial_guess/first_motion.hpp"
#include "core/registration/look_ahead.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kMaxSearchTime_s = 1.0;  // since the first sweep; later the first sweep is out of sight

// Azimuth timing of compensated sweeps serves the deskew refinement only; without it no times are needed.
std::optional<SweepTimingParams> compensatedHead(const RegistrationParameters& params,
                                                 const SweepTimingParams& timing) {
  if (timing.source != "none" || !params.deskew_refinement.enabled) return std::nullopt;
  return timing;
}

}  // namespace

LocalMapRegistration::LocalMapRegistration(const RegistrationParameters& params, const SweepTimingParams& timing)
    : params_(params),
      builder_(RegistrationCloudBuilder(params.cloud, compensatedHead(params, timing)),
               {params.beam_bias, params.icp_point_to_plane}),
      map_(params.reference, params.above_ground.reference),
      resolver_({params.initialization, params.cloud.min_range_m}, {params.relocalization, params.icp_point_to_point},
                {params.deskew_refinement, params.icp_point_to_plane}),
      road_profile_aid_(params.road_profile),
      open_country_aid_(params.above_ground, params.icp_point_to_plane) {}

bool LocalMapRegistration::prepare(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                   const Pose& T_cog_lidar) {
  enterOdom(prediction.odom_reset_count);
  builder_.build(sweep, prediction, T_cog_lidar, scan_);
  road_profile_ = road_profile_aid_.find(sweep, scan_, prediction, track_);
  if (road_profile_.map_is_wrong && !resolver_.mayDriveOff()) map_.clearPoints();
  resolveGuess(sweep, prediction);
  applyGuess();
  findOpenCountry(prediction);
  prepared_ = scan_.usable;
  return prepared_;
}

void LocalMapRegistration::resolveGuess(const CorrectedSweep& sweep, const SweepPrediction& prediction) {
  guess_ = predictedGuess(scan_, prediction);
  if (!scan_.usable) return;
  // after a failed search for the first motion the next searches would fail too: this sweep becomes the first one
  const double since_first_s = secondsBetween(map_.first().time_s, prediction.time_s());
  const bool can_search = resolver_.searchesFrom(map_.first()) && since_first_s <= kMaxSearchTime_s;
  if (!prediction.motionKnown() && !can_search) map_.clearPoints();
  guess_ = resolver_.resolve(sweep, scan_, map_, track_, prediction);
}

void LocalMapRegistration::applyGuess() {
  const double middle_s = scan_.cloud.middle_s;
  if (guess_.twist_found == InitialGuess::Found::kTurn) scan_.redeskewTo(guess_.twist_cog, middle_s);
  if (guess_.twist_found == InitialGuess::Found::kFirstMotion) {
    if (!scan_.cloud.compensated) scan_.redeskewTo(guess_.twist_cog, 0.0);
    if (params_.refine_deskew) map_.redeskewFirstTo(guess_.twist_cog, middle_s);
  }
  if (guess_.clock_jump_suspected) {  // the road profile depends on the stamps
    road_profile_aid_.clear();
    road_profile_ = {};
  }
}

void LocalMapRegistration::findOpenCountry(const SweepPrediction& prediction) {
  open_country_ = {};
  if (!scan_.usable || !prediction.motionKnown() || guess_.lost) return;
  open_country_ = open_country_aid_.find(scan_, map_, guess_, prediction.sigma_yaw_rad);
}

Measurement LocalMapRegistration::align(const IcpPointToPoint& icp, std::vector<SeedTrack>* tracks) const {
  if (tracks != nullptr) tracks->clear();
  if (readiness() != MeasurementStatus::kOk) return Measurement{readiness()};
  Measurement measurement =
      icp.align(scan_.cloud.point_points_cog, map(), T_odom_cog_start(), guess_.covariance, tracks);
  applyGuessUncertainty(measurement);
  return measurement;
}

Measurement LocalMapRegistration::align(const IcpPointToPlane& icp, double sigma_yaw_rad) const {
  if (readiness() != MeasurementStatus::kOk) return Measurement{readiness()};
  Measurement measurement = icp.align(scan_.cloud.plane_points_cog, map(), T_odom_cog_start(), sigma_yaw_rad);
  if (measurement.ok()) {
    measurement.ahead =
        lookAhead(icp.params(), scan_.cloud.plane_points_cog, map(), measurement.T_odom_cog, guess_.twist_cog);
  }
  applyGuessUncertainty(measurement);
  return measurement;
}

Measurement LocalMapRegistration::roadProfile() const {
  if (readiness() != MeasurementStatus::kOk) return Measurement();
  return roadProfileMeasurement(road_profile_.distance, guess_.T_odom_cog_previous, T_odom_cog_start());
}

Measurement LocalMapRegistration::aboveGround() const {
  if (readiness() != MeasurementStatus::kOk || !open_country_.pose) return Measurement();
  Measurement measurement = aboveGroundMeasurement(*open_country_.pose);
  measurement.clock_jump_suspected = guess_.clock_jump_suspected;
  return measurement;
}

MeasurementStatus LocalMapRegistration::readiness() const {
  if (!prepared_) return MeasurementStatus::kTooFewPoints;
  return guess_.lost ? MeasurementStatus::kNotConverged : MeasurementStatus::kOk;
}

void LocalMapRegistration::applyGuessUncertainty(Measurement& measurement) const {
  measurement.clock_jump_suspected = guess_.clock_jump_suspected;
  addSearchedMotion(guess_, measurement);
  addDriveOff(guess_, params_.initialization, measurement);
  if (!track_.speedWasObserved()) inflateAlongTrack(guess_, params_.initialization, measurement);
  if (open_country_.open_country) inflateInOpenCountry(params_.above_ground, guess_, measurement);
}

void LocalMapRegistration::place(const FilterState& state) {
  const EstimateTrack::Increment increment = track_.add(state);
  enterOdom(state.odom_reset_count);
  if (state.map_update == MapUpdate::kRestart) map_.clear();
  if (!prepared_) return;
  prepared_ = false;
  road_profile_aid_.setPose(state.T_odom_cog);
  if (params_.refine_deskew) refine(increment);
  if (increment.between_measured) builder_.observeBeams(scan_, map(), state.T_odom_cog);
  // a dead-reckoned pose would put its error into the map permanently, and later sweeps would register to it
  if (!state.inMap() && !map_.empty()) return;
  if (map_.empty()) track_.beginAt(state);
  map_.insert(scan_.cloud, state.T_odom_cog, state.time_s(), open_country_aid_.nearlyOpen());
}

void LocalMapRegistration::refine(const EstimateTrack::Increment& increment) {
  if (!increment.twist_cog || scan_.cloud.compensated) return;
  Vector6d twist_cog = *increment.twist_cog;
  // with another turn rate than that of the measurement, map and measurement would amplify each other's errors
  if (guess_.twist_found == InitialGuess::Found::kTurn) twist_cog.tail<3>() = scan_.twist_cog.tail<3>();
  scan_.redeskewTo(twist_cog, scan_.cloud.middle_s);
}

void LocalMapRegistration::skip(const FilterState& state) {
  prepared_ = false;
  place(state);
}

void LocalMapRegistration::enterOdom(int odom_reset_count) {
  if (map_.enterOdom(odom_reset_count)) road_profile_aid_.clear();
}

void LocalMapRegistration::reset() {
  map_.reset();
  track_ = EstimateTrack();
  resolver_.reset();
  road_profile_aid_.reset();
  open_country_aid_.reset();
  builder_.reset();
  prepared_ = false;
}

}  // namespace fail_aware
