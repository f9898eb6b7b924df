#include "fail_aware_lidar_odometry/core/registration/normal_equations.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

namespace {

// H in units of one length: rotation columns divided by the lever.
struct Spectrum {
  Vector6d eigenvalues;
  Matrix6d eigenvectors;
  Vector6d scale;  // dx = scale .* y
};

Spectrum spectrumOf(const Matrix6d& H, const ObservabilityParams& params) {
  Spectrum s;
  s.scale << 1.0, 1.0, 1.0, 1.0 / params.lever_m, 1.0 / params.lever_m, 1.0 / params.lever_m;
  const Matrix6d scaled = s.scale.asDiagonal() * H * s.scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scaled);
  s.eigenvalues = solver.eigenvalues();
  s.eigenvectors = solver.eigenvectors();
  return s;
}

bool isWeak(double eigenvalue, double weight, const ObservabilityParams& params) {
  return !(eigenvalue > params.min_information_share * weight);
}

}  // namespace

void ObservabilityParams::validate() const {
  requirePositive("lever_m", lever_m);
  requireWithin("min_information_share", min_information_share, 0.0, 0.3);
  requirePositive("weak_sigma_m", weak_sigma_m);
  requirePositive("weak_sigma_deg", weak_sigma_deg);
}

Solution solveObserved(const NormalEquations& equations, const ObservabilityParams& params) {
  Solution solution;
  const Spectrum s = spectrumOf(equations.H, params);
  const Vector6d g = s.eigenvectors.transpose() * (s.scale.asDiagonal() * equations.b);
  Vector6d y = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) {
    if (isWeak(s.eigenvalues[i], equations.weight, params)) {
      ++solution.weak_directions;
    } else {
      y += s.eigenvectors.col(i) * (g[i] / s.eigenvalues[i]);
    }
  }
  solution.dx = s.scale.asDiagonal() * y;
  if (equations.weight > 0.0) {
    const Eigen::Matrix2d horizontal = equations.H.topLeftCorner<2, 2>() / equations.weight;
    const double mean = 0.5 * horizontal.trace();
    const double spread = std::hypot(0.5 * (horizontal(0, 0) - horizontal(1, 1)), horizontal(0, 1));
    solution.min_horizontal_share = std::clamp(mean - spread, 0.0, 1.0);
  }
  return solution;
}

Matrix6d covarianceObserved(const NormalEquations& equations, double scale, const ObservabilityParams& params) {
  const Spectrum s = spectrumOf(equations.H, params);
  Vector6d variances;
  for (int i = 0; i < 6; ++i) {
    // the direction's own share of rotation decides which weak sigma it gets; both are in metres here
    const double rotation_share = s.eigenvectors.col(i).tail<3>().squaredNorm();
    const double weak_rotation_m = params.weak_sigma_deg * M_PI / 180.0 * params.lever_m;
    const double weak = (1.0 - rotation_share) * params.weak_sigma_m * params.weak_sigma_m +
                        rotation_share * weak_rotation_m * weak_rotation_m;
    variances[i] =
        isWeak(s.eigenvalues[i], equations.weight, params) ? weak : std::min(weak, scale / s.eigenvalues[i]);
  }
  const Matrix6d V = s.scale.asDiagonal() * s.eigenvectors;
  return V * variances.asDiagonal() * V.transpose();
}

Pose applyStep(const Pose& T_odom_cog, const Vector6d& dx) {
  Pose T = T_odom_cog;
  T.linear() = expSo3(dx.tail<3>()) * T.linear();
  T.translation() += dx.head<3>();
  return orthonormalized(T);
}

}  // namespace fail_aware
