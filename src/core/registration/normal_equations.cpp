#include "core/registration/normal_equations.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

const Matrix6d& informationOf(const NormalEquations& equations) {
  return equations.has_information ? equations.information : equations.H;
}

double weightOf(const NormalEquations& equations) {
  return equations.has_information ? equations.information_weight : equations.weight;
}

using Directions = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

// The spectrum of the information in units of one length (rotation columns divided by the lever), what of it is
// observed, and which equations observe it.
struct Observed {
  Vector6d eigenvalues;
  Matrix6d eigenvectors;
  Vector6d scale;                  // dx = scale .* y
  int weak = 0;                    // the first of the spectrum
  bool information_alone = false;  // sliding residuals would outweigh what is observed least

  Observed(const NormalEquations& equations, const ObservabilityParams& params) {
    scale << 1.0, 1.0, 1.0, 1.0 / params.lever_m, 1.0 / params.lever_m, 1.0 / params.lever_m;
    const Matrix6d scaled = scale.asDiagonal() * informationOf(equations) * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver = symmetricEigen(scaled);
    eigenvalues = solver.eigenvalues();
    eigenvectors = solver.eigenvectors();
    const double weight = weightOf(equations);
    while (weak < 6 && !(eigenvalues[weak] > params.min_information_ratio * weight)) ++weak;
    information_alone = equations.has_information &&
                        (!equations.slides || (weak < 6 && eigenvalues[weak] <= params.min_sliding_ratio * weight));
  }
};

}  // namespace

void discount(NormalEquations& equations, const Eigen::Vector2d& direction, double counted_ratio) {
  if (!equations.has_information) {
    equations.has_information = true;
    equations.information = equations.H;
    equations.information_b = equations.b;
    equations.information_weight = equations.weight;
  }
  Matrix6d D = Matrix6d::Identity();
  D.topLeftCorner<2, 2>() -= (1.0 - std::sqrt(counted_ratio)) * direction * direction.transpose();
  equations.information = (D * equations.information * D).eval();
  equations.information_b = (D * equations.information_b).eval();
}

HorizontalRatios horizontalRatios(const NormalEquations& equations) {
  const double weight = weightOf(equations);
  if (!(weight > 0.0)) return {};
  const Eigen::Vector2d ratios =
      symmetricEigenvalues(Eigen::Matrix2d(informationOf(equations).topLeftCorner<2, 2>() / weight));
  return {std::clamp(ratios[0], 0.0, 1.0), std::clamp(ratios[1], 0.0, 1.0)};
}

Solution solveObserved(const NormalEquations& equations, const ObservabilityParams& params) {
  Solution solution;
  const Observed observed(equations, params);
  solution.degenerate_directions = observed.weak;
  if (observed.weak < 6) {
    const Matrix6d& H = observed.information_alone ? equations.information : equations.H;
    const Vector6d& b = observed.information_alone ? equations.information_b : equations.b;
    const Directions V = observed.scale.asDiagonal() * observed.eigenvectors.rightCols(6 - observed.weak);
    const Square A = V.transpose() * H * V;
    solution.dx = V * A.ldlt().solve(V.transpose() * b);
  }
  solution.min_horizontal_ratio = horizontalRatios(equations).weakest;
  return solution;
}

Matrix6d covarianceObserved(const NormalEquations& equations, double scale, const ObservabilityParams& params) {
  const Observed observed(equations, params);
  const double weak_rotation_m = params.weak_sigma_deg * kDegree * params.lever_m;
  Matrix6d covariance = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    // the rotation's part of the direction decides which weak sigma it gets; both are in metres here
    const double rotation_ratio = observed.eigenvectors.col(i).tail<3>().squaredNorm();
    const double weak_variance = (1.0 - rotation_ratio) * params.weak_sigma_m * params.weak_sigma_m +
                                 rotation_ratio * weak_rotation_m * weak_rotation_m;
    const bool is_weak = i < observed.weak;
    const double variance = is_weak ? weak_variance : std::min(weak_variance, scale / observed.eigenvalues[i]);
    const Vector6d v = observed.scale.cwiseProduct(observed.eigenvectors.col(i));
    covariance += variance * v * v.transpose();
  }
  return covariance;
}

double rmsResidual(const NormalEquations& equations) {
  return std::sqrt(equations.squared_error / std::max(equations.weight_unscaled, 1e-9));
}

double curvatureRatio(const NormalEquations& equations) {
  return equations.curvature / std::max(weightOf(equations), 1e-9);
}

bool isWithinSigma(const Vector6d& dx, const Matrix6d& covariance) { return dx.dot(solutionOf(covariance, dx)) < 1.0; }

Pose applyStep(const Pose& T_odom_cog, const Vector6d& dx) {
  Pose T = T_odom_cog;
  T.linear() = expSo3(dx.tail<3>()) * T.linear();
  T.translation() += dx.head<3>();
  return orthonormalized(T);
}

}  // namespace fail_aware
