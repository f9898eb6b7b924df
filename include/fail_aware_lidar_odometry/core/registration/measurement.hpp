// What every measurement algorithm returns (paper, section "Measurements Algorithms and Data Fusion").
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"

namespace fail_aware {

/// The three algorithms' names as sources of the fusion: in topics, messages, parameters and files.
inline constexpr const char* kIcpPointToPoint = "icp_point_to_point";
inline constexpr const char* kIcpPointToPlane = "icp_point_to_plane";
inline constexpr const char* kCornerSvd = "corner_svd";

enum class MeasurementStatus {
  kOk,            ///< pose and covariance may be used
  kNoReference,   ///< nothing to register against yet (first sweep, after a reset)
  kTooFewPoints,  ///< the sweep or its overlap with the reference is too small
  kNotConverged,  ///< the iteration limit came before the step limit, or the way is lost after a gap
  kDegenerate,    ///< no direction was observable; corners too close to each other; no finite prediction
  kTooFewCorners  ///< corner alignment only: fewer than the required associated corners
};

const char* toString(MeasurementStatus status);

/// A pose of the vehicle's centre of gravity in odom, at the sweep's stamp. Failure is data: `status`.
struct Measurement {
  MeasurementStatus status = MeasurementStatus::kNoReference;
  Pose T_odom_cog = Pose::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< geometry/pose.hpp's convention, m and rad, about odom's axes
  double rms_residual_m = 0.0;                 ///< of the inliers, at the solution
  double inlier_share = 0.0;                   ///< of the points used
  std::size_t inliers = 0;
  int iterations = 0;
  double seed_spread_m = 0.0;  ///< multiplex ICP: RMS distance between the seeds' results; 0 elsewhere
  int weak_directions = 0;     ///< directions left at the prediction, of 6
  /// Of the information, in the weakest horizontal direction: ICPs: share of all the weight, 0.5 if both directions are
  /// seen alike; corners: against `good_corners` of them. 0: not known.
  double min_information_share = 0.0;
  bool interval_doubted = false;  ///< found by the way of another interval than the stamps': tells no speed

  bool ok() const { return status == MeasurementStatus::kOk; }
};

}  // namespace fail_aware
