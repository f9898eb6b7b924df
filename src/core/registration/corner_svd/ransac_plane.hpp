// The vertical plane with the most inliers among points, by RANSAC and least squares (paper, section "SVD Cornering
// Algorithm", Corner Detection).
//
// A hypothesis is the vertical plane through two points that differ horizontally. It is scored on a random part of the
// points (the paper's "quarter of the total points") by truncated squared distances. The best hypothesis is refined by
// total least squares in 3-D on the inliers among all points; the refined plane may tilt by up to `max_tilt_deg`. Two
// points instead of three, because walls are vertical: the draws needed depend on the inlier ratio squared, not cubed.
// If the "quarter" were the size of each hypothesis' fit, the fit would average both walls of a corner; so it is not.
//
// Input: points in m.
// Failure: `found` is false (too few points, too few inliers, tilted).
// Cost: iterations x scored points x 0.25 ns, plus a few passes over all points.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/parameters/check.hpp"

namespace fail_aware {

struct RansacPlane {
  struct Params {
    int iterations = 500;            ///< most hypotheses: enough for `confidence` down to an inlier ratio of 0.12
    bool stop_early = true;          ///< stop when `confidence` is reached; false: always all iterations (paper)
    double confidence = 0.999;       ///< probability that one hypothesis had only inliers
    double inlier_distance_m = 0.1;  ///< distance of inliers from the plane: three sigma of range noise
    /// ratio of the points that hypotheses are drawn from and scored on: the paper's quarter
    double sample_ratio = 0.25;
    int max_sample_points = 400;  ///< upper limit of the sample
    int min_inliers = 60;         ///< least number of inliers among all points, after refinement
    double max_tilt_deg = 10.0;   ///< largest tilt of the refined plane from the vertical: walls are vertical

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("stop_early", self.stop_early);
      v("max_sample_points", self.max_sample_points, within(10, 1000000));
    }
  };

  bool found = false;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit, towards the frame's origin; normal . p + d = 0
  double d_m = 0.0;                                   ///< >= 0
  std::vector<int> inliers;                           ///< indices, ascending
  double rms_m = 0.0;                                 ///< of the inliers' distances
  int iterations = 0;
};

/// `points`: m, finite, in a frame whose upward direction is `up` (unit). The same seed gives the same result on any
/// platform.
RansacPlane ransacPlane(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& up,
                        const RansacPlane::Params& params, std::uint32_t seed);

}  // namespace fail_aware
