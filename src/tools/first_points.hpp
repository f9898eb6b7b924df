// The first scan of a drive that has points: whether they look like a lidar's points in metres.
//
// Cost: one pass over one scan.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/preprocessing/registration_cloud.hpp"
#include "evaluation/quantile.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

class FirstPoints {
 public:
  explicit FirstPoints(const RegistrationCloudBuilder::Params& params) : params_(params) {}

  /// Call with each scan, before the odometry takes it. Returns what is wrong with the first that has points, for the
  /// user; empty: nothing, or it was looked at before.
  std::string look(const Sweep& sweep, const std::string& scan) {
    if (sweep.empty() || points_ > 0) return {};
    std::vector<double> ranges_m;
    for (const Eigen::Vector3f& point : sweep.points_lidar) ranges_m.push_back(static_cast<double>(point.norm()));
    const auto in_range = [&](double range_m) {
      return range_m >= params_.min_range_m && range_m <= params_.max_range_m;
    };
    scan_ = scan;
    points_ = ranges_m.size();
    in_range_ = static_cast<std::size_t>(std::count_if(ranges_m.begin(), ranges_m.end(), in_range));
    constexpr double kFarthest_m = 1000.0;  // the coordinates of a lidar's points are at most some hundred metres
    const double median_m = quantile(ranges_m, 0.5);
    if (!(median_m > kFarthest_m && median_m < 1e9)) return {};
    return "the median range of the first sweep's points is " + std::to_string(std::lround(median_m)) +
           " m, so their coordinates are probably in millimetres; metres are needed";
  }

  /// For a drive of which no scan could be used; begins with ": ". Empty: no scan has points.
  std::string whyUnusable() const {
    if (points_ == 0) return {};
    const std::string found = ": of the " + std::to_string(points_) + " points of " + scan_ + " " +
                              std::to_string(in_range_) + " are within registration.cloud.min_range_m and max_range_m";
    if (2 * in_range_ < points_) return found + "; a point must be x, y, z, intensity as float32, in m";
    return found +
           "; a sweep needs registration.cloud.min_points of them after thinning, and "
           "sensor.check.min_azimuth_coverage of the revolution";
  }

 private:
  RegistrationCloudBuilder::Params params_;
  std::string scan_;
  std::size_t points_ = 0, in_range_ = 0;
};

}  // namespace fail_aware
