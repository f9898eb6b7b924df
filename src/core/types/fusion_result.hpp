// The fused measurement of one sweep, with the weight, NIS and agreement of its inputs
// (estimation/measurement_fusion.hpp). State vector: (x, y, z, roll, pitch, yaw) of the centre of gravity in odom; m,
// rad.
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// What the inputs of kind kMotion measured: the state, if the last estimate is right, with its covariance.
struct MotionMeasurement {
  Vector6d z = Vector6d::Zero();
  Matrix6d R = Matrix6d::Identity();
};

struct FusionResult {
  bool has_measurement = false;
  Vector6d z = Vector6d::Zero();            ///< the fused state
  Matrix6d R = Matrix6d::Identity();        ///< covariance of z
  std::optional<MotionMeasurement> motion;  ///< has corrected the prediction; not part of z
  std::vector<double> weights;              ///< per input, 0..1 before normalisation; 0: gated out or absent
  /// Per input, against P~ + R_i (a motion: Q + R_i), 6 degrees of freedom; -1: absent.
  std::vector<double> nis;
  /// Per input: the distance in standard deviations at which the gate refused it (horizontal; of an external pose the
  /// largest of this, height and yaw); infinity: it is ok(), but not usable; 0: neither.
  std::vector<double> refused_sigmas;
  bool all_gated_out = false;  ///< there were usable measurements, but none within the gate
  /// A group that agrees was used though most of it was outside the gate, or a measurement that contradicts the
  /// prediction.
  bool prediction_overruled = false;
  bool prediction_invalid = false;  ///< predicted state or covariance is not usable
  double disagreement_m = 0.0;      ///< largest horizontal distance between two usable measurements
  double disagreement_yaw_rad = 0.0;
  /// Like disagreement_m, for unexpected disagreements only; an outnumbered input's disagreement counts times its
  /// weight.
  double undecided_m = 0.0;
  /// two inputs agree within agreement_distance_m, and no input disagrees except outvoted ones
  bool confirmed = false;
  int valid_inputs = 0;
  int invalid_inputs = 0;  ///< ok(), but not usable or beyond kFarthestOff_m
};

}  // namespace fail_aware
