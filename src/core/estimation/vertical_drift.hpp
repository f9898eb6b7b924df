// What the vertical reference knows of the tilt, as covariance of height, roll and pitch (not in the paper).
//
// How fast the tilt of an odometry drifts depends on the head: the fewer beams meet the ground, the worse their errors
// average out, and the sparser the map of the first sweeps is. The vertical reference measures the result
// (preprocessing/vertical_reference.hpp): M, the mean square of the tilt since the start, what is not corrected
// included. An error of tilt lasts for tens of metres, so that the heights that it causes add up, not their squares:
//   d(sigma_z) = sqrt(v^T M v),  v = (step_y, -step_x)
// Horizontal parts of the covariance stay as they are: on level road a tilt moves the vehicle up or down only.
//
// Frame: odom's axes; m, rad. Failure: a matrix that is not finite is left out. Cost: negligible.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/pose.hpp"

namespace fail_aware {

class VerticalDrift {
 public:
  /// The vehicle moved by `step_odom`. tilt_moment: M of the newest sweep; none: as before.
  void advance(const Eigen::Vector3d& step_odom, const std::optional<Eigen::Matrix2d>& tilt_moment);

  /// A covariance, geometry/pose.hpp's convention, zero but for height, roll and pitch.
  Matrix6d covariance() const;

 private:
  Eigen::Matrix2d tilt_moment_ = Eigen::Matrix2d::Zero();
  double sigma_height_m_ = 0.0;
};

}  // namespace fail_aware
