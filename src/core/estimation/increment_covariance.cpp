#include "core/estimation/increment_covariance.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kUnknownDistance_m = 15.0, kUnknownTurn_rad = 0.8;  // what the relocalization searches

constexpr double kMostTilt_rad = 2.0 * kDegree;  // standard deviation of roll and of pitch in a sweep or a gap
// farther from its last sweep a map of 100 m holds too little to compare
constexpr double kComparedPlaces_m = 60.0;

bool isUsableInterval(double dt_s) { return std::isfinite(dt_s) && dt_s > 0.0; }

bool isConfirmed(const FilterState& state) { return state.measurement_applied && state.fusion.confirmed; }

// Over a long interval a single measurement is no better than the prediction that it started from.
bool isAsPredicted(const FilterState& state) {
  return !state.measurement_applied || (state.dt_s > kLongInterval_s && !isConfirmed(state));
}

// Without a measurement the filter's roll and pitch may take any angle within its noise; the vehicle stays on the road.
Matrix6d onTheRoad(Matrix6d Q) {
  for (int i = 3; i < 5; ++i) {
    const double ratio = kMostTilt_rad / std::sqrt(std::max(Q(i, i), 1e-12));
    if (ratio >= 1.0) continue;
    Q.row(i) *= ratio;
    Q.col(i) *= ratio;
  }
  return Q;
}

}  // namespace

OdometryIncrement incrementOf(const FilterState& state) {
  OdometryIncrement increment;
  increment.motion = state.motion_covariance;
  if (state.registered) increment.registration = state.registration_covariance;
  increment.confirmed = isConfirmed(state);
  increment.alone = !increment.confirmed && state.fusion.disagreement_m == 0.0 && !(state.doubt.sigma_m > 0.0);
  increment.dt_s = state.dt_s;
  increment.speed_error = state.speed_error;
  increment.doubt = state.doubt;
  increment.view_range_m = state.view_range_m;
  // before a motion is known, a map that begins with a sweep is reported as an insertion
  const bool begins = state.map_update == MapUpdate::kInsert && !state.measurement_applied &&
                      state.motion_status == MotionStatus::kUnknown;
  increment.map_update = begins ? MapUpdate::kRestart : state.map_update;
  return increment;
}

MotionDoubt clockDoubt(const SweepPrediction& prediction, const FilterState& state) {
  constexpr double kTurn_rad_s = 0.1;
  MotionDoubt doubt;
  if (state.clock_jump) {
    const double apart_m = (state.T_odom_cog.translation() - prediction.T_odom_cog.translation()).norm();
    if (apart_m > kComparedPlaces_m) doubt.sigma_m = apart_m;
  } else if (state.measurement_applied && !state.fusion.confirmed && prediction.set_back_s > 0.0) {
    const double uncounted_s = prediction.set_back_s + prediction.period_s;
    const double predicted_m =
        (prediction.T_odom_cog.translation() - prediction.T_odom_cog_previous.translation()).norm();
    doubt.sigma_m = predicted_m * uncounted_s / std::max(prediction.dt_s, kShortestPeriod_s);
    doubt.sigma_yaw_rad = kTurn_rad_s * uncounted_s;
  }
  return doubt;
}

void setIncrementCovariance(const IncrementScale& scale, const Matrix6d& Q, const SweepPrediction& prediction,
                            FilterState& state) {
  const FusionResult& fusion = state.fusion;
  // while no motion is known, all measurements of a sweep begin at the same guess
  state.registered = !isAsPredicted(state) && prediction.motionKnown();
  // One Kalman step from a pose known exactly, K = Q (Q + R)^-1: the prediction's part (I - K) Q (I - K)^T and the
  // measurement's part K R K^T.
  Matrix6d increment = Q;
  Matrix6d motion = state.registered ? Q : onTheRoad(Q);
  if (state.clock_jump) {  // the prediction tells nothing of it
    increment = fusion.R;
    motion = isotropicCovariance(kUnknownDistance_m, kUnknownTurn_rad);
  } else if (!isAsPredicted(state)) {
    const Matrix6d K = solutionOf(Q + fusion.R, Q).transpose();
    const Matrix6d left = Matrix6d::Identity() - K;
    increment = left * Q * left.transpose() + K * fusion.R * K.transpose();
  }
  const Vector6d x = vectorFromPose(state.T_odom_cog);
  const Eigen::Matrix3d R_previous_odom = prediction.T_odom_cog_previous.linear().transpose();
  const auto aboutPrevious = [&](const Matrix6d& C, double factor) {
    const Matrix6d scaled = 0.5 * factor * (C + C.transpose());
    Matrix6d turned = rotateCovariance(poseCovarianceFromState(scaled, x), R_previous_odom);
    // rounding, where variances differ by many orders of magnitude
    const double least = turned.diagonal().minCoeff();
    if (least < 0.0) turned.diagonal().array() -= least;
    return turned;
  };
  // errors of successive predictions are alike, while a registration ends them
  state.motion_covariance = aboutPrevious(motion, state.registered ? 1.0 : scale.dead_reckoning_factor);
  const double factor = scale.factor * scale.dead_reckoning_factor;
  if (state.registered) state.registration_covariance = aboutPrevious(fusion.R, factor);
  state.increment_covariance = aboutPrevious(increment, factor);
  const double floor_m = scale.floor_m + scale.floor_per_metre_m * state.T_previous_now.translation().norm();
  const double floor_rad = scale.floor_deg * kDegree;
  state.increment_covariance.diagonal().head<3>().array() += floor_m * floor_m;
  state.increment_covariance.diagonal().tail<3>().array() += floor_rad * floor_rad;
}

std::optional<Vector6d> twistFromIncrement(const Pose& T_previous_now, double dt_s) {
  if (!isFinite(T_previous_now) || !isUsableInterval(dt_s)) return std::nullopt;
  const Vector6d twist = logSe3(T_previous_now) / dt_s;
  if (!twist.allFinite()) return std::nullopt;
  return twist;
}

std::optional<Matrix6d> twistCovariance(const Matrix6d& increment_covariance, const Pose& T_previous_now, double dt_s) {
  if (!increment_covariance.allFinite() || !isFinite(T_previous_now) || !isUsableInterval(dt_s)) return std::nullopt;
  // In the newest body's axes the error is a right factor, T Exp(e); log(T Exp(e)) = log(T) + J_r^-1 e with
  // J_r^-1 = I + ad/2 + ad^2/12 + O(ad^4).
  const Vector6d increment = logSe3(T_previous_now);
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = skew(increment.tail<3>());
  ad.topRightCorner<3, 3>() = skew(increment.head<3>());
  const Matrix6d J = Matrix6d::Identity() + 0.5 * ad + ad * ad / 12.0;
  const Matrix6d about_now =
      rotateCovariance(positiveSemidefinite(increment_covariance), T_previous_now.linear().transpose());
  const Matrix6d covariance = symmetric(J * about_now * J.transpose()) / (dt_s * dt_s);
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace fail_aware
