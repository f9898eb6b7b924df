// Poses, vectors and their comparison for tests; m, rad.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/pose.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

inline Vector6d vector6(double a, double b, double c, double d, double e, double f) {
  return (Vector6d() << a, b, c, d, e, f).finished();
}

inline Pose pose(double x, double y, double z, double roll, double pitch, double yaw) {
  return poseFromVector(vector6(x, y, z, roll, pitch, yaw));
}

/// The true pose where T is estimated, with this error (geometry/pose.hpp's convention).
inline Pose perturbed(const Pose& T, const Vector6d& error) {
  Pose out = T;
  out.translation() += error.head<3>();
  out.linear() = expSo3(error.tail<3>()) * T.linear();
  return out;
}

/// Finite, symmetric, no eigenvalue negative.
inline void expectCovariance(const Matrix6d& C, const std::string& what = "") {
  ASSERT_TRUE(C.allFinite()) << what;
  EXPECT_LT((C - C.transpose()).cwiseAbs().maxCoeff(), 1e-12 * C.cwiseAbs().maxCoeff()) << what;
  EXPECT_GE(symmetricEigenvalues(C)[0], 0.0) << what;
}

}  // namespace fail_aware
