// Poses and 6x6 covariances <-> geometry_msgs. Covariances are row-major in messages and keep their convention.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>

#include <boost/array.hpp>
#include <optional>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

using CovarianceMessage = boost::array<double, 36>;

/// w >= 0, so that equal rotations give equal messages.
geometry_msgs::Pose toPoseMessage(const Pose& T);
geometry_msgs::Transform toTransformMessage(const Pose& T);

/// Nothing if a number is not finite or the quaternion's norm is off by more than 1e-3; otherwise normalized.
std::optional<Pose> fromMessage(const geometry_msgs::Pose& message);
std::optional<Pose> fromMessage(const geometry_msgs::Transform& message);

CovarianceMessage toCovarianceMessage(const Matrix6d& covariance);
Matrix6d fromMessage(const CovarianceMessage& message);

}  // namespace fail_aware
