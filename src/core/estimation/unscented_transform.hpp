// Merwe's scaled sigma points and their mean and covariance (paper, section "Vehicle Pose Estimation System").
//
// Of a pose's N = 6 coordinates 2N + 1 points: the mean, and mean +- sqrt(N + lambda) times the columns of the
// covariance's symmetric square root, lambda = alpha^2 (N + kappa) - N, kappa = 0. The symmetric root exists for
// semi-definite covariances and changes continuously when they rotate. Angles wrap in sums and differences. The mean is
// formed from differences to the first point: this is the circular mean for points less than half a turn from it, and
// it stays accurate when the weights are large and of both signs (small alpha).
// Failure: none for finite input; negative eigenvalues count as 0. Cost: one eigendecomposition.
#pragma once

#include <array>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// Symmetric S with S S = C (C symmetric; eigenvalues below 0 count as 0).
Matrix6d symmetricSquareRoot(const Matrix6d& C);

/// Point 0 is the mean, 1..N the positive side, N+1..2N the negative side.
using SigmaPoints = std::array<Vector6d, 13>;
SigmaPoints sigmaPoints(const Vector6d& mean, const Matrix6d& covariance);

void unscentedMoments(const SigmaPoints& points, Vector6d& mean, Matrix6d& covariance);

}  // namespace fail_aware
