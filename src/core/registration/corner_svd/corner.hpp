// A corner of the scene: two vertical planes that meet, and its three synthetic points (paper, section "SVD Cornering
// Algorithm", Synthetic Points Evaluation).
//
// M and J lie on the line where the planes meet, 0.5 m apart. N is 1 m from M, at M's height, in the plane that is
// closer to odom's x axis, towards growing x. N is therefore the same point in every sweep while the predicted yaw is
// good to some degrees. A line has no height: M's position on it is a convention. Before two corners are compared, one
// is moved along its line to the height of the other (`atHeight`).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct Corner {
  static constexpr double kLineLength = 0.5;   ///< |J - M|, m
  static constexpr double kPlaneLength = 1.0;  ///< |N - M|, m

  Eigen::Vector3d M = Eigen::Vector3d::Zero();
  Eigen::Vector3d J = Eigen::Vector3d::Zero();  ///< above M
  Eigen::Vector3d N = Eigen::Vector3d::Zero();
  /// Bounding rectangle of a plane's inliers when last seen: opposite vertices; sides along the line and across it.
  struct Rectangle {
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    Eigen::Vector3d high = Eigen::Vector3d::Zero();
  };
  struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, towards the sensor
    double rms_m = 0.0;                                ///< of the RANSAC inliers
    int points = 0;                                    ///< RANSAC inliers
    Rectangle rectangle;                               ///< display only
  };
  std::array<Plane, 2> planes;  ///< the first one is N's

  int sightings = 1;      ///< in the reference (corner_reference.hpp)
  int sweeps_unseen = 0;  ///< likewise
  int points() const { return planes[0].points + planes[1].points; }

  Eigen::Vector3d lineDirection() const { return (J - M).normalized(); }
};

/// The corner in another frame: p_a = T_a_b p_b.
Corner movedCorner(const Pose& T_a_b, const Corner& corner_b);
std::vector<Corner> movedCorners(const Pose& T_a_b, const std::vector<Corner>& corners_b);

/// Moves the corner along its line so that M.z() = z_odom_m. The corner is in odom (z up).
Corner atHeight(const Corner& corner_odom, double z_odom_m);

/// The same corner with N in its other plane. The corner is in odom.
Corner withOtherPlane(const Corner& corner_odom);

struct CornerPair {
  std::size_t first;   ///< index into the corners
  std::size_t second;  ///< index into the others
  Corner corner;       ///< the first, at the height of the second, with N in the same plane
};

/// Mutually nearest corners, both in odom: M within `distance_m` at equal height and both normals within `angle_deg`.
std::vector<CornerPair> matchCorners(const std::vector<Corner>& corners_odom, const std::vector<Corner>& others_odom,
                                     double distance_m, double angle_deg);

}  // namespace fail_aware
