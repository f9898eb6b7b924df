#include "evaluation/azimuth_calibration.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/io/input_error.hpp"
#include "evaluation/quantile.hpp"

namespace fail_aware {

namespace {

constexpr double kLeastDistance_m = 0.1;
constexpr double kLargestDistance_m = 100.0;  // of any vehicle in a sweep
constexpr double kJump = 3.0;                 // times the median way
constexpr int kLeastMotions = 50;
constexpr double kAhead_deg = 45.0;
constexpr int kStretches = 10;
constexpr int kIterations = 20;
constexpr double kMadToSigma = 1.4826;
constexpr double kCauchy = 2.385;  // 95 % efficient where errors are Gaussian
constexpr double kLeastSigma_m = 1e-9;

/// From sweep to sweep, without standing, gaps and jumps.
std::vector<Pose> motionsOf(const std::vector<Pose>& trajectory) {
  std::vector<Pose> motions;
  std::vector<double> ways_m;
  const auto wayOf_m = [](const Pose& motion) { return motion.translation().head<2>().norm(); };
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const Pose motion = trajectory[i - 1].inverse() * trajectory[i];
    const double distance_m = wayOf_m(motion);
    if (!(distance_m >= kLeastDistance_m && distance_m <= kLargestDistance_m)) continue;
    motions.push_back(motion);
    ways_m.push_back(distance_m);
  }
  if (motions.empty()) return motions;
  const double longest_m = kJump * quantile(ways_m, 0.5);
  motions.erase(std::remove_if(motions.begin(), motions.end(), [&](const Pose& m) { return wayOf_m(m) > longest_m; }),
                motions.end());
  return motions;
}

struct Equations {
  explicit Equations(const std::vector<Pose>& motions)
      : terms(static_cast<Eigen::Index>(motions.size()), 3), side_m(terms.rows()) {
    for (Eigen::Index i = 0; i < terms.rows(); ++i) {
      const Pose& motion = motions[static_cast<std::size_t>(i)];
      const double x = motion.translation().x(), y = motion.translation().y();
      const double w = rpyFromRotation(motion.linear()).z();
      terms.row(i) << x, w, -w * x * x;
      side_m[i] = y - 0.5 * x * w;
    }
  }

  Eigen::MatrixX3d terms;  ///< of tan psi, b, k
  Eigen::VectorXd side_m;  ///< y - x w / 2
};

void requireAhead(const std::vector<Pose>& motions) {
  Eigen::Vector2d way = Eigen::Vector2d::Zero();
  for (const Pose& motion : motions) way += motion.translation().head<2>();
  const double direction_deg = std::atan2(way.y(), way.x()) / kDegree;
  if (std::abs(direction_deg) <= kAhead_deg) return;
  throw InputError("the vehicle travels " + std::to_string(std::lround(direction_deg)) +
                   " deg off base_link's x axis: that is how the lidar is mounted, to be told by tf or "
                   "sensor.lidar_in_base, or driven in reverse");
}

/// x of A x = b in the sense of least squares; of several the smallest.
Eigen::VectorXd smallestSolution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

/// Share of psi's term that those of b and k span.
double curvatureRatio(const Eigen::MatrixX3d& terms) {
  const Eigen::VectorXd x = terms.col(0);
  const Eigen::MatrixXd curvatures = terms.rightCols<2>();
  const Eigen::VectorXd spanned = curvatures * smallestSolution(curvatures, x);
  return spanned.squaredNorm() / x.squaredNorm();
}

/// The fit's psi, rad. Straight on, or at one speed, b and k are not determined: the smallest solution serves.
double fit_rad(const Eigen::MatrixX3d& terms, const Eigen::VectorXd& side_m) {
  Eigen::VectorXd root_weights = Eigen::VectorXd::Ones(side_m.size());
  Eigen::Vector3d solution = Eigen::Vector3d::Zero();
  for (int i = 0; i < kIterations; ++i) {
    solution = smallestSolution(root_weights.asDiagonal() * terms, root_weights.cwiseProduct(side_m));
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
  std::vector<Pose> motions;
  for (const std::vector<Pose>& trajectory : trajectories) {
    const std::vector<Pose> of_drive = motionsOf(trajectory);
    motions.insert(motions.end(), of_drive.begin(), of_drive.end());
  }
  const auto count = static_cast<int>(motions.size());
  if (count < kLeastMotions) {
    throw InputError(std::to_string(count) + " motions of 0.1 m and more from sweep to sweep: at least " +
                     std::to_string(kLeastMotions) + " are needed to tell the direction of travel");
  }
  requireAhead(motions);
  const Equations all(motions);
  DirectionOfTravel found;
  found.motions = count;
  for (const Pose& motion : motions) found.distance_m += motion.translation().head<2>().norm();
  found.direction_deg = fit_rad(all.terms, all.side_m) / kDegree;
  found.curvature_ratio = curvatureRatio(all.terms);

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
