// Poses, their tangent space and their covariances.
//
// Naming: T_a_b maps points given in frame b into frame a (p_a = T_a_b p_b).
//
// Covariance convention (that of nav_msgs/Odometry): order x y z, rotation about the fixed axes x y z of the parent
// frame; the true pose is (t + dt, Exp(dr) R) with (dt, dr) ~ N(0, C). Units m and rad.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Exponential and logarithm of SE(3); twist = (translation part, rotation part), in the body frame: T Exp(twist).
Pose expSe3(const Vector6d& twist);
Vector6d logSe3(const Pose& T);

/// State vector (x, y, z, roll, pitch, yaw) <-> pose.
Pose poseFromVector(const Vector6d& x_y_z_roll_pitch_yaw);
Vector6d vectorFromPose(const Pose& T);

/// The state vector with its angles wrapped; sum and difference of state vectors, likewise.
Vector6d wrapAngles(const Vector6d& state);
Vector6d stateSum(const Vector6d& a, const Vector6d& b);
Vector6d stateDifference(const Vector6d& a, const Vector6d& b);

/// J with (dt, dr about fixed axes) = J d(x, y, z, roll, pitch, yaw), at the given angles.
Matrix6d poseFromStateJacobian(const Eigen::Vector3d& rpy_rad);

/// Converts a covariance of (x, y, z, roll, pitch, yaw), at that state, to this file's convention.
Matrix6d poseCovarianceFromState(const Matrix6d& state_covariance, const Vector6d& state);

/// Covariance of T_a_c = T_a_b T_b_c where only T_a_b is uncertain (covariance_ab in this file's convention).
Matrix6d covarianceAfterOffset(const Matrix6d& covariance_ab, const Pose& T_a_b, const Pose& T_b_c);

/// Rotates a covariance into another frame of axes: blockdiag(R, R) C blockdiag(R, R)^T.
Matrix6d rotateCovariance(const Matrix6d& covariance, const Eigen::Matrix3d& R);

/// The (x, y, yaw) block of a pose's covariance; its other elements stay.
Eigen::Matrix3d horizontalBlock(const Matrix6d& covariance);
void setHorizontalBlock(const Eigen::Matrix3d& block, Matrix6d& covariance);

/// The same standard deviation along all axes, another about all axes.
Matrix6d isotropicCovariance(double sigma_m, double sigma_rad);

/// The pose with the nearest rotation matrix, so that products of thousands of poses stay rigid.
Pose orthonormalized(const Pose& T);

bool isFinite(const Pose& T);

/// The unit quaternion of T's rotation, w >= 0, as in messages.
Eigen::Quaterniond quaternionOf(const Pose& T);
/// From position and quaternion; the quaternion is normalized here.
Pose poseOf(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation);
/// T as it comes out of a message, bit for bit: offline and live stages then pass on the same poses.
Pose quaternionRoundTrip(const Pose& T);

}  // namespace fail_aware
