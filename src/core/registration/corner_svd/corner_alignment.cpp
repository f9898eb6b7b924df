#include "core/registration/corner_svd/corner_alignment.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rigid_alignment.hpp"

namespace fail_aware {

namespace {

// At its end, the corner, a plane's offset has four times the variance of the offset at its middle.
constexpr double kVarianceAtEnd = 4.0;

Eigen::Vector2d horizontal(const Eigen::Vector3d& v) { return v.head<2>(); }
Eigen::Vector3d flat(const Eigen::Vector3d& v) { return {v.x(), v.y(), 0.0}; }
Eigen::Vector2d turnedLeft(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

// p -> R p + t in the horizontal plane.
struct PlanarMotion {
  Eigen::Matrix2d R;
  Eigen::Vector2d t;
  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return R * horizontal(p) + t; }
};

// The motion that rotates a -> b onto c -> d and moves the midpoint of a, b to the midpoint of c, d.
PlanarMotion motionOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d) {
  const Eigen::Vector2d from = horizontal(b - a), to = horizontal(d - c);
  const double yaw = std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
  PlanarMotion motion;
  motion.R = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  motion.t = 0.5 * (horizontal(c + d) - motion.R * horizontal(a + b));
  return motion;
}

double residual(const PlanarMotion& motion, const Corner& corner, const Corner& reference) {
  return std::max((motion(corner.M) - horizontal(reference.M)).norm(),
                  (motion(corner.N) - horizontal(reference.N)).norm());
}

// A corner moved by the prediction and its reference corner, in odom, at equal heights, planes in the same order.
struct Pair {
  Corner corner;
  Corner reference;
  double variance_m2;    // of the difference between the two M, per axis
  double variance_rad2;  // of the difference between the two directions to N
};

double placeVariance(const CornerAlignment& params, const Corner& corner) {
  double variance = 0.0;  // of the planes' offsets at the corner
  for (std::size_t k = 0; k < 2; ++k) {
    const double samples =
        std::max(1.0, static_cast<double>(corner.planes[k].points) / params.points_per_independent_sample);
    variance += kVarianceAtEnd * corner.planes[k].rms_m * corner.planes[k].rms_m / samples;
  }
  const double sine2 = std::max(0.1, corner.planes[0].normal.cross(corner.planes[1].normal).squaredNorm());
  return params.min_sigma_m * params.min_sigma_m + 0.5 * variance / sine2;
}

double directionVariance(const CornerAlignment& params, const Corner& corner) {
  const double samples =
      std::max(1.0, static_cast<double>(corner.planes[0].points) / params.points_per_independent_sample);
  const double sigma = params.min_direction_sigma_deg * kDegree;
  return sigma * sigma + corner.planes[0].rms_m * corner.planes[0].rms_m / samples;  // over a wall of about 3 m
}

std::vector<Pair> associate(const CornerAlignment& params, const std::vector<Corner>& corners_cog,
                            const std::vector<Corner>& reference_odom, const Pose& T_odom_cog_predicted) {
  std::vector<Pair> pairs;
  for (const CornerPair& match : matchCorners(movedCorners(T_odom_cog_predicted, corners_cog), reference_odom,
                                              params.association_distance_m, params.max_normal_difference_deg)) {
    const Corner &corner = match.corner, &reference = reference_odom[match.second];
    if (!(corner.M + corner.J + corner.N).allFinite() || !(reference.M + reference.J + reference.N).allFinite()) {
      continue;
    }
    pairs.push_back({corner, reference, placeVariance(params, corner) + placeVariance(params, reference),
                     directionVariance(params, corner) + directionVariance(params, reference)});
  }
  return pairs;
}

// The largest set of pairs that one motion explains; on a tie the set with the smallest residuals.
std::vector<Pair> agreeing(const CornerAlignment& params, const std::vector<Pair>& pairs) {
  std::vector<Pair> best;
  double best_squares = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      const PlanarMotion motion =
          motionOf(pairs[i].corner.M, pairs[j].corner.M, pairs[i].reference.M, pairs[j].reference.M);
      std::vector<Pair> explained;
      double squares = 0.0;
      for (const Pair& pair : pairs) {
        const double r = residual(motion, pair.corner, pair.reference);
        if (!(r < params.max_residual_m)) continue;
        explained.push_back(pair);
        squares += r * r;
      }
      if (explained.size() < best.size() || (explained.size() == best.size() && squares >= best_squares)) continue;
      best = explained;
      best_squares = squares;
    }
  }
  return best;
}

// Least squares over v = (dx, dy, dyaw) about the vehicle: each point q of a corner moves by
//   A_q v = (dx, dy) + dyaw (q - vehicle) turned left.
// M and J share the error e_M; N has the error e_M + e_direction (N - M) turned left:
//   H = sum w A^T A,  g = sum w (A_M + A_J + A_N)^T e_M + w A_N^T (N - M turned left) e_direction
//   Cov = H^-1 E[g g^T] H^-1
void setCovariance(const CornerAlignment& params, const std::vector<Pair>& pairs, const Pose& T_correction,
                   const Matrix6d& predicted_covariance, Measurement& measurement) {
  using Jacobian = Eigen::Matrix<double, 2, 3>;
  const Eigen::Vector2d vehicle = horizontal(measurement.T_odom_cog.translation());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), G = Eigen::Matrix3d::Zero();
  double squares_m2 = 0.0, chi2 = 0.0, total_weight = 0.0;
  for (const Pair& pair : pairs) {
    const double w = 1.0 / pair.variance_m2;
    Jacobian A_sum = Jacobian::Zero(), A_N = Jacobian::Zero();
    for (const auto point : {&Corner::M, &Corner::J, &Corner::N}) {
      A_N << Eigen::Matrix2d::Identity(), turnedLeft(horizontal(pair.reference.*point) - vehicle);
      H += w * A_N.transpose() * A_N;
      A_sum += A_N;
    }
    const Eigen::Vector3d g_direction =
        w * A_N.transpose() * turnedLeft(horizontal(pair.reference.N - pair.reference.M));
    G += w * w * pair.variance_m2 * A_sum.transpose() * A_sum;
    G += pair.variance_rad2 * g_direction * g_direction.transpose();
    const double r2 = horizontal(T_correction * flat(pair.corner.M) - pair.reference.M).squaredNorm();
    squares_m2 += r2;
    chi2 += w * r2;
    total_weight += w;
  }
  const double corners = static_cast<double>(pairs.size());
  const double freedom = 2.0 * corners - 3.0;
  const Eigen::Matrix3d H_inverse = H.inverse();
  const Eigen::Matrix3d planar = std::max(1.0, chi2 / freedom) * (H_inverse * G * H_inverse);

  Matrix6d& covariance = measurement.covariance;
  covariance.setZero();
  covariance.block<3, 3>(2, 2) = params.unobserved_inflation * predicted_covariance.block<3, 3>(2, 2);
  setHorizontalBlock(symmetric(planar), covariance);
  measurement.degenerate_directions = 3;
  measurement.rms_residual_m = std::sqrt(squares_m2 / corners);
  // Information of good_corners in all directions at the mean weight; in one horizontal direction it is their summed
  // weight.
  const Eigen::Vector2d variances = symmetricEigen(Eigen::Matrix2d(planar.topLeftCorner<2, 2>())).eigenvalues();
  const double good_information = total_weight / corners * static_cast<double>(params.good_corners);
  measurement.min_information_ratio = std::min(1.0, 1.0 / (variances(1) * good_information));
}

}  // namespace

Measurement CornerAlignment::align(const std::vector<Corner>& corners_cog, const std::vector<Corner>& reference_odom,
                                   const Pose& T_odom_cog_predicted, const Matrix6d& predicted_covariance) const {
  Measurement measurement;
  measurement.status = MeasurementStatus::kNoReference;
  if (!isFinite(T_odom_cog_predicted) || !predicted_covariance.allFinite()) {
    measurement.status = MeasurementStatus::kDegenerate;
    return measurement;
  }
  measurement.T_odom_cog = T_odom_cog_predicted;
  if (reference_odom.empty()) return measurement;

  const std::vector<Pair> associated = associate(*this, corners_cog, reference_odom, T_odom_cog_predicted);
  const std::vector<Pair> pairs = agreeing(*this, associated);
  measurement.inliers = pairs.size();
  measurement.iterations = corners_cog.empty() ? 0 : 1;  // a sweep without corners did not search
  measurement.status = MeasurementStatus::kTooFewCorners;
  if (associated.size() < static_cast<std::size_t>(min_corners)) return measurement;
  measurement.inlier_ratio = static_cast<double>(pairs.size()) / static_cast<double>(associated.size());
  if (pairs.size() < static_cast<std::size_t>(min_corners)) return measurement;

  measurement.status = MeasurementStatus::kDegenerate;
  double baseline_m = 0.0;
  for (const Pair& a : pairs) {
    for (const Pair& b : pairs) baseline_m = std::max(baseline_m, horizontal(a.reference.M - b.reference.M).norm());
  }
  if (baseline_m < min_baseline_m) return measurement;

  std::vector<Eigen::Vector3d> source, target;
  std::vector<double> weights;
  for (const Pair& pair : pairs) {
    for (const auto point : {&Corner::M, &Corner::J, &Corner::N}) {
      source.push_back(flat(pair.corner.*point));
      target.push_back(flat(pair.reference.*point));
      weights.push_back(1.0 / pair.variance_m2);
    }
  }
  const std::optional<Pose> T_reference_corner = alignRigid(source, target, weights);
  if (!T_reference_corner) return measurement;
  const bool mirrored = T_reference_corner->linear()(2, 2) < 0.0;  // turned over: in the plane a mirror image
  if (mirrored) return measurement;
  Measurement aligned = measurement;
  aligned.status = MeasurementStatus::kOk;
  aligned.T_odom_cog = orthonormalized(*T_reference_corner * T_odom_cog_predicted);
  setCovariance(*this, pairs, *T_reference_corner, predicted_covariance, aligned);
  return isFinite(aligned.T_odom_cog) && aligned.covariance.allFinite() ? aligned : measurement;
}

}  // namespace fail_aware
