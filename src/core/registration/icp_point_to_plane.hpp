// Normal-filtered ICP, point to plane (paper, section "Normal Filtering ICP").
//
// Minimises sum w ((p - (R q + t)) . n)^2 over the pose of the centre of gravity, by Gauss-Newton with a robust kernel.
// A correspondence is the plane patch of the voxel that a point falls into (VoxelMap::findPlane: or of a neighbour), so
// an iteration costs about one hash probe a point. The article's filter keeps patches whose normal, seen from above,
// lies within a tolerance of the predicted heading + k pi/2; the tolerance is the predicted heading's sigma, but at
// least `heading_tolerance_deg`. With vertical patches only, z, roll and pitch are unobservable: `keep_ground` also
// keeps ground-like patches.
//
// A head whose beams are off by an elevation error e sees flat ground as a cone of slope e; matched at distance d that
// turns into a false pitch of about 2 e / d a metre driven, the same way on every metre. So ground counts less than
// walls (`ground_weight`), and what is far counts more (`range_weight_m`): the lever is longer. What the beams' errors
// differ by is corrected (beam_bias_estimator.hpp).
//
// Where the lidar is sparse, a voxel holds one scan line or two. Range noise makes a patch of a single line, too: that
// of the rays, which leans against the ground by the beam's elevation and is nearly level on a wall. A vehicle that
// drives on meets the surfaces beside these lines, and such patches turn its pitch the same way on every metre (16
// beams without errors: 5 deg within 60 m). So a residual counts less the farther it is from the points across their
// line (`scan_line_sigma_m`).
//
// Directions that the patches do not observe stay at the prediction and get `weak_sigma` in R (`degenerate_directions`
// says how many).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"
#include "core/parameters/check.hpp"
#include "core/registration/information_support.hpp"
#include "core/registration/normal_equations.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

class IcpPointToPlane {
 public:
  struct Params {
    bool filter_normals = true;
    double heading_tolerance_deg = 45.0;  ///< floor of the tolerance; 45 keeps every vertical patch
    bool keep_ground = true;
    double ground_tolerance_deg = 30.0;    ///< a patch is ground-like if its normal is that near to the vertical
    double vertical_tolerance_deg = 30.0;  ///< a patch is a wall if its normal is that near to the horizontal
    double max_distance_m = 0.5;           ///< correspondences farther from their plane are left out
    double kernel_m = 0.1;                 ///< Geman-McClure scale at the end
    /// Geman-McClure scale at the start; halved every iteration; near max_distance_m
    double initial_kernel_m = 0.4;
    /// of one point along the normal, added to the patch's own scatter: range noise
    double point_sigma_m = 0.03;
    /// common to the points of one scan line: the beam's errors, the pose's; see above
    double scan_line_sigma_m = 0.04;
    double ground_weight = 0.3;  ///< of ground-like patches against the others, see above
    /// Likewise in the ratios of information (min_information_ratio): ground is always in view and must not hide that
    /// little else is. The thresholds of these ratios are found with this value.
    double ground_information_weight = 0.1;
    double range_weight_m = 20.0;  ///< weights grow as range / this; 0: all alike
    int max_iterations = 15;
    /// converged below this step and step_rotation_deg: well below the accuracy
    double step_translation_m = 1e-3;
    double step_rotation_deg = 0.01;  ///< see step_translation_m
    /// at the last iteration steps this many times as large are usable, with a larger R
    double relaxed_convergence_factor = 10.0;
    int min_inliers = 100;                ///< fewer points with a plane: not usable; a sweep has thousands
    double correlation_inflation = 10.0;  ///< R is that much larger than for independent residuals
    /// residuals with less curvature than this ratio inflate R (robust_kernel.hpp); 0: none do. Sound sweeps have 0.78
    /// to 0.95 in the median of a drive
    double usual_curvature_ratio = 0.82;
    InformationSupport::Params support;
    ObservabilityParams observability = {10.0, 0.001};

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("filter_normals", self.filter_normals);
      v("heading_tolerance_deg", self.heading_tolerance_deg, within(0.0, 45.0));
      v("keep_ground", self.keep_ground);
      v("ground_tolerance_deg", self.ground_tolerance_deg, within(0.0, 90.0));
      v("max_distance_m", self.max_distance_m, requirePositive);
      v("kernel_m", self.kernel_m, requirePositive);
      v("ground_weight", self.ground_weight, requirePositive);
      v("range_weight_m", self.range_weight_m, requireNotNegative);
      v("max_iterations", self.max_iterations, within(1, 1000));
      v("correlation_inflation", self.correlation_inflation, within(1.0, 1e6));
      v("usual_curvature_ratio", self.usual_curvature_ratio, within(0.0, 1.0));
      v("support", self.support);
      v("observability", self.observability);
    }
  };

  explicit IcpPointToPlane(const Params& params) : params_(params) {}

  /// points_cog: m, frame of the centre of gravity at the sweep's stamp; sigma_yaw_rad: of the prediction.
  Measurement align(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                    const Pose& T_odom_cog_predicted, double sigma_yaw_rad) const;

  const Params& params() const { return params_; }

 private:
  Params params_;
};

}  // namespace fail_aware
