// The vehicle's pose from matched corners (paper, section "SVD Cornering Algorithm", SVD).
//
// The prediction moves the sweep's corners to odom (without it no corner can be matched at speed). The corners are
// matched with the reference by |M - M'| < association_distance_m and by their normals, and aligned by SVD on M, J and
// N. Outliers (edges of moving vehicles) are removed first: every two pairs propose a motion. The motion with the most
// pairs within max_residual_m wins; on a tie the one with the smallest residuals.
//
// Walls observe x, y and yaw. M's height on its line is a convention, so z is not observed, and equal heights would
// seem to observe roll and pitch. The points therefore enter the SVD with zero height. z, roll and pitch stay at the
// prediction, their covariance is the predicted one times unobserved_inflation, and degenerate_directions is 3. (The
// tilt of the lines does observe roll and pitch, but only to 0.1 to 0.3 deg per corner, with a tail to degrees: the
// ICPs get both better from the ground.)
//
// R for x, y, yaw: the covariance of the least squares solution, given each corner's errors. These are the error of M's
// position, sigma^2 = min_sigma_m^2 + the planes' fits (RANSAC RMSE, independent points, angle between the planes), and
// the error of N's direction; the reference corner has the same errors. R is scaled up if the residuals are larger.
//
// Input: corners in the frame of the centre of gravity, reference corners and prediction in odom; m, rad.
// Failure: kNoReference (no reference corner), kTooFewCorners (fewer than min_corners agree), kDegenerate (all within
// min_baseline_m; all nearly on one line, where their mirror image may fit best; or the prediction is not finite).
// Cost: tens of microseconds.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/registration/corner_svd/corner.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

struct CornerAlignment {
  double association_distance_m = 0.5;
  double max_normal_difference_deg = 15.0;  ///< largest angle between the normals of the two corners
  int min_corners = 2;
  double max_residual_m = 0.15;  ///< of M and of N, horizontal
  double min_baseline_m = 2.0;   ///< distance between the two farthest corners
  /// least sigma of a corner's M, per axis: the range error of a beam, which does not average out
  double min_sigma_m = 0.02;
  double min_direction_sigma_deg = 0.5;    ///< least sigma of a plane's direction, for the same reason
  int points_per_independent_sample = 20;  ///< neighbours share the beam's bias and the wall's relief
  /// factor on the predicted variances of z, roll and pitch: corners observe none of them
  double unobserved_inflation = 10.0;
  int good_corners = 6;  ///< this many well spread corners have an information ratio of 1

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("association_distance_m", self.association_distance_m, requirePositive);
    v("min_corners", self.min_corners, within(2, 1000));
    v("max_residual_m", self.max_residual_m, requirePositive);
    v("min_baseline_m", self.min_baseline_m, requirePositive);
  }

  Measurement align(const std::vector<Corner>& corners_cog, const std::vector<Corner>& reference_odom,
                    const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance) const;
};

}  // namespace fail_aware
