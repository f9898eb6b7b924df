// Made-up surroundings for the registration tests: rectangles, sampled at random with a lidar's noise.
// Frames: the scene in odom; the vehicle starts at its origin, z up, the ground at z = -0.5 m.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// origin + a side_u + b side_v, a and b in [0, 1]; m.
struct Rectangle {
  Eigen::Vector3d origin, side_u, side_v;
};

using Scene = std::vector<Rectangle>;

inline constexpr double kGround_m = -0.5;

inline Rectangle wall(double x0, double y0, double x1, double y1, double height_m) {
  return {{x0, y0, kGround_m}, {x1 - x0, y1 - y0, 0.0}, {0.0, 0.0, height_m}};
}

inline Rectangle ground(double x0, double y0, double x1, double y1) {
  return {{x0, y0, kGround_m}, {x1 - x0, 0.0, 0.0}, {0.0, y1 - y0, 0.0}};
}

/// The four sides of an upright square post.
void addPost(Scene& scene, double x, double y, double width_m, double height_m);

/// 24 m x 18 m, with a ledge and a pillar so that no half turn maps it onto itself.
Scene room();

/// A street along x: facades on both sides with recesses every few metres (different left and right), ground.
Scene street();

/// Two walls and the ground along x, without an end in sight.
Scene corridor();

/// Points on the scene's surfaces, sigma_m of noise on each coordinate.
std::vector<Eigen::Vector3d> sampleScene(const Scene& scene, double points_per_m2, double sigma_m, unsigned seed);

/// The points within max_range_m of the vehicle, in its frame.
std::vector<Eigen::Vector3f> seenFrom(const std::vector<Eigen::Vector3d>& points_odom, const Pose& T_odom_cog,
                                      double max_range_m = 100.0);

Pose poseOf(double x, double y, double z, double roll_deg, double pitch_deg, double yaw_deg);

double translationError(const Pose& a, const Pose& b);

double rotationErrorDeg(const Pose& a, const Pose& b);

}  // namespace fail_aware
