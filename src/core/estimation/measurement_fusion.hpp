// Fuses the measurements of one sweep into one (paper, section "Fusion Algorithm").
//
// Inputs: the filter's predicted state (x y z roll pitch yaw of the CoG in odom; m, rad), its covariance P~ (of that
// state vector), and any number of measurements (pose and covariance in geometry/pose.hpp's convention, converted here
// to the state vector's). All outputs are of the state vector.
//
// literal (the article): d_i = sqrt(dx^2/sxx^2 + dy^2/syy^2) with gate_sigma times the sigmas of P~, w_i = |d_i - 1|
// for d_i <= 1, else 0; z = x~ + sum w_i (z_i - x~) / sum w_i; R = diag(sum w_i R_i / sum w_i).
// default: d_i is the Mahalanobis distance under P~_xy + R_i,xy and w_i = 1 - d_i / gate_sigma. With v_i = w_i / sum w:
//   R = (sum v_i R_i^-1)^-1,  z = R sum v_i R_i^-1 z_i     (covariance intersection)
// Since sum v_i = 1, measurements that share a sweep's errors do not shrink R, and a direction that a measurement does
// not observe (huge variance) is left to the others. One whose standard deviations are all a hundred times those of
// another gets no weight: it would only make R larger. Where two or more measurements outside their gates agree
// with each other, and with the fewer that are inside, the prediction is what is wrong: the largest group that agrees
// is fused with equal weights, flagged.
//
// Disagreement. A measurement outside its gate is not fused. It is outvoted, and its disagreement does not count, if
// the fused measurements outnumber it together with the other gated-out ones within agreement_distance_m of it. A
// measurement inside its gate that is outnumbered in this way by those of greater weight counts by its weight. A
// distance within 3 sigma of both covariances does not count if both measurements are precise: their sigmas together
// within agreement_distance_m. An input with a very large sigma cannot confirm another one. A disagreement with an
// external one does not count while its covariance explains the distance.
//
// Partial measurements (FusionInput::Kind::kPartial) come after the others: inside their gate (the distance to the
// prediction under P~ + R) each adds its whole information to R and z. Without another measurement they are not used.
// They share the sweep's points and deskew with the registrations, so they neither confirm nor contradict any.
// Motions (FusionInput::Kind::kMotion) come before the others: fuseMotion() compares them with the prediction under
// Q + R, and the filter corrects its last step by them (Ukf::correctMotion).
//
// Failure: `has_measurement` false (nothing usable, all gated out, prediction unusable); z, R are then the prediction
// (zero and identity where that is unusable).
// Measurements that are ok but not finite, not a covariance or at gimbal lock are ignored and counted.
// Cost: O(n) 6x6 eigendecompositions, about 15 us for three inputs.
#pragma once

#include <vector>

#include "core/estimation/measurement_agreement.hpp"
#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/types/fusion_input.hpp"
#include "core/types/fusion_result.hpp"

namespace fail_aware {

inline constexpr double kFarthestOff_m = 1e5;  ///< from the prediction: a car is no farther off after an hour

struct MeasurementFusion {
  bool literal = false;               ///< the article's formula
  double gate_sigma = 3.0;            ///< semi-axes of the gate's ellipse in standard deviations (article: 1)
  double min_weight = 0.01;           ///< default formula: less than this counts as outside the gate
  double agreement_distance_m = 0.2;  ///< default formula: two measurements agree within this, widened by their R
  double agreement_yaw_deg = 1.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("literal", self.literal);
    v("gate_sigma", self.gate_sigma, requirePositive);
    v("min_weight", self.min_weight);
    v("agreement_distance_m", self.agreement_distance_m, requireNotNegative);
    v("agreement_yaw_deg", self.agreement_yaw_deg, within(0.0, 180.0));
  }
  void checkRules() const;

  /// Of the inputs of kind kMotion only: `motion`, with their weights. Q: of the motion that was predicted.
  FusionResult fuseMotion(const Vector6d& predicted_state, const Matrix6d& Q,
                          const std::vector<FusionInput>& inputs) const;

  /// Of all other inputs. `result`: fuseMotion's, after which state and P were corrected.
  FusionResult fuse(const Vector6d& predicted_state, const Matrix6d& predicted_P,
                    const std::vector<FusionInput>& inputs, FusionResult result = FusionResult()) const;
};

}  // namespace fail_aware
