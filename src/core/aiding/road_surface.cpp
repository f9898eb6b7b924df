#include "core/aiding/road_surface.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "core/geometry/degree.hpp"
#include "core/robust_kernel.hpp"

namespace fail_aware {

namespace {

constexpr double kNearest_m = 3.0;      // horizontal, from the lidar: nearer points belong to the vehicle
constexpr double kBelowLidar_m = 0.5;   // the road is at least this far below the lidar
constexpr double kRangeNoise_m = 0.02;  // only its ratio to the profile's height matters
constexpr std::size_t kMinSamples = 1000;
// Size of the bins for the mean: a fraction of the beams' spacing, and 0.14 m at kRoadRange_m, less than a cell.
constexpr double kElevationBin_deg = 0.1, kAzimuthBin_deg = 0.5;

struct RoadPoint {
  Eigen::Vector3d p;  // axes of the vehicle, origin at the lidar
  std::size_t index;
};

Vector6d quadric(double x, double y) {
  Vector6d row;
  row << 1.0, x, y, x * x, x * y, y * y;
  return row;
}

// Fits z = q(x, y) robustly around the most common height.
Vector6d fitRoad(const std::vector<RoadPoint>& points) {
  constexpr double kBin_m = 0.1;
  constexpr int kBins = 60;
  std::array<int, kBins> histogram{};
  for (const RoadPoint& point : points) {
    const int bin = static_cast<int>(-point.p.z() / kBin_m);
    if (bin >= 0 && bin < kBins) ++histogram[static_cast<std::size_t>(bin)];
  }
  const auto mode = std::max_element(histogram.begin(), histogram.end()) - histogram.begin();
  Vector6d coefficients = Vector6d::Zero();
  coefficients[0] = -(static_cast<double>(mode) + 0.5) * kBin_m;
  const std::size_t stride = 1 + points.size() / 5000;
  for (const double scale_m : {0.3, 0.15, 0.06, 0.03}) {
    Matrix6d H = 1e-9 * Matrix6d::Identity();
    Vector6d b = Vector6d::Zero();
    for (std::size_t i = 0; i < points.size(); i += stride) {
      const Vector6d row = quadric(points[i].p.x(), points[i].p.y());
      const double e = points[i].p.z() - row.dot(coefficients);
      const double weight = gemanMcClureWeight(e * e, scale_m * scale_m);
      H += weight * row * row.transpose();
      b += weight * e * row;
    }
    coefficients += H.ldlt().solve(b);
  }
  return coefficients;
}

std::vector<RoadPoint> roadPoints(const CorrectedSweep& sweep, const Pose& T_cog_lidar) {
  std::vector<RoadPoint> points;
  const Eigen::Matrix3f R = T_cog_lidar.linear().cast<float>();
  const auto min2 = static_cast<float>(kNearest_m * kNearest_m);
  const auto max2 = static_cast<float>(kRoadRange_m * kRoadRange_m);
  for (std::size_t i = 0; i < sweep.points_lidar.size(); ++i) {
    const Eigen::Vector3f p = R * sweep.points_lidar[i];
    const float range2 = p.head<2>().squaredNorm();
    if (range2 < min2 || range2 > max2 || std::abs(p.y()) > static_cast<float>(kRoadHalfWidth_m) ||
        p.z() > -static_cast<float>(kBelowLidar_m)) {
      continue;
    }
    points.push_back({p.cast<double>(), i});
  }
  return points;
}

// Points in one direction from the sensor, at the sensor's position when it fired.
struct Direction {
  double x = 0.0, y = 0.0, time_s = 0.0, height = 0.0;
  int count = 0;
};

}  // namespace

std::optional<std::vector<RoadSample>> sampleRoad(const CorrectedSweep& sweep, const Pose& T_cog_lidar,
                                                  const Vector6d& twist_cog) {
  const std::vector<RoadPoint> points = roadPoints(sweep, T_cog_lidar);
  if (points.size() < kMinSamples) return std::nullopt;
  const Vector6d road = fitRoad(points);
  std::unordered_map<VoxelKey, Direction, VoxelHash> bins;
  const Eigen::Matrix3d R_lidar_cog = T_cog_lidar.linear().transpose();
  for (const RoadPoint& point : points) {
    const double height = point.p.z() - quadric(point.p.x(), point.p.y()).dot(road);
    if (std::abs(height) > 5.0 * kRoadHeight_m) continue;
    const double time_s = sweep.times_s.empty() ? 0.0 : static_cast<double>(sweep.times_s[point.index]);
    const Eigen::Vector3d p_cog = point.p + T_cog_lidar.translation();
    const Eigen::Vector3d moved = time_s * (twist_cog.head<3>() + twist_cog.tail<3>().cross(p_cog));
    const Eigen::Vector3d ray = R_lidar_cog * (point.p - moved);
    const double elevation_deg = std::atan2(ray.z(), ray.head<2>().norm()) / kDegree;
    const double azimuth_deg = std::atan2(ray.y(), ray.x()) / kDegree;
    Direction& bin = bins[packVoxel(fastFloor(elevation_deg / kElevationBin_deg + 0.5),
                                    fastFloor(azimuth_deg / kAzimuthBin_deg), 0)];
    bin.x += point.p.x();
    bin.y += point.p.y();
    bin.time_s += time_s;
    bin.height += height;
    ++bin.count;
  }
  std::vector<RoadSample> samples;
  samples.reserve(bins.size());
  for (const auto& [direction, bin] : bins) {
    const double n = bin.count, x = bin.x / n, y = bin.y / n;
    // a range error e lifts a point by e * height / range
    const double sigma_m = kRangeNoise_m * std::abs(road[0]) / std::hypot(x, y);
    samples.push_back({direction, static_cast<float>(x), static_cast<float>(y), static_cast<float>(bin.time_s / n),
                       static_cast<float>(bin.height / n), static_cast<float>(n / (sigma_m * sigma_m))});
  }
  return samples;
}

}  // namespace fail_aware
