#include "synthetic_scene.hpp"

#include <cmath>
#include <random>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware {

void addPost(Scene& scene, double x, double y, double width_m, double height_m) {
  const double h = 0.5 * width_m;
  scene.push_back(wall(x - h, y - h, x + h, y - h, height_m));
  scene.push_back(wall(x + h, y - h, x + h, y + h, height_m));
  scene.push_back(wall(x + h, y + h, x - h, y + h, height_m));
  scene.push_back(wall(x - h, y + h, x - h, y - h, height_m));
}

Scene room() {
  Scene scene = {wall(-11.0, -8.0, 13.0, -8.0, 4.0), wall(13.0, -8.0, 13.0, 10.0, 4.0),
                 wall(13.0, 10.0, -11.0, 10.0, 4.0), wall(-11.0, 10.0, -11.0, -8.0, 4.0),
                 wall(5.0, 10.0, 5.0, 7.0, 3.0),     ground(-11.0, -8.0, 13.0, 10.0)};
  addPost(scene, -5.0, -4.0, 1.0, 4.0);
  return scene;
}

Scene street() {
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

Scene corridor() {
  return {wall(-60.0, -4.0, 60.0, -4.0, 4.0), wall(-60.0, 4.0, 60.0, 4.0, 4.0), ground(-60.0, -4.0, 60.0, 4.0)};
}

std::vector<Eigen::Vector3d> sampleScene(const Scene& scene, double points_per_m2, double sigma_m, unsigned seed) {
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

std::vector<Eigen::Vector3f> seenFrom(const std::vector<Eigen::Vector3d>& points_odom, const Pose& T_odom_cog,
                                      double max_range_m) {
  std::vector<Eigen::Vector3f> points_cog;
  const Pose T_cog_odom = T_odom_cog.inverse();
  for (const Eigen::Vector3d& p : points_odom) {
    const Eigen::Vector3d q = T_cog_odom * p;
    if (q.norm() <= max_range_m) points_cog.push_back(q.cast<float>());
  }
  return points_cog;
}

Pose poseOf(double x, double y, double z, double roll_deg, double pitch_deg, double yaw_deg) {
  Vector6d state;
  state << x, y, z, roll_deg, pitch_deg, yaw_deg;
  state.tail<3>() *= kDegree;
  return poseFromVector(state);
}

double translationError(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

double rotationErrorDeg(const Pose& a, const Pose& b) {
  return logSo3(a.linear().transpose() * b.linear()).norm() / kDegree;
}

}  // namespace fail_aware
