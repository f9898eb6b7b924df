#include "core/estimation/odometry_covariance.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/geometry/matrix6.hpp"
#include "core/geometry/rotation.hpp"
#include "core/geometry/symmetric_eigen.hpp"

namespace fail_aware {

namespace {

template <class Matrix>
typename Matrix::PlainObject symmetric(const Matrix& C) {
  const typename Matrix::PlainObject& plain = C;  // an expression is evaluated once
  return 0.5 * plain + 0.5 * plain.transpose();
}

// The nearest positive semidefinite matrix.
Matrix6d positiveSemidefinite(const Matrix6d& C) {
  Matrix6d S = symmetric(C);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(S);
  if (eigen.eigenvalues()[0] >= 0.0) return S;
  const Matrix6d half = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return half * half.transpose();
}

constexpr int kMaxGapSweeps = 100;      // then the map from before it is out of sight
constexpr double kMaxGapSigma_m = 5.0;  // beyond it the search after a gap may well settle elsewhere

// From a pose taken as certain; only the speed's error is brought along.
DriftState beginAt(const DriftState& state) {
  DriftState begun;
  begun.accumulated(DriftState::kSpeed, DriftState::kSpeed) = state.accumulated(DriftState::kSpeed, DriftState::kSpeed);
  return begun;
}

bool isUsableInterval(double dt_s) { return std::isfinite(dt_s) && dt_s > 0.0; }

}  // namespace

OdometryCovariance::OdometryCovariance(const DriftModel::Params& drift) : drift_(drift) { reset(); }

// Errors e = (dt, dr, b, s, v) of pose, heading bias, scale bias and speed:
//   dt += dr x R t + p s R t + u dt_s v R e_x,  dr += b |t| R e_z,  v = kept v + noise,
//   p: the pace, u: how little of the motion is observed
void OdometryCovariance::advance(const Pose& T_start_previous, const Pose& T_previous_now,
                                 const OdometryIncrement& increment, DriftState& state) const {
  const Eigen::Matrix3d& R = T_start_previous.linear();
  const Eigen::Vector3d step = R * T_previous_now.translation();
  const double distance_m = step.norm();
  const double pace = drift_.pace(distance_m, increment.dt_s);
  const double u = drift_.unobservedAlong(increment.covariance, increment.unobserved);
  DriftState::Matrix F = DriftState::Matrix::Identity();
  F.topLeftCorner<6, 6>().topRightCorner<3, 3>() = -skew(step);
  F.block<3, 1>(3, DriftState::kHeadingBias) = distance_m * R.col(2);
  F.block<3, 1>(0, DriftState::kScaleBias) = pace * step;
  F.block<3, 1>(0, DriftState::kSpeed) = u * increment.dt_s * R.col(0);
  F(DriftState::kSpeed, DriftState::kSpeed) = increment.speed_error.kept;
  state.accumulated = symmetric(DriftState::Matrix(F * state.accumulated * F.transpose()));
  state.accumulated.topLeftCorner<6, 6>() +=
      symmetric(rotateCovariance(drift_.accumulated(increment.covariance, increment.unobserved, distance_m, pace), R));
  double& speed_variance = state.accumulated(DriftState::kSpeed, DriftState::kSpeed);
  speed_variance = std::max(speed_variance, increment.speed_error.variance_m2_s2);
  state.transient = symmetric(rotateCovariance(drift_.transient(increment.covariance, increment.unobserved), R));
}

// The motion from before the gap to now as one increment, with what the measurement leaves of the prediction's error.
OdometryIncrement OdometryCovariance::sinceGap(const Gap& gap, const Pose& T_gap_now,
                                               const OdometryIncrement& increment) {
  const Matrix6d P = gap.since.accumulated.topLeftCorner<6, 6>();
  const Matrix6d R = symmetric(rotateCovariance(*increment.confirmed, gap.T_odom_base.linear().transpose()));
  const Matrix6d left = Matrix6d::Identity() - Matrix6d(solutionOf(P + R, P).transpose());
  OdometryIncrement whole = increment;
  whole.dt_s = 0.0;  // what the speed's error has done is in P
  whole.unobserved = positiveSemidefinite(left * P * left.transpose());
  const Eigen::Matrix3d R_gap_previous = T_gap_now.linear();
  whole.covariance =
      whole.unobserved + symmetric(rotateCovariance(increment.covariance - increment.unobserved, R_gap_previous));
  return whole;
}

bool OdometryCovariance::propagate(const Pose& T_odom_base_previous, const Pose& T_odom_base_now,
                                   const OdometryIncrement& increment) {
  if (!isFinite(T_odom_base_previous) || !isFinite(T_odom_base_now) || !increment.covariance.allFinite() ||
      !increment.unobserved.allFinite() || !std::isfinite(increment.dt_s) || increment.dt_s < 0.0 ||
      !std::isfinite(increment.speed_error.variance_m2_s2) || !std::isfinite(increment.speed_error.kept)) {
    return false;
  }
  const Pose T_previous_now = T_odom_base_previous.inverse() * T_odom_base_now;
  OdometryIncrement sane = increment;
  const Matrix6d observed = positiveSemidefinite(increment.covariance - increment.unobserved);
  sane.unobserved = positiveSemidefinite(increment.unobserved);
  sane.covariance = sane.unobserved + observed;

  DriftState since_start = since_start_, since_mark = since_mark_;
  advance(T_odom_base_previous, T_previous_now, sane, since_start);
  if (T_odom_mark_) advance(T_odom_mark_->inverse() * T_odom_base_previous, T_previous_now, sane, since_mark);
  bool lost = lost_ && sane.predicted;
  std::optional<Gap> gap = gap_;
  if (sane.predicted && !gap && !lost)
    gap = Gap{T_odom_base_previous, since_start_, since_mark_, beginAt(since_start_), 0};
  if (gap) {
    const Pose T_gap_previous = gap->T_odom_base.inverse() * T_odom_base_previous;
    advance(T_gap_previous, T_previous_now, sane, gap->since);
    const double sigma_m = std::sqrt(gap->since.accumulated.topLeftCorner<2, 2>().diagonal().maxCoeff());
    if (sane.map_restarted || ++gap->sweeps > kMaxGapSweeps || !(sigma_m < kMaxGapSigma_m)) {
      gap.reset();
      lost = true;
    } else if (!sane.predicted && sane.confirmed && sane.confirmed->allFinite()) {
      const Pose T_gap_now = T_gap_previous * T_previous_now;
      const OdometryIncrement whole = sinceGap(*gap, T_gap_now, sane);
      since_start = gap->since_start, since_mark = gap->since_mark;
      advance(gap->T_odom_base, T_gap_now, whole, since_start);
      if (T_odom_mark_) advance(T_odom_mark_->inverse() * gap->T_odom_base, T_gap_now, whole, since_mark);
      gap.reset();
    }
  }
  const Eigen::Vector3d& previous_odom = T_odom_base_previous.translation();
  const bool is_new_map = !map_distance_ || sane.map_restarted;
  const MapDistance before = is_new_map ? MapDistance{previous_odom, 0.0} : *map_distance_;
  MapDistance way = before;
  way.farthest_m = std::max(before.farthest_m, (T_odom_base_now.translation() - way.begin_odom).norm());
  const Vector6d new_map = drift_.newMapVariances(before.farthest_m, way.farthest_m);
  since_start.accumulated.diagonal().head<6>() += new_map;
  if (T_odom_mark_) since_mark.accumulated.diagonal().head<6>() += new_map;
  if (!since_start.accumulated.allFinite() || !since_mark.accumulated.allFinite()) return false;
  lost_ = lost;
  gap_ = gap;
  map_distance_ = way;
  since_start_ = since_start;
  since_mark_ = since_mark;
  if (T_odom_mark_) since_mark_covariance_ = since_mark_.pose();
  transient_base_ =
      rotateCovariance(drift_.transient(sane.covariance, sane.unobserved), T_previous_now.linear().transpose());
  largest_transient_base_ += positiveSemidefinite(transient_base_ - largest_transient_base_);
  vertical_.advance(T_odom_base_now.translation() - previous_odom, increment.tilt_moment);
  covariance_ = since_start_.accumulated.topLeftCorner<6, 6>() +
                symmetric(rotateCovariance(largest_transient_base_, T_odom_base_now.linear())) + vertical_.covariance();
  speed_variance_ = since_start_.accumulated(DriftState::kSpeed, DriftState::kSpeed);
  return true;
}

void OdometryCovariance::reset(const Matrix6d& start_covariance) {
  const Eigen::Vector2d biases = drift_.biasVariances();
  since_start_ = DriftState();
  vertical_ = VerticalDrift();
  if (start_covariance.allFinite())
    since_start_.accumulated.topLeftCorner<6, 6>() = positiveSemidefinite(start_covariance);
  since_start_.accumulated.diagonal().segment<2>(DriftState::kHeadingBias) = biases;
  covariance_ = since_start_.pose();
  transient_base_.setZero();
  largest_transient_base_.setZero();
  speed_variance_ = 0.0;
  gap_.reset();
  lost_ = false;
  map_distance_.reset();
  T_odom_mark_.reset();
  since_mark_ = DriftState();
  since_mark_covariance_.setZero();
}

void OdometryCovariance::enterOdom() {
  gap_.reset();
  map_distance_.reset();
}

void OdometryCovariance::mark(const Pose& T_odom_mark) {
  since_mark_ = DriftState();
  since_mark_covariance_.setZero();
  T_odom_mark_.reset();
  gap_.reset();  // what was wrong at the mark is not seen from there
  if (!isFinite(T_odom_mark)) return;
  T_odom_mark_ = T_odom_mark;
  // The jitter of the mark itself stays: all that follows is seen from there.
  since_mark_.accumulated.topLeftCorner<6, 6>() = transient_base_;
  since_mark_.accumulated.diagonal().segment<2>(DriftState::kHeadingBias) = drift_.biasVariances();
  since_mark_.accumulated(DriftState::kSpeed, DriftState::kSpeed) = speed_variance_;
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
