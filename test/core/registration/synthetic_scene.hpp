// Made-up surroundings for the registration tests: rectangles, sampled at random with a lidar's noise.
// Frames: the scene in odom; the vehicle starts at its origin, z up, the ground at z = -0.5 m.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"

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
inline void addPost(Scene& scene, double x, double y, double width_m, double height_m) {
  const double h = 0.5 * width_m;
  scene.push_back(wall(x - h, y - h, x + h, y - h, height_m));
  scene.push_back(wall(x + h, y - h, x + h, y + h, height_m));
  scene.push_back(wall(x + h, y + h, x - h, y + h, height_m));
  scene.push_back(wall(x - h, y + h, x - h, y - h, height_m));
}

/// 24 m x 18 m, with a ledge and a pillar so that no half turn maps it onto itself.
inline Scene room() {
  Scene scene = {wall(-11.0, -8.0, 13.0, -8.0, 4.0), wall(13.0, -8.0, 13.0, 10.0, 4.0),
                 wall(13.0, 10.0, -11.0, 10.0, 4.0), wall(-11.0, 10.0, -11.0, -8.0, 4.0),
                 wall(5.0, 10.0, 5.0, 7.0, 3.0),     ground(-11.0, -8.0, 13.0, 10.0)};
  addPost(scene, -5.0, -4.0, 1.0, 4.0);
  return scene;
}

/// A street along x: facades on both sides with recesses every few metres (different left and right), ground.
inline Scene street() {
  Scene scene = {ground(-30.0, -9.0, 45.0, 9.0)};
  for (const double side : {-1.0, 1.0}) {
    double x = side > 0.0 ? -30.0 : -27.0;
    double y = 8.0;
    int k = side > 0.0 ? 0 : 1;
    while (x < 45.0) {
      const double length = 4.0 + 1.7 * (k % 4), next_y = 6.5 + 0.9 * ((2 * k) % 3);
      scene.push_back(wall(x, side * y, x + length, side * y, 5.0));
      scene.push_back(wall(x + length, side * y, x + length, side * next_y, 5.0));
      x += length;
      y = next_y;
      ++k;
    }
  }
  return scene;
}

/// Two walls and the ground along x, without an end in sight.
inline Scene corridor() {
  return {wall(-60.0, -4.0, 60.0, -4.0, 4.0), wall(-60.0, 4.0, 60.0, 4.0, 4.0), ground(-60.0, -4.0, 60.0, 4.0)};
}

/// Points on the scene's surfaces, sigma_m of noise on each coordinate.
inline std::vector<Eigen::Vector3d> sampleScene(const Scene& scene, double points_per_m2, double sigma_m,
                                                unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> along(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<Eigen::Vector3d> points;
  for (const Rectangle& r : scene) {
    const int count = static_cast<int>(std::ceil(points_per_m2 * r.side_u.norm() * r.side_v.norm()));
    for (int i = 0; i < count; ++i) {
      const double a = along(generator), b = along(generator);
      Eigen::Vector3d p = r.origin + a * r.side_u + b * r.side_v;
      for (int k = 0; k < 3; ++k) p[k] += sigma_m * noise(generator);
      points.push_back(p);
    }
  }
  return points;
}

/// The points within max_range_m of the vehicle, in its frame.
inline std::vector<Eigen::Vector3f> seenFrom(const std::vector<Eigen::Vector3d>& points_odom, const Pose& T_odom_cog,
                                             double max_range_m = 100.0) {
  std::vector<Eigen::Vector3f> points_cog;
  const Pose T_cog_odom = T_odom_cog.inverse();
  for (const Eigen::Vector3d& p : points_odom) {
    const Eigen::Vector3d q = T_cog_odom * p;
    if (q.norm() <= max_range_m) points_cog.push_back(q.cast<float>());
  }
  return points_cog;
}

inline Pose poseOf(double x, double y, double z, double roll_deg, double pitch_deg, double yaw_deg) {
  Vector6d state;
  state << x, y, z, roll_deg, pitch_deg, yaw_deg;
  state.tail<3>() *= kDegree;
  return poseFromVector(state);
}

inline double translationError(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

inline double rotationErrorDeg(const Pose& a, const Pose& b) {
  return logSo3(a.linear().transpose() * b.linear()).norm() / kDegree;
}

}  // namespace fail_aware
