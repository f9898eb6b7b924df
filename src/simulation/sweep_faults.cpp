#include "simulation/sweep_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "simulation/random.hpp"

namespace fail_aware {

namespace {

template <class T>
void moveTo(std::vector<T>& values, std::size_t from, std::size_t to) {
  if (!values.empty()) values[to] = values[from];
}

void resize(Sweep& sweep, std::size_t size) {
  sweep.points_lidar.resize(size);
  if (!sweep.intensities.empty()) sweep.intensities.resize(size);
  if (!sweep.times_s.empty()) sweep.times_s.resize(size);
  if (!sweep.rings.empty()) sweep.rings.resize(size);
}

/// Keeps the points for which keep(index) is true, in order.
template <class Keep>
void filter(Sweep& sweep, Keep&& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (!keep(i)) continue;
    moveTo(sweep.points_lidar, i, kept);
    moveTo(sweep.intensities, i, kept);
    moveTo(sweep.times_s, i, kept);
    moveTo(sweep.rings, i, kept);
    ++kept;
  }
  resize(sweep, kept);
}

}  // namespace

void blankSector(Sweep& sweep, double width_deg) {
  const double half_rad = 0.5 * width_deg * kDegree;
  filter(sweep, [&](std::size_t i) {
    const Eigen::Vector3f& p = sweep.points_lidar[i];
    return std::abs(std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x()))) > half_rad;
  });
}

void loseRings(Sweep& sweep, double share, std::uint64_t key) {
  filter(sweep, [&](std::size_t i) {
    return sweep.rings.empty() || uniformFromBits(combineKeys(key, 71, sweep.rings[i])) >= share;
  });
}

void capRange(Sweep& sweep, double range_m) {
  const auto limit = static_cast<float>(range_m * range_m);
  filter(sweep, [&](std::size_t i) { return sweep.points_lidar[i].squaredNorm() <= limit; });
}

void addNoise(Sweep& sweep, double sigma_m, std::uint64_t key) {
  const auto sigma = static_cast<float>(sigma_m);
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      sweep.points_lidar[i][axis] += sigma * normalFromBits(combineKeys(key, 72, i, static_cast<std::uint64_t>(axis)));
    }
  }
}

void addGhosts(Sweep& sweep, double share, std::uint64_t key) {
  const std::size_t size = sweep.size();
  if (size == 0) return;
  const auto ghosts = static_cast<std::size_t>(share * static_cast<double>(size));
  RandomStream random(combineKeys(key, 73));
  for (std::size_t g = 0; g < ghosts; ++g) {
    const std::size_t i = std::min(size - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(size)));
    const Eigen::Vector3f true_point = sweep.points_lidar[i];
    sweep.points_lidar.push_back(static_cast<float>(random.uniform(0.1, 0.95)) * true_point);
    if (!sweep.intensities.empty()) sweep.intensities.push_back(0.05f);
    if (!sweep.times_s.empty()) sweep.times_s.push_back(sweep.times_s[i]);
    if (!sweep.rings.empty()) sweep.rings.push_back(sweep.rings[i]);
  }
}

void cutShort(Sweep& sweep, double share) {
  resize(sweep, static_cast<std::size_t>(share * static_cast<double>(sweep.size())));
}

void tiltMount(Sweep& sweep, double angle_deg) {
  const double angle = angle_deg * kDegree;
  // the sensor turns by R, so its points turn by R^-1
  const Eigen::Matrix3f R = rotationFromRpy(0.5 * angle, angle, 0.0).transpose().cast<float>();
  for (Eigen::Vector3f& p : sweep.points_lidar) p = R * p;
}

void makeEmpty(Sweep& sweep) { resize(sweep, 0); }

void makeNan(Sweep& sweep, double share, std::uint64_t key) {
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (uniformFromBits(combineKeys(key, 74, i)) < share) {
      sweep.points_lidar[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
}

}  // namespace fail_aware
