// The vehicle's pose from corners seen again (paper, section "SVD Cornering Algorithm", SVD).
//
// The sweep's corners are moved by the prediction (without it nothing associates at speed), matched with the
// reference's by |M - M'| < association_distance_m and by their normals, and aligned by SVD on M, J and N.
// Outliers (edges of moving vehicles) are left out first: every two pairs propose a motion, the one that most pairs
// agree with within max_residual_m wins, nearest to all of them on a tie.
//
// What walls observe: x, y and yaw. M's height on its line is a convention, so z is not observed, and equal heights
// would seem to hold roll and pitch. So the points enter the SVD with their heights set to zero, z, roll and pitch stay
// at the prediction, their covariance is the predicted one times unobserved_inflation and degenerate_directions is 3. (The
// tilt of the lines does observe roll and pitch, but at 0.1 to 0.3 deg a corner, with a tail to degrees: the ground
// does it better for the ICPs.)
//
// R for x, y, yaw: that of the least squares solution under each corner's errors: of M's place, sigma^2 = min_sigma_m^2
// + the planes' fits (RANSAC RMSE, independent points, angle between them), and of N's direction; the reference's
// corner errs likewise. Scaled up where the residuals are larger than that.
//
// Failure: kNoReference (no reference corner), kTooFewCorners (fewer than min_corners agree), kDegenerate (they stand
// closer than min_baseline_m, or the prediction is not finite). Cost: tens of microseconds.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"

namespace fail_aware {

class CornerAlignment {
 public:
  struct Params {
    double association_distance_m = 0.5;
    double max_normal_difference_deg = 15.0;  ///< largest angle between the normals of the two corners
    int min_corners = 2;
    double max_residual_m = 0.15;  ///< of M and of N, horizontal
    double min_baseline_m = 2.0;   ///< between the two corners furthest apart
    /// least sigma of a corner's M, per axis: range error of a beam, which no number of points averages out
    double min_sigma_m = 0.02;
    double min_direction_sigma_deg = 0.5;    ///< least sigma of a plane's direction, likewise
    int points_per_independent_sample = 20;  ///< neighbours share the beam's bias and the wall's relief
    /// factor on the predicted variances of z, roll and pitch: a corner observes none of them
    double unobserved_inflation = 10.0;
    int good_corners = 6;  ///< this many, well spread: an information of 1

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("association_distance_m", self.association_distance_m);
      v("min_corners", self.min_corners);
      v("max_residual_m", self.max_residual_m);
      v("min_baseline_m", self.min_baseline_m);
    }
    void validate() const;
  };

  explicit CornerAlignment(const Params& params);

  Measurement align(const std::vector<Corner>& corners_cog, const std::vector<Corner>& reference_odom,
                    const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance) const;

 private:
  // A corner moved by the prediction and the reference corner it is taken for, in odom, at equal heights, planes in
  // the same order.
  struct Pair {
    Corner corner;
    Corner reference;
    double variance_m2;    ///< of the difference of their Ms, per axis
    double variance_rad2;  ///< of the difference of their directions to N
  };

  std::vector<Pair> associate(const std::vector<Corner>& corners_cog, const std::vector<Corner>& reference_odom,
                              const Pose& T_odom_cog_predicted) const;
  std::vector<Pair> agreeing(const std::vector<Pair>& pairs) const;
  void setCovariance(const std::vector<Pair>& pairs, const Pose& T_correction, const Matrix6d& predicted_covariance,
                     Measurement& measurement) const;
  double placeVariance(const Corner& corner) const;
  double directionVariance(const Corner& corner) const;

  Params params_;
};

}  // namespace fail_aware
