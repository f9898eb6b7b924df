#include "core/estimation/drift_state.hpp"

#include <algorithm>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

// C -> T C T^T with e_i' = e_i + A e_j for 6 rows at i and j.
void addRows(int i, const Matrix6d& A, int j, DriftState::Matrix& C) {
  C.middleRows<6>(i) += (A * C.middleRows<6>(j)).eval();
  C.middleCols<6>(i) += (C.middleCols<6>(j) * A.transpose()).eval();
}

}  // namespace

Matrix6d DriftState::accumulated() const {
  const Matrix6d cross = C.block<6, 6>(kMap, kInMap);
  return C.block<6, 6>(kMap, kMap) + cross + cross.transpose() + inMap();
}

Eigen::Matrix<double, 6, 3> DriftState::cross() const {
  return C.block<6, 3>(kMap, kHeadingBias) + C.block<6, 3>(kInMap, kHeadingBias);
}

void DriftState::foldIntoMap(double ratio) {
  if (!(ratio > 0.0)) return;
  addRows(kMap, ratio * Matrix6d::Identity(), kInMap, C);
  addRows(kInMap, -ratio * Matrix6d::Identity(), kInMap, C);
}

// Errors e = (m, b, s, v, d): m.t += m.r x R t + s R t,  m.r += b |t| R e_z,  d.t += d.r x R t + dt v R e_x,
// v = kept v + noise.
void predictDrift(const DriftStep& step, const Eigen::Matrix3d& R, DriftState& state) {
  constexpr int kMap = DriftState::kMap, kInMap = DriftState::kInMap, kSpeed = DriftState::kSpeed;
  const Eigen::Vector3d moved = R * step.step_m;
  DriftState::Matrix F = DriftState::Matrix::Identity();
  for (const int part : {kMap, kInMap}) F.block<3, 3>(part, part + 3) = -skew(moved);
  F.block<3, 1>(kMap + 3, DriftState::kHeadingBias) = moved.norm() * R.col(2);
  F.block<3, 1>(kMap, DriftState::kScaleBias) = moved;
  F.block<3, 1>(kInMap, kSpeed) = step.dt_s * R.col(0);
  F(kSpeed, kSpeed) = step.speed_error.kept;
  state.C = symmetric(DriftState::Matrix(F * state.C * F.transpose()));
  state.C(kSpeed, kSpeed) = std::max(state.C(kSpeed, kSpeed), step.speed_error.variance_m2_s2);
  state.C.block<6, 6>(kInMap, kInMap) += symmetric(rotateCovariance(step.motion, R));
}

void correctDrift(const DriftStep& step, const Eigen::Matrix3d& R, DriftState& state) {
  // not a covariance, but it turns like one
  const Matrix6d left = rotateCovariance(step.left, R);
  addRows(DriftState::kInMap, left - Matrix6d::Identity(), DriftState::kInMap, state.C);
  state.foldIntoMap(step.replaced);
  state.C.topLeftCorner<6, 6>() += symmetric(rotateCovariance(step.to_map, R));
  state.C = symmetric(state.C);
  state.transient = symmetric(rotateCovariance(step.transient + step.bent, R));
}

}  // namespace fail_aware
