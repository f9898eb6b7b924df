// Multiplex ICP, point to point (paper, section "Multiplex General ICP").
//
// The eight seeds are the off-centre sigma points of the predicted pose over body x, y, z and yaw:
//   x~ +- spread * sigma_i
// All seeds descend in lockstep on a thinned cloud; seeds that converge to the same pose are merged. In the usual case
// there is one minimum, and the seeds cost little more than one. The remaining seeds are refined on the whole cloud and
// compared on the same points with the same cut-off and minimum inlier ratio; the smallest mean squared error wins. R
// comes from the winner's information matrix and residual, and grows with the spread of the refined seeds' results.
//
// Degenerate directions (along a tunnel) stay at the prediction, and R shows it (point_pairs.hpp).
//
// Failure: the status of the Measurement.
// Cost: (remaining seeds) * points * iterations nearest-point queries, on the threads of the caller's TBB arena; the
// result is bit-identical for any number of threads.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"
#include "core/parameters/check.hpp"
#include "core/registration/normal_equations.hpp"
#include "core/registration/point_pairs.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

/// A seed and the end of its descent, for display. Merged seeds share their end; a seed that was not refined ends where
/// the joint descent left it.
struct SeedTrack {
  Pose T_odom_cog_seed = Pose::Identity();
  Pose T_odom_cog_end = Pose::Identity();
  bool won = false;  ///< its end is the measurement
};

class IcpPointToPoint {
 public:
  static constexpr int kMostIterations = 1000;  ///< upper limit of Params::max_iterations

  struct Params {
    int seeds = 8;                ///< 8: +- over x, y, z, yaw; 1: the prediction alone
    double spread = 1.0;          ///< distance of the seeds from the prediction, in sigma
    double min_spread_m = 0.05;   ///< least distance of the seeds: below it all seeds are the same
    double min_spread_deg = 0.1;  ///< least rotation of the seeds: 0.05 m at 30 m
    double max_spread_m = 1.0;    ///< largest distance of the seeds: beyond it, relocalization is needed
    double max_spread_deg = 3.0;  ///< largest rotation of the seeds
    /// points used in the joint descent: enough to tell one minimum from another
    int thinned_points = 500;
    double max_distance_m = 0.5;  ///< cut-off of correspondences
    double kernel_m = 0.2;        ///< Geman-McClure scale at the end
    /// Geman-McClure scale at the start; halved every iteration; near max_distance_m
    double initial_kernel_m = 0.4;
    /// seeds nearer than this and merge_rotation_deg are merged: they end in the same minimum
    double merge_translation_m = 0.02;
    double merge_rotation_deg = 0.1;  ///< see merge_translation_m
    int max_joint_iterations = 12;    ///< iterations of all seeds on the thinned points: most seeds have merged by then
    int max_refined_seeds = 3;
    int max_iterations = 30;
    /// converged below this step and step_rotation_deg: well below the accuracy
    double step_translation_m = 2e-3;
    double step_rotation_deg = 0.02;  ///< see step_translation_m
    /// after the last iteration, a step up to this factor larger is accepted, with a larger R
    double relaxed_convergence_factor = 10.0;
    double min_inlier_ratio = 0.3;
    int min_inliers = 100;               ///< least number of points with a partner: a sweep has thousands
    bool surface_information = true;     ///< false: a pair informs equally in all directions
    double correlation_inflation = 7.0;  ///< factor on R, because residuals are not independent
    /// residuals with less curvature than this ratio inflate R (robust_kernel.hpp); 0: none do
    double usual_curvature_ratio = 0.75;
    /// factor on the sigma of roll and pitch: a point's nearest neighbour follows the guess, and of a change that the
    /// guess misses a fifth remains, more than the residuals show
    double tilt_sigma_factor = 4.0;
    InformationSupport::Params support;
    ObservabilityParams observability;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("seeds", self.seeds, within(1, 8));
      v("spread", self.spread, requirePositive);
      v("max_distance_m", self.max_distance_m, requirePositive);
      v("kernel_m", self.kernel_m, requirePositive);
      v("max_refined_seeds", self.max_refined_seeds, within(1, 8));
      v("max_iterations", self.max_iterations, within(1, kMostIterations));
      v("min_inlier_ratio", self.min_inlier_ratio, within(0.0, 1.0));
      v("surface_information", self.surface_information);
      v("correlation_inflation", self.correlation_inflation, within(1.0, 1e6));
      v("usual_curvature_ratio", self.usual_curvature_ratio, within(0.0, 1.0));
      v("tilt_sigma_factor", self.tilt_sigma_factor, within(1.0, 100.0));
      v("support", self.support);
      v("observability", self.observability);
    }
  };

  /// Seeds that were merged.
  struct Descent {
    Pose T;
    std::vector<std::size_t> seeds;
    bool settled = false;
    PointPairs::Neighborhoods neighborhoods;  ///< of the thinned points, in the joint descent
  };

  explicit IcpPointToPoint(const Params& params) : params_(params) {}

  /// The seed poses for a prediction. `predicted_covariance`: SweepPrediction::covariance.
  std::vector<Pose> seeds(const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance) const;

  /// points_cog: m, frame of the centre of gravity at the sweep's stamp. `tracks`: optional output, one per seed, in
  /// the order of seeds(); empty without a reference.
  Measurement align(const std::vector<Eigen::Vector3f>& points_cog, const VoxelMap& map,
                    const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance,
                    std::vector<SeedTrack>* tracks = nullptr) const;

 private:
  using Weak = std::optional<WeakHorizontal>;

  /// The result of a descent on all points.
  struct Refined {
    Pose T_odom_cog = Pose::Identity();
    NormalEquations equations;
    Solution step;
    int iterations = 0;
    bool converged = false;
    bool usable = false;  ///< enough points have a partner
    double inlier_ratio = 0.0;
    double error = 0.0;  ///< PointPairs::meanSquaredError
  };

  void descendTogether(const PointPairs& pairs, const Weak& weak, std::size_t stride,
                       std::vector<Descent>& descents) const;
  /// The max_refined_seeds with the smallest error.
  void keepBest(const PointPairs& pairs, std::size_t stride, std::vector<Descent>& descents) const;
  Refined refine(const PointPairs& pairs, const Weak& weak, PointPairs::Neighborhoods& neighborhoods,
                 Descent& descent) const;
  Measurement measurement(const Refined& best, double spread2_m2) const;
  Solution solve(NormalEquations& equations, const Weak& weak) const;

  Params params_;
};

}  // namespace fail_aware
