#include "fail_aware_lidar_odometry/core/evaluation/azimuth_calibration.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "fail_aware_lidar_odometry/core/evaluation/quantile.hpp"
#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/core/io/input_error.hpp"

namespace fail_aware {

namespace {

constexpr double kLeastWay_m = 0.1;
constexpr int kLeastMotions = 50;
constexpr int kStretches = 10;
constexpr int kIterations = 20;
constexpr double kMadToSigma = 1.4826;
constexpr double kCauchy = 2.385;  // 95 % efficient where errors are Gaussian
constexpr double kLeastSigma_m = 1e-9;

struct Motions {
  Eigen::MatrixX3d terms;  ///< of psi, b, k
  Eigen::VectorXd side_m;  ///< y - x w / 2
  double way_m = 0.0;
};

Motions motionsOf(const std::vector<std::vector<Pose>>& trajectories) {
  std::vector<Eigen::Vector4d> rows;
  Motions motions;
  for (const std::vector<Pose>& trajectory : trajectories) {
    for (std::size_t i = 1; i < trajectory.size(); ++i) {
      const Pose motion = trajectory[i - 1].inverse() * trajectory[i];
      const double x = motion.translation().x(), y = motion.translation().y();
      if (!(std::abs(x) >= kLeastWay_m)) continue;
      const double w = rpyFromRotation(motion.linear()).z();
      rows.emplace_back(x, w, -w * x * x, y - 0.5 * x * w);
      motions.way_m += std::abs(x);
    }
  }
  const auto size = static_cast<Eigen::Index>(rows.size());
  motions.terms.resize(size, 3);
  motions.side_m.resize(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    motions.terms.row(i) = rows[static_cast<std::size_t>(i)].head<3>();
    motions.side_m[i] = rows[static_cast<std::size_t>(i)][3];
  }
  return motions;
}

/// The fit's psi, rad. At one speed, or straight on, b and k are not determined: the smallest solution serves.
double fit_rad(const Eigen::MatrixX3d& terms, const Eigen::VectorXd& side_m) {
  Eigen::VectorXd root_weights = Eigen::VectorXd::Ones(side_m.size());
  Eigen::Vector3d solution = Eigen::Vector3d::Zero();
  for (int i = 0; i < kIterations; ++i) {
    solution =
        (root_weights.asDiagonal() * terms).completeOrthogonalDecomposition().solve(root_weights.cwiseProduct(side_m));
    const Eigen::ArrayXd error_m = (side_m - terms * solution).array();
    const Eigen::ArrayXd size_m = error_m.abs();
    const double median_m = quantile(std::vector<double>(size_m.data(), size_m.data() + size_m.size()), 0.5);
    const double scale_m = kCauchy * std::max(kMadToSigma * median_m, kLeastSigma_m);
    root_weights = (1.0 + (error_m / scale_m).square()).rsqrt();
  }
  return std::atan(solution[0]);
}

}  // namespace

DirectionOfTravel directionOfTravel(const std::vector<std::vector<Pose>>& trajectories) {
  const Motions all = motionsOf(trajectories);
  const auto count = static_cast<int>(all.side_m.size());
  if (count < kLeastMotions) {
    throw InputError(std::to_string(count) + " motions of at least 0.1 m from sweep to sweep: " +
                     std::to_string(kLeastMotions) + " are needed to tell the direction of travel");
  }
  DirectionOfTravel found;
  found.motions = count;
  found.way_m = all.way_m;
  found.azimuth_deg = fit_rad(all.terms, all.side_m) / kDegree;

  Eigen::ArrayXd without_deg(kStretches);  // one stretch left out
  for (int k = 0; k < kStretches; ++k) {
    const int first = count * k / kStretches, last = count * (k + 1) / kStretches;
    Eigen::MatrixX3d terms(count - (last - first), 3);
    Eigen::VectorXd side_m(count - (last - first));
    terms << all.terms.topRows(first), all.terms.bottomRows(count - last);
    side_m << all.side_m.head(first), all.side_m.tail(count - last);
    without_deg[k] = fit_rad(terms, side_m) / kDegree;
  }
  const double squares = (without_deg - without_deg.mean()).square().sum();
  found.sigma_deg = std::sqrt(squares * (kStretches - 1) / kStretches);
  return found;
}

}  // namespace fail_aware
