#include "fail_aware_lidar_odometry/core/registration/registration_front.hpp"

#include "fail_aware_lidar_odometry/core/sweep/stamp_difference.hpp"

namespace fail_aware {

RegistrationFront::RegistrationFront(const RegistrationCloudBuilder::Params& cloud,
                                     const ReferenceMap::Params& reference,
                                     const MotionInitialization::Params& initialization, bool refine_correction)
    : builder_(cloud),
      reference_(reference),
      initialization_(initialization),
      refine_correction_(refine_correction) {}

bool RegistrationFront::prepare(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                const Pose& T_cog_lidar) {
  enterOdom(prediction.odom_epoch);
  builder_.build(sweep, T_cog_lidar, cloud_);
  T_odom_cog_start_ = prediction.T_odom_cog;
  start_covariance_ = prediction.covariance;
  prepared_ = static_cast<int>(cloud_.map_points_cog.size()) >= builder_.params().min_points;
  corrected_twist_cog_.setZero();
  if (prediction.dt_s > 0.0) {
    corrected_twist_cog_ =
        logSe3(prediction.T_odom_cog_previous.inverse() * prediction.T_odom_cog) / prediction.dt_s;
  }
  if (!prepared_ || prediction.motion_known) return prepared_;
  if (map().empty()) {
    initialization_.setFirst(sweep, T_cog_lidar);
  } else {
    initializeMotion(sweep, prediction, T_cog_lidar);
  }
  return true;
}

namespace {

Measurement tooFewPoints() {
  Measurement measurement;
  measurement.status = MeasurementStatus::kTooFewPoints;
  return measurement;
}

}  // namespace

Measurement RegistrationFront::align(const MultiplexIcp& icp, std::vector<SeedTrack>* tracks) const {
  if (tracks != nullptr) tracks->clear();
  if (!prepared_) return tooFewPoints();
  return icp.align(cloud_.point_points_cog, map(), T_odom_cog_start_, start_covariance_, tracks);
}

Measurement RegistrationFront::align(const NormalFilteredIcp& icp, double sigma_yaw_rad) const {
  if (!prepared_) return tooFewPoints();
  return icp.align(cloud_.plane_points_cog, map(), T_odom_cog_start_, sigma_yaw_rad);
}

void RegistrationFront::initializeMotion(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                                         const Pose& T_cog_lidar) {
  const double since_first_s = secondsBetween(first_cloud_.stamp_s, prediction.stamp_s);
  const std::optional<Vector6d> twist = initialization_.findTwist(sweep, T_cog_lidar, since_first_s);
  if (!twist) return;
  recorrectFor(*twist);
  // from the first sweep on: the last estimate may be a prediction at standstill
  T_odom_cog_start_ = T_odom_cog_first_ * expSe3(*twist * since_first_s);
  const double sigma_m = initialization_.params().step_mps * prediction.dt_s;
  start_covariance_.topRows<2>().setZero();
  start_covariance_.leftCols<2>().setZero();
  start_covariance_.topLeftCorner<2, 2>().diagonal().setConstant(sigma_m * sigma_m);
  if (!only_first_placed_ || !refine_correction_) return;
  RegistrationCloud first = first_cloud_;
  first.recorrect(*twist);
  reference_.clear();
  reference_.add(first.map_points_cog, T_odom_cog_first_);
}

void RegistrationFront::recorrectFor(const Vector6d& twist_cog) {
  cloud_.recorrect(twist_cog - corrected_twist_cog_);
  corrected_twist_cog_ = twist_cog;
}

void RegistrationFront::place(const FilterState& state) {
  const bool between_measured = last_measured_ && state.corrected;
  last_measured_ = state.corrected || state.dt_s <= 0.0;  // the first sweep defines the start pose
  enterOdom(state.odom_epoch);
  if (!prepared_) return;
  prepared_ = false;
  // an increment from a prediction to a measured pose holds the prediction's error: no motion to correct for
  if (refine_correction_ && between_measured && state.dt_s > 0.0) recorrectFor(logSe3(state.T_previous_now) / state.dt_s);
  only_first_placed_ = map().empty();
  if (only_first_placed_) {
    last_measured_ = true;  // by definition: the first motion is measured from here
    first_cloud_ = cloud_;
    T_odom_cog_first_ = state.T_odom_cog;
  }
  reference_.add(cloud_.map_points_cog, state.T_odom_cog);
}

void RegistrationFront::enterOdom(int epoch) {
  if (epoch == odom_epoch_) return;
  odom_epoch_ = epoch;
  reference_.clear();
}

void RegistrationFront::reset() {
  reference_.clear();
  initialization_.reset();
  only_first_placed_ = false;
  prepared_ = false;
  last_measured_ = false;
}

}  // namespace fail_aware
