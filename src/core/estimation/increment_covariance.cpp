#include "core/estimation/increment_covariance.hpp"

#include "core/geometry/degree.hpp"
#include "core/geometry/matrix6.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr int kRotationSweeps = 2;  // in which what one leaves open is measured again

bool isConfirmed(const FilterState& state) { return state.measurement_applied && state.fusion.confirmed; }

// Over a long interval a single measurement is no better than the prediction that it started from.
bool isAsPredicted(const FilterState& state) {
  return !state.measurement_applied || (state.dt_s > kLongInterval_s && !isConfirmed(state));
}

}  // namespace

OdometryIncrement incrementOf(const FilterState& state) {
  OdometryIncrement increment{state.increment_covariance,
                              state.unobserved_covariance,
                              state.dt_s,
                              state.speed_error,
                              isAsPredicted(state),
                              {},
                              {},
                              state.map_update == MapUpdate::kRestart};
  if (isConfirmed(state)) increment.confirmed = poseCovarianceFromState(state.fusion.R, state.fusion.z);
  return increment;
}

void setIncrementCovariance(const IncrementFloor& floor, const Matrix6d& Q, double scale,
                            const SweepPrediction& prediction, FilterState& state) {
  // One Kalman step from a pose known exactly, K = Q (Q + R)^-1: the prediction's part (I - K) Q (I - K)^T, along the
  // directions that R does not observe all of Q, and the measurement's part K R K^T.
  Matrix6d from_prediction = Q, accumulated = Q, from_measurement = Matrix6d::Zero();
  if (state.clock_jump) {  // the prediction tells nothing of it
    from_prediction.setZero();
    accumulated.setZero();
    from_measurement = state.fusion.R;
  } else if (!isAsPredicted(state)) {
    const Matrix6d sum = Q + state.fusion.R;
    const Matrix6d K = solutionOf(sum, Q).transpose();
    const Matrix6d left = Matrix6d::Identity() - K;
    from_prediction = left * Q * left.transpose();
    from_measurement = K * state.fusion.R * K.transpose();
    // A rotation that this sweep leaves open is measured again by the next ones, against the same map.
    Matrix6d left_open = left, rotation = left;
    for (int sweep = 1; sweep < kRotationSweeps; ++sweep) rotation = (rotation * left).eval();
    left_open.bottomRows<3>() = rotation.bottomRows<3>();
    accumulated = left_open * Q * left_open.transpose();
  }
  const Vector6d x = vectorFromPose(state.T_odom_cog);
  const Eigen::Matrix3d R_previous_odom = prediction.T_odom_cog_previous.linear().transpose();
  const auto aboutPrevious = [&](const Matrix6d& C) {
    const Matrix6d scaled = 0.5 * scale * (C + C.transpose());
    Matrix6d turned = rotateCovariance(poseCovarianceFromState(scaled, x), R_previous_odom);
    // rounding, where variances differ by many orders of magnitude
    const double least = turned.diagonal().minCoeff();
    if (least < 0.0) turned.diagonal().array() -= least;
    return turned;
  };
  state.unobserved_covariance = aboutPrevious(accumulated);
  state.increment_covariance = aboutPrevious(from_prediction) + aboutPrevious(from_measurement);
  const double floor_m = floor.sigma_m + floor.sigma_per_metre_m * state.T_previous_now.translation().norm();
  const double floor_rad = floor.sigma_deg * kDegree;
  state.increment_covariance.diagonal().head<3>().array() += floor_m * floor_m;
  state.increment_covariance.diagonal().tail<3>().array() += floor_rad * floor_rad;
}

}  // namespace fail_aware
