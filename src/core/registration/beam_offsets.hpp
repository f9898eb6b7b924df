// One unknown offset per beam of the head, each with its own Kalman filter (not in the paper).
//
// A sweep's residuals against the map show how the beams differ. They do not show what all beams have in common: the
// map is made of the same beams and errs alike. So the patterns over the beams that the map shares are taken out of
// each observation, and a part of what is known is forgotten with each one, so that these patterns do not grow
// unobserved. Units: those of the offset; residuals in m, sensitivities in m per unit of the offset.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fail_aware {

/// Sums over a beam's points in one sweep, weighted.
struct BeamEvidence {
  double residual = 0.0;     ///< of sensitivity times residual
  double information = 0.0;  ///< of sensitivity squared
  double range_m = 0.0;      ///< of ranges
  double weight = 0.0;       ///< of weights

  void add(double point_weight, double sensitivity, double residual_m, double point_range_m) {
    residual += point_weight * sensitivity * residual_m;
    information += point_weight * sensitivity * sensitivity;
    range_m += point_weight * point_range_m;
    weight += point_weight;
  }
};

class BeamOffsets {
 public:
  struct Params {
    double sigma = 0.03;  ///< initial sigma of an offset: what a calibration of the head leaves
    double walk = 0.002;  ///< its change from sweep to sweep: a wrong offset is corrected; heads hold theirs for months
    double residual_m = 0.1;  ///< sigma of one point's residual: noise, roughness, the errors of the map
    double forget = 0.05;     ///< ratio of the offset that is forgotten at each observation
    double limit = 0.2;       ///< a head that is off by more is broken
  };

  explicit BeamOffsets(const Params& params) : params_(params) {}

  /// By ring; empty: nothing is known.
  const std::vector<float>& values() const { return values_; }

  /// evidence: by ring. shared: the patterns, a row for each ring, a column for each pattern; rows of rings without
  /// information do not count.
  void update(const std::vector<BeamEvidence>& evidence, const Eigen::MatrixXd& shared);

  void reset() { *this = BeamOffsets(params_); }

 private:
  Params params_;
  std::vector<float> values_;
  std::vector<double> variances_;
};

}  // namespace fail_aware
