// Normal equations of a pose, with the directions that the data do not observe left out.
//
// The unknown is a small motion of the vehicle about its own position: dx = (dt, dr) in odom's axes,
// p -> p + dt + dr x (p - t). Rotation is compared with translation at the lever `lever_m`.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

struct ObservabilityParams {
  /// a rotation dr moves points at this distance by lever_m * dr: a usual range of points
  double lever_m = 10.0;
  double min_information_ratio = 0.01;  ///< a direction with a smaller ratio of the total weight is not observed
  /// Where an observed direction has less than this, steps, too, are made of the information alone: sliding residuals
  /// would outweigh it.
  double min_sliding_ratio = 0.03;
  /// standard deviation in R along an unobserved direction: as good as no measurement to gate and fusion
  double weak_sigma_m = 3.0;
  double weak_sigma_deg = 5.0;  ///< likewise of a rotation

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("min_information_ratio", self.min_information_ratio, within(0.0, 0.3));
  }
};

/// H dx = b, with H = sum w J^T J / sigma^2, b = -sum w J^T r / sigma^2.
struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double weight = 0.0;  ///< sum of w / sigma^2
  /// What the data say of each direction, where H says more: the nearest of a plane's points slides along it, so a
  /// pair's H has directions that it does not observe. Without `has_information`: H itself.
  bool has_information = false;
  bool slides = false;  ///< H has more than the information (else it is the same, discounted)
  Matrix6d information = Matrix6d::Zero();
  Vector6d information_b = Vector6d::Zero();  ///< b of the same residuals
  double information_weight = 0.0;
  double squared_error = 0.0;    ///< sum of w r^2, m^2
  double weight_unscaled = 0.0;  ///< sum of w
  /// Sum of w / sigma^2 (of the information, where there is one) times the kernel's curvature along what a pair informs
  /// on.
  double curvature = 0.0;
  std::size_t inliers = 0;
};

struct Solution {
  Vector6d dx = Vector6d::Zero();
  int degenerate_directions = 0;
  double min_horizontal_ratio = 0.0;
};

/// Only `counted_ratio` of the information along a horizontal direction (unit vector) counts (information_support.hpp).
void discount(NormalEquations& equations, const Eigen::Vector2d& direction, double counted_ratio);

/// The ratio of the information that the weakest and the strongest horizontal direction have, 0..1; 0 without pairs.
struct HorizontalRatios {
  double weakest = 0.0, strongest = 0.0;
};
HorizontalRatios horizontalRatios(const NormalEquations& equations);

/// The step along observed directions only.
Solution solveObserved(const NormalEquations& equations, const ObservabilityParams& params);

/// The covariance of the solution: `scale` * H^-1 along observed directions, the weak sigmas along the others.
Matrix6d covarianceObserved(const NormalEquations& equations, double scale, const ObservabilityParams& params);

/// Weighted mean of the kernel's curvature, for kernelInflation() (robust_kernel.hpp).
double curvatureRatio(const NormalEquations& equations);

/// Whether a step is shorter than the standard deviation along it.
bool isWithinSigma(const Vector6d& dx, const Matrix6d& covariance);

/// Whether a step is shorter than `factor` of an ICP's limits.
template <class IcpParams>
bool stepWithin(const Vector6d& step, const IcpParams& params, double factor) {
  return step.head<3>().norm() < factor * params.step_translation_m &&
         step.tail<3>().norm() < factor * params.step_rotation_deg * kDegree;
}

double rmsResidual(const NormalEquations& equations);

/// The end of an ICP after its last step, `covariance` being that of the solution: the status, and what an ICP that has
/// not converged adds. Where little is observed the step may stay large. Scattered residuals do not make it converge.
template <class IcpParams>
void judgeEnd(const IcpParams& params, bool converged, const Vector6d& step, double inflation, Measurement& result) {
  const bool usable = converged || stepWithin(step, params, params.relaxed_convergence_factor) ||
                      isWithinSigma(std::sqrt(inflation) * step, result.covariance);
  result.status = usable ? MeasurementStatus::kOk : MeasurementStatus::kNotConverged;
  if (!converged) result.covariance += step * step.transpose();
}

/// Applies dx to a pose: t + dt, Exp(dr) R.
Pose applyStep(const Pose& T_odom_cog, const Vector6d& dx);

}  // namespace fail_aware
