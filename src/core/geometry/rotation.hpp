// Rotations: roll-pitch-yaw, rotation vectors, angle wrapping.
//
// Convention everywhere in this package (REP-103): R = Rz(yaw) Ry(pitch) Rx(roll), radians, which is roll, pitch and
// yaw about the fixed axes x, y, z in that order.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fail_aware {

/// Wraps an angle to [-pi, pi). Returns a value that is not finite unchanged.
double wrapAngle(double angle_rad);

Eigen::Matrix3d rotationFromRpy(double roll_rad, double pitch_rad, double yaw_rad);

/// (roll, pitch, yaw) of a rotation matrix; at gimbal lock (|pitch| = pi/2) roll is 0.
Eigen::Vector3d rpyFromRotation(const Eigen::Matrix3d& R);

/// w -> [w]x with [w]x v = w x v.
Eigen::Matrix3d skew(const Eigen::Vector3d& w);

/// Rotation vector (rad) -> rotation matrix (Rodrigues), and back; the vector's norm is in [0, pi].
Eigen::Matrix3d expSo3(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d logSo3(const Eigen::Matrix3d& R);

/// J with: (small rotation vector about the fixed axes) = J * d(roll, pitch, yaw).
Eigen::Matrix3d fixedAxisFromRpyRates(const Eigen::Vector3d& rpy_rad);

}  // namespace fail_aware
