// The pose that a measurement algorithm finds for one sweep (paper, section "Measurements Algorithms and Data Fusion").
#pragma once

#include <cstddef>

#include "core/geometry/pose.hpp"
#include "core/types/information_ahead.hpp"

namespace fail_aware {

/// The three algorithms' names as sources of the fusion: used in topics, messages, parameters and files.
inline constexpr const char* kIcpPointToPoint = "icp_point_to_point";
inline constexpr const char* kIcpPointToPlane = "icp_point_to_plane";
inline constexpr const char* kCornerSvd = "corner_svd";
/// The partial measurements (types/fusion_input.hpp), which observe some directions only.
inline constexpr const char* kRoadProfile = "road_profile";
inline constexpr const char* kAboveGround = "above_ground";

/// The variance of a direction that a partial measurement does not observe: 100 m, 100 rad.
inline constexpr double kUnobservedVariance = 1e4;

enum class MeasurementStatus {
  kOk,            ///< pose and covariance may be used
  kNoReference,   ///< nothing to register against yet (first sweep, or after a reset)
  kTooFewPoints,  ///< the sweep or its overlap with the reference is too small
  kNotConverged,  ///< iteration limit before step limit, or tracking is lost after a gap
  kDegenerate,    ///< no direction was observable; corners too close to each other; prediction not finite
  kTooFewCorners  ///< corner alignment only: fewer than the required associated corners
};

const char* toString(MeasurementStatus status);

/// A pose of the vehicle's centre of gravity in odom, at the sweep's stamp. Failure is data: `status`.
struct Measurement {
  MeasurementStatus status = MeasurementStatus::kNoReference;
  Pose T_odom_cog = Pose::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< geometry/pose.hpp's convention, m and rad, about odom's axes
  double rms_residual_m = 0.0;                 ///< of the inliers, at the solution
  double inlier_ratio = 0.0;                   ///< of the points used
  std::size_t inliers = 0;
  int iterations = 0;
  double seed_spread_m = 0.0;     ///< multiplex ICP: RMS distance between the seeds' results; 0 elsewhere
  int degenerate_directions = 0;  ///< directions left at the prediction, of 6
  /// Information in the weakest horizontal direction. ICPs: ratio of the total weight, 0.5 if both directions are
  /// observed equally well. Corners: relative to `good_corners` corners. 0: not known.
  double min_information_ratio = 0.0;
  InformationAhead ahead{};           ///< point-to-plane ICP; otherwise not known
  bool clock_jump_suspected = false;  ///< registered assuming a clock jump: the speed is unusable

  bool ok() const { return status == MeasurementStatus::kOk; }
};

}  // namespace fail_aware
