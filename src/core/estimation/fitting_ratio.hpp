// Which part of the scenery fits the map, from the inliers of the point-to-plane ICP. Not in the paper.
//
// The inlier ratio alone is not the answer: rain, spray and dust add points that fit nothing, and lower the ratio
// although the scenery fits as before. So a sweep that has more points than usual counts as one of the usual number.
// Failure: none. Cost: under 1 us a sweep.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/moving_median.hpp"

namespace fail_aware {

class FittingRatio {
 public:
  /// `inlier_ratio` and `inliers`: of the sweep's points. Returns the part of the scenery that fits, 0 to 1.
  double add(double inlier_ratio, std::size_t inliers) {
    if (!(inlier_ratio > 0.0) || inliers == 0) return inlier_ratio;
    const auto fitting = static_cast<double>(inliers);
    const double points = fitting / inlier_ratio;
    if (inlier_ratio >= kMostFit) usual_points_.add(points);
    const bool more_than_usual = usual_points_.isFull() && points > usual_points_.median();
    return more_than_usual ? std::min(1.0, fitting / usual_points_.median()) : inlier_ratio;
  }

  void clear() { usual_points_.clear(); }

 private:
  static constexpr double kMostFit = 0.5;  // such a sweep shows little else than the scenery
  MovingMedian usual_points_{20};
};

}  // namespace fail_aware
