#include "fail_aware_lidar_odometry/core/registration/registration_front.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/core/geometry/symmetric_eigen.hpp"
#include "fail_aware_lidar_odometry/core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kSurePlaces = 10.0;  // the search for the first motion is as good as its last step if so many agree
constexpr double kMaxWrongSpeed_mps = 1.0;  // 0.1 m a sweep
constexpr double kMaxSearchTime_s = 1.0;    // since the first sweep; then it is out of sight
constexpr double kStaysOpen = 2.0;    // open country ends above so many times the planes' share below which it began,
constexpr int kOpenSweeps = 5;        // or after so many sweeps above that; but only where next to nothing stands:
constexpr double kClearlyOpen = 0.5;  // less than that of the limit

// The turn that is left in them is looked for by the azimuth; without that search nobody asks for times.
std::optional<SweepTimingParams> compensatedHead(const RegistrationParameters& params,
                                                 const SweepTimingParams& timing) {
  if (timing.source != "none" || !params.turn_search.enabled) return std::nullopt;
  return timing;
}

/// By bit: the eighths of the azimuth that hold points.
std::bitset<8> eighthsSeen(const std::vector<Eigen::Vector3f>& points_cog) {
  constexpr std::size_t kFewest = 20;
  std::array<std::size_t, 8> points{};
  for (const Eigen::Vector3f& p : points_cog) {
    const bool steep = std::abs(p.y()) > std::abs(p.x());
    ++points[(p.x() > 0.0f ? 1u : 0u) | (p.y() > 0.0f ? 2u : 0u) | (steep ? 4u : 0u)];
  }
  std::bitset<8> seen;
  for (std::size_t i = 0; i < 8; ++i) seen[i] = points[i] >= kFewest;
  return seen;
}

}  // namespace

RegistrationFront::RegistrationFront(const RegistrationParameters& params, const SweepTimingParams& timing)
    : builder_(params.cloud, compensatedHead(params, timing)),
      map_(params.reference, params.standing.reference()),
      relocalization_(params.relocalization, params.point),
      initialization_(params.initialization, params.cloud.min_range_m),
      relief_(params.relief),
      turn_search_(params.turn_search, params.plane),
      beam_ranges_(params.beam_ranges, params.plane),
      standing_(params.standing, params.plane),
      refine_correction_(params.refine_correction) {}

bool RegistrationFront::prepare(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                const Pose& T_cog_lidar) {
  enterOdom(prediction.odom_epoch);
  builder_.build(sweep, T_cog_lidar, cloud_, beam_ranges_.offsets_m());
  lidar_in_cog_ = T_cog_lidar.translation();
  T_odom_cog_start_ = prediction.T_odom_cog;
  start_covariance_ = prediction.covariance;
  prepared_ = static_cast<int>(cloud_.map_points_cog.size()) >= builder_.params().min_points;
  corrected_twist_cog_.setZero();
  if (prediction.dt_s > 0.0) {
    corrected_twist_cog_ = logSe3(prediction.T_odom_cog_previous.inverse() * prediction.T_odom_cog) / prediction.dt_s;
  }
  T_odom_cog_previous_ = prediction.T_odom_cog_previous;
  dt_s_ = prediction.dt_s;
  searched_sigma_m_ = 0.0;
  interval_doubted_ = false;
  standing_pose_.reset();
  open_country_ = false;
  turn_found_ = false;
  updateRelief(sweep, prediction, T_cog_lidar);
  if (!prepared_) return false;
  if (prediction.motion_known) {
    relocalize();
    checkInterval(prediction);
    if (!lost_) {
      findTurn(prediction.sigma_yaw_rad);
      matchStanding(prediction.sigma_yaw_rad);
    }
    return true;
  }
  // a search that failed would fail for good: this sweep is the first one now
  if (secondsBetween(map_.first().time_s, prediction.time_s()) > kMaxSearchTime_s) map_.restart();
  if (map().empty()) {
    initialization_.setFirst(sweep, T_cog_lidar);
  } else {
    initializeMotion(sweep, prediction, T_cog_lidar);
  }
  return true;
}

namespace {

Measurement withoutPose(MeasurementStatus status) {
  Measurement measurement;
  measurement.status = status;
  return measurement;
}

// One Kalman step: along `along` (odom's axes) the pose is off by `offset`, known to `sigma`.
void addOffset(const Vector6d& along, double offset, double sigma, Measurement& measurement) {
  const Vector6d C_along = measurement.covariance * along;
  const Vector6d gain = C_along / (along.dot(C_along) + sigma * sigma);
  measurement.T_odom_cog = applyStep(measurement.T_odom_cog, gain * offset);
  measurement.covariance -= (gain * C_along.transpose()).eval();
  measurement.covariance = (0.5 * (measurement.covariance + measurement.covariance.transpose())).eval();
}

void addPosition(const Eigen::Vector3d& axis, double offset_m, double sigma_m, Measurement& measurement) {
  Vector6d along = Vector6d::Zero();
  along.head<3>() = axis;
  addOffset(along, offset_m, sigma_m, measurement);
}

}  // namespace

Measurement RegistrationFront::align(const MultiplexIcp& icp, std::vector<SeedTrack>* tracks) const {
  if (tracks != nullptr) tracks->clear();
  if (!prepared_) return withoutPose(MeasurementStatus::kTooFewPoints);
  if (lost_) return withoutPose(MeasurementStatus::kNotConverged);
  Measurement measurement = icp.align(cloud_.point_points_cog, map(), T_odom_cog_start_, start_covariance_, tracks);
  measurement.interval_doubted = interval_doubted_;
  addSearchedMotion(measurement);
  doubtStandstill(measurement);
  addStanding(measurement);
  return measurement;
}

Measurement RegistrationFront::align(const NormalFilteredIcp& icp, double sigma_yaw_rad) const {
  if (!prepared_) return withoutPose(MeasurementStatus::kTooFewPoints);
  if (lost_) return withoutPose(MeasurementStatus::kNotConverged);
  Measurement measurement = icp.align(cloud_.plane_points_cog, map(), T_odom_cog_start_, sigma_yaw_rad);
  measurement.interval_doubted = interval_doubted_;
  addSearchedMotion(measurement);
  doubtStandstill(measurement);
  addReliefSpeed(measurement);
  addStanding(measurement);
  return measurement;
}

// What is seen alike from sweep to sweep - a vehicle ahead, edges drawn by single beams - fits best at standstill. So
// long as the speed is unknown, little information is no proof of it.
void RegistrationFront::doubtStandstill(Measurement& measurement) const {
  const MotionInitialization::Params& params = initialization_.params();
  if (track_.speedWasObserved() || !measurement.ok() || !(dt_s_ > 0.0)) return;
  const Eigen::Vector3d forward = T_odom_cog_previous_.linear().col(0);
  const double way_m = forward.dot(measurement.T_odom_cog.translation() - T_odom_cog_previous_.translation());
  if (std::abs(way_m) > params.standstill_m || measurement.min_information_share > params.standstill_share) return;
  const double sigma_m = params.max_speed_mps * dt_s_;
  measurement.covariance.topLeftCorner<3, 3>() += sigma_m * sigma_m * forward * forward.transpose();
  measurement.weak_directions = std::min(measurement.weak_directions + 1, 6);
  measurement.min_information_share = 0.0;
}

void RegistrationFront::updateRelief(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                     const Pose& T_cog_lidar) {
  relief_speed_.reset();
  if (!relief_.params().enabled) return;
  const std::bitset<8> before = std::exchange(eighths_seen_, eighthsSeen(cloud_.map_points_cog));
  // parts of a revolution show another road each
  const bool looks_elsewhere = 2 * (before & eighths_seen_).count() < (before | eighths_seen_).count();
  if (!prepared_ || track_.speedObserved() || looks_elsewhere) return relief_.clear();
  relief_.add(sweep, T_cog_lidar, corrected_twist_cog_, rpyFromRotation(prediction.T_odom_cog.linear()).z());
  const bool known_before = relief_.hasSpeed();
  const double assumed_mps = corrected_twist_cog_[0];
  relief_speed_ =
      track_.speedWasObserved() ? relief_.findSpeed(assumed_mps, track_.speedSigma_mps()) : relief_.findSpeed();
  // at a wrong speed the sweeps were placed beside each other: what they give now is false
  if (relief_speed_ && !known_before && std::abs(relief_speed_->speed_mps - assumed_mps) > kMaxWrongSpeed_mps) {
    map_.restart();
  }
}

// The way driven since the last estimate, along the vehicle's heading half-way.
void RegistrationFront::addReliefSpeed(Measurement& measurement) const {
  if (!relief_speed_ || !measurement.ok() || !(dt_s_ > 0.0)) return;
  const Eigen::Vector3d forward =
      (T_odom_cog_previous_.linear().col(0) + T_odom_cog_start_.linear().col(0)).normalized();
  const double way_m = (relief_speed_->speed_mps - 0.5 * relief_speed_->acceleration_mps2 * dt_s_) * dt_s_;
  const double measured_m = forward.dot(measurement.T_odom_cog.translation() - T_odom_cog_previous_.translation());
  addPosition(forward, way_m - measured_m, relief_speed_->sigma_mps * dt_s_, measurement);
}

// The first motion was found by what stands out in both sweeps, which may be too little for surfaces.
void RegistrationFront::addSearchedMotion(Measurement& measurement) const {
  if (!(searched_sigma_m_ > 0.0) || !measurement.ok()) return;
  for (const Eigen::Vector3d axis : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()}) {
    const double offset_m = axis.dot(T_odom_cog_start_.translation() - measurement.T_odom_cog.translation());
    addPosition(axis, offset_m, searched_sigma_m_, measurement);
  }
}

// Without it the measurements would settle on whatever is near; a few sweeps later it may do.
void RegistrationFront::relocalize() {
  lost_ = false;
  const bool after_gap = !track_.measured() || dt_s_ > kLongInterval_s;
  if (!after_gap || map().empty() || !relocalization_.isNeeded(start_covariance_)) return;
  const Relocalization::Gap gap{secondsBetween(map_.newest().time_s, cloud_.stamp_s),
                                (T_odom_cog_start_.translation() - map_.newest().T_odom_cog.translation()).norm()};
  const std::optional<Pose> T_odom_cog = relocalization_.find(cloud_, map(), T_odom_cog_start_, start_covariance_, gap);
  if (T_odom_cog) T_odom_cog_start_ = *T_odom_cog;
  lost_ = !T_odom_cog;
}

void RegistrationFront::checkInterval(const SweepPrediction& prediction) {
  if (map().empty() || track_.tooManyUnplaced()) return;
  IntervalCheck::Interval interval;
  interval.stamps = {dt_s_, prediction.set_back_s};
  interval.unplaced = track_.unplaced();
  interval.T_odom_cog_placed = track_.T_odom_cog_placed();
  interval.twist_cog = track_.placedTwist().value_or(corrected_twist_cog_);
  interval.T_odom_cog_predicted = prediction.T_odom_cog;
  if (!lost_) interval.T_odom_cog_by_the_stamps = T_odom_cog_start_;
  const std::optional<Pose> T_odom_cog = interval_check_.findOther(
      interval, [this](const Pose& T) { return relocalization_.fit(cloud_, map(), T, start_covariance_); });
  if (!T_odom_cog) return;
  T_odom_cog_start_ = *T_odom_cog;
  lost_ = false;
  interval_doubted_ = true;
  relief_.clear();  // it goes by the stamps
  relief_speed_.reset();
}

void RegistrationFront::initializeMotion(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                         const Pose& T_cog_lidar) {
  const double since_first_s = secondsBetween(map_.first().time_s, prediction.time_s());
  double places_met = 0.0;
  const std::optional<Vector6d> twist = initialization_.findTwist(sweep, T_cog_lidar, since_first_s, &places_met);
  if (!twist) return;
  if (!cloud_.compensated) recorrectFor(*twist);
  // from the first sweep on: the last estimate may be a prediction at standstill
  T_odom_cog_start_ = map_.first().T_odom_cog * expSe3(*twist * since_first_s);
  const double step_m = initialization_.params().step_mps * since_first_s;
  searched_sigma_m_ = (places_met >= kSurePlaces ? MotionInitialization::kFineStep : 1.0) * step_m;
  start_covariance_.topRows<2>().setZero();
  start_covariance_.leftCols<2>().setZero();
  start_covariance_.topLeftCorner<2, 2>().diagonal().setConstant(step_m * step_m);
  if (refine_correction_) map_.redeskewFirst(*twist, cloud_.middle_s);
}

void RegistrationFront::findTurn(double sigma_yaw_rad) {
  const double middle_s = cloud_.middle_s;
  const std::optional<Eigen::Vector3d> rate_rad_s = turn_search_.find(
      cloud_.plane_points_cog, cloud_.plane_times_s, middle_s, map(), T_odom_cog_start_, sigma_yaw_rad);
  turn_found_ = rate_rad_s.has_value();
  if (!turn_found_) return;
  Vector6d twist_cog = corrected_twist_cog_;
  twist_cog.tail<3>() += *rate_rad_s;
  recorrectFor(twist_cog, middle_s);
}

void RegistrationFront::matchStanding(double sigma_yaw_rad) {
  const StandingMatch::Params& params = standing_.params();
  if (!params.enabled) return;
  // A sweep with a little more to hold on to does not end it: its planes are sure of the heading, and often wrong.
  const double slack = open_sweeps_left_ > 0 ? kStaysOpen : 1.0;
  open_sweeps_left_ = std::max(0, open_sweeps_left_ - 1);
  const double share = standing_.shareOfPlanes(cloud_.plane_points_cog, map(), T_odom_cog_start_, sigma_yaw_rad);
  nearly_open_ = share <= kStaysOpen * params.max_information_share;
  if (share > slack * params.max_information_share) return;
  const StandingPoints standing = standing_.select(cloud_.map_points_cog);
  open_country_ = standing.share <= params.max_standing_share;
  if (!open_country_) return;
  if (share <= params.max_information_share && standing.share <= kClearlyOpen * params.max_standing_share) {
    open_sweeps_left_ = kOpenSweeps;
  }
  standing_pose_ = standing_.find(standing, map_.standing(), T_odom_cog_start_);
  if (standing_pose_) T_odom_cog_start_ = standing_pose_->T_odom_cog;
}

// Surfaces keep height, roll and pitch; of the rest they know little there, whatever their R says.
void RegistrationFront::addStanding(Measurement& measurement) const {
  if (!open_country_ || !measurement.ok()) return;
  const StandingMatch::Params& params = standing_.params();
  // what travels with the sensor is off by no more than the way
  const double way_m = corrected_twist_cog_.head<3>().norm() * dt_s_;
  const double surface_sigma_m = std::min(params.surface_sigma_m, 0.5 * way_m);
  const double surface_sigma_rad = params.surface_sigma_deg * kDegree * surface_sigma_m / params.surface_sigma_m;
  measurement.covariance.diagonal().head<2>().array() += surface_sigma_m * surface_sigma_m;
  measurement.covariance(5, 5) += surface_sigma_rad * surface_sigma_rad;
  if (!standing_pose_) return;
  const Pose& T = standing_pose_->T_odom_cog;
  const auto eigen = symmetricEigen(standing_pose_->covariance);
  for (int i = 0; i < 3; ++i) {  // along these the errors are independent
    Vector6d direction = Vector6d::Zero();
    direction.head<2>() = eigen.eigenvectors().col(i).head<2>();
    direction[5] = eigen.eigenvectors()(2, i);
    Vector6d offset;
    offset << T.translation() - measurement.T_odom_cog.translation(),
        logSo3(T.linear() * measurement.T_odom_cog.linear().transpose());
    addOffset(direction, direction.dot(offset), std::sqrt(std::max(eigen.eigenvalues()[i], 0.0)), measurement);
  }
}

void RegistrationFront::recorrectFor(const Vector6d& twist_cog, double middle_s) {
  cloud_.recorrect(twist_cog - corrected_twist_cog_, middle_s);
  corrected_twist_cog_ = twist_cog;
}

void RegistrationFront::place(const FilterState& state) {
  const EstimateTrack::Increment increment = track_.add(state);
  enterOdom(state.odom_epoch);
  map_.enterReference(state.reference_epoch);
  if (!prepared_) return;
  prepared_ = false;
  relief_.setYaw(rpyFromRotation(state.T_odom_cog.linear()).z());
  if (refine_correction_ && increment.twist_cog && !cloud_.compensated) {
    Vector6d twist_cog = *increment.twist_cog;
    // for another turn than the one it was measured with, map and measurement would lead each other astray
    if (turn_found_) twist_cog.tail<3>() = corrected_twist_cog_.tail<3>();
    recorrectFor(twist_cog, cloud_.middle_s);
  }
  if (increment.between_measured) {
    beam_ranges_.observe(cloud_.plane_points_cog, cloud_.plane_rings, lidar_in_cog_, map(), state.T_odom_cog);
  }
  // a prediction's error would be in the map for good, and the sweeps after it register to it
  if (!state.placed && !map_.empty()) return;
  if (map_.empty()) track_.beginAt(state);
  map_.insert(cloud_, state.T_odom_cog, state.time_s(), nearly_open_);
}

void RegistrationFront::skip(const FilterState& state) {
  prepared_ = false;
  place(state);
}

void RegistrationFront::enterOdom(int epoch) {
  if (map_.enterOdom(epoch)) relief_.clear();
}

void RegistrationFront::reset() {
  map_.reset();
  track_ = EstimateTrack();
  initialization_.reset();
  relief_.clear();
  beam_ranges_.reset();
  nearly_open_ = true;
  open_sweeps_left_ = 0;
  relief_speed_.reset();
  interval_check_.reset();
  prepared_ = false;
  lost_ = false;
}

}  // namespace fail_aware
