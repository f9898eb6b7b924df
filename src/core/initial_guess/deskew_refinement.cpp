#include "core/initial_guess/deskew_refinement.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "core/geometry/degree.hpp"
#include "core/preprocessing/azimuth_coverage.hpp"
#include "core/registration/plane_pairs.hpp"

namespace fail_aware {

namespace {

// With a part of a revolution, rate and pose are hard to distinguish: half sweeps of a highway turned the heading by
// 0.04 deg in 10 s. Whole revolutions have 0.78 (a tunnel) to 1.
constexpr double kMinAzimuthCoverage = 0.75;
// None of 2000 sweeps (town, country, highway, field, real roads) is beyond. A larger rate is another minimum, and the
// map keeps the bent sweep.
constexpr double kMostSigmas = 4.0;

// The equations of the pose, and those of the turn rate w, odom's axes: a point measured tau after the middle moves
// as under a rotation of tau w.
struct TurningEquations {
  NormalEquations pose;
  Eigen::Matrix<double, 6, 3> H_pose_rate = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix3d H_rate = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b_rate = Eigen::Vector3d::Zero();

  void add(const PlanePair& pair, double tau_s) {
    pair.addTo(pose);
    const Eigen::Vector3d J_rate = tau_s * pair.J.tail<3>();
    const Eigen::Vector3d weighted = pair.weight * J_rate;
    H_pose_rate += pair.J * weighted.transpose();
    H_rate += weighted * J_rate.transpose();
    b_rate -= pair.residual_m * weighted;
  }
};

}  // namespace

std::optional<Eigen::Vector3d> DeskewRefinement::find(const std::vector<Eigen::Vector3f>& points_cog,
                                                      const std::vector<float>& times_s, double middle_s,
                                                      const VoxelMap& map, const Pose& T_odom_cog_predicted,
                                                      double sigma_yaw_rad) const {
  if (!params_.enabled || map.empty() || times_s.size() != points_cog.size()) return std::nullopt;
  if (azimuthCoverage(points_cog) < kMinAzimuthCoverage) return std::nullopt;
  PlanePairs pairs(planes_, points_cog, map, T_odom_cog_predicted, sigma_yaw_rad);
  const double sigma_rad_s = params_.sigma_deg_s * kDegree;
  // in the units of the pairs' weights
  const double prior = planes_.correlation_inflation / (sigma_rad_s * sigma_rad_s);
  Pose T = T_odom_cog_predicted;
  Eigen::Vector3d rate_odom = Eigen::Vector3d::Zero();
  double kernel_m = std::max(planes_.initial_kernel_m, planes_.kernel_m);
  Vector6d step = Vector6d::Zero();
  for (int iteration = 0; iteration < planes_.max_iterations; ++iteration) {
    TurningEquations equations;
    const auto tau = [&](std::size_t i) { return static_cast<double>(times_s[i]) - middle_s; };
    pairs.forEach(
        T, kernel_m,
        [&](const Eigen::Vector3d& arm, std::size_t i) -> Eigen::Vector3d {
          return arm + tau(i) * rate_odom.cross(arm);
        },
        [&](const PlanePair& pair, std::size_t i) { equations.add(pair, tau(i)); });
    NormalEquations& pose = equations.pose;
    if (static_cast<int>(pose.inliers) < planes_.min_inliers) return std::nullopt;
    pose.H = pose.H.selfadjointView<Eigen::Lower>();
    // eliminate the rate: w = free - with_pose dx
    equations.H_rate.diagonal().array() += prior;
    equations.b_rate -= prior * rate_odom;
    const auto solver = equations.H_rate.ldlt();
    const Eigen::Matrix<double, 3, 6> with_pose = solver.solve(equations.H_pose_rate.transpose());
    const Eigen::Vector3d free = solver.solve(equations.b_rate);
    pose.H -= equations.H_pose_rate * with_pose;
    pose.b -= equations.H_pose_rate * free;
    const Solution solution = solveObserved(pose, planes_.observability);
    if (solution.degenerate_directions == 6) return std::nullopt;
    step = solution.dx;
    T = applyStep(T, step);
    rate_odom += free - with_pose * step;
    if (kernel_m <= planes_.kernel_m && stepWithin(step, planes_, 1.0)) break;
    kernel_m = std::max(0.5 * kernel_m, planes_.kernel_m);
  }
  if (!stepWithin(step, planes_, planes_.relaxed_convergence_factor) || !rate_odom.allFinite()) return std::nullopt;
  if (rate_odom.cwiseAbs().maxCoeff() > kMostSigmas * sigma_rad_s) return std::nullopt;
  return Eigen::Vector3d(T.linear().transpose() * rate_odom);
}

}  // namespace fail_aware
