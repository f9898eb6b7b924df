#include "core/estimation/measurement_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/estimation/largest_values.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/matrix6.hpp"
#include "core/geometry/rotation.hpp"
#include "core/geometry/symmetric_eigen.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kDisagreementSigmas = 3.0;
constexpr double kSmallestVariance = 1e-14;
constexpr double kSmallestEigenvalue = 1e-14;  // of a correlation matrix: what double precision leaves
constexpr double kIndefinite = -1e-9;
constexpr double kGimbalLockCosine = 1e-3;

struct Candidate {
  std::size_t input;
  Vector6d z;
  Matrix6d R;
  Matrix6d information;
};

// Row and column scaling: keeps correlations, so a covariance stays one.
Matrix6d withBoundedVariances(const Matrix6d& C) {
  const Vector6d f =
      C.diagonal().unaryExpr([](double v) { return v > kLargestVariance ? std::sqrt(kLargestVariance / v) : 1.0; });
  return f.asDiagonal() * C * f.asDiagonal();
}

// C^-1 by way of the correlation matrix, so that variances from 1e-8 to 1e6 in one matrix, along any directions, are
// harmless. Nothing if C is not a covariance.
std::optional<Matrix6d> inverseOfCovariance(const Matrix6d& C) {
  if (!C.allFinite() || C.diagonal().minCoeff() < 0.0) return std::nullopt;
  const Vector6d scale = C.diagonal().cwiseMax(kSmallestVariance).cwiseSqrt();
  const Vector6d inverse_scale = scale.cwiseInverse();
  Matrix6d correlation = inverse_scale.asDiagonal() * (0.5 * C + 0.5 * C.transpose()) * inverse_scale.asDiagonal();
  correlation.diagonal().setOnes();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(correlation);
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()[0] >= kIndefinite)) return std::nullopt;
  const Vector6d values = eigen.eigenvalues().cwiseMax(kSmallestEigenvalue);
  const Matrix6d half =
      inverse_scale.asDiagonal() * eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal();
  return Matrix6d(half * half.transpose());
}

double mahalanobis2d(const Eigen::Vector2d& d, const Eigen::Matrix2d& C) {
  const auto eigen = symmetricEigen(C);
  const Eigen::Vector2d sigmas = eigen.eigenvalues().cwiseMax(kSmallestVariance).cwiseSqrt();
  return (eigen.eigenvectors().transpose() * d).cwiseQuotient(sigmas).norm();
}

std::optional<Candidate> makeCandidate(std::size_t input, const Measurement& measurement) {
  const Pose& T = measurement.T_odom_cog;
  if (!isFinite(T) || T.translation().cwiseAbs().maxCoeff() > kFarthestPose_m) return std::nullopt;
  const Matrix6d& C = measurement.covariance;
  if (!C.allFinite() || C.diagonal().minCoeff() < 0.0) return std::nullopt;

  Candidate candidate;
  candidate.input = input;
  candidate.z = vectorFromPose(T);
  if (!candidate.z.allFinite() || std::abs(std::cos(candidate.z[4])) < kGimbalLockCosine) return std::nullopt;
  const Matrix6d state_from_pose = inverseOf(poseFromStateJacobian(candidate.z.tail<3>()));
  const Matrix6d bounded = withBoundedVariances(0.5 * C + 0.5 * C.transpose());
  const Matrix6d R = state_from_pose * bounded * state_from_pose.transpose();
  candidate.R = 0.5 * (R + R.transpose());
  const std::optional<Matrix6d> information = inverseOfCovariance(candidate.R);
  if (!information) return std::nullopt;
  candidate.information = *information;
  return candidate;
}

bool agree(const Candidate& a, const Candidate& b, double distance_m, double yaw_rad) {
  const Vector6d d = stateDifference(a.z, b.z);
  const Eigen::Matrix2d C = (a.R + b.R).topLeftCorner<2, 2>() + distance_m * distance_m * Eigen::Matrix2d::Identity();
  const double yaw_tolerance = std::sqrt(yaw_rad * yaw_rad + a.R(5, 5) + b.R(5, 5));
  return mahalanobis2d(d.head<2>(), C) <= 1.0 && std::abs(d[5]) <= yaw_tolerance;
}

// The largest group whose members all agree with each other (grown from each candidate in turn; the tighter of equals).
std::vector<std::size_t> largestAgreement(const std::vector<Candidate>& candidates, double distance_m, double yaw_rad) {
  std::vector<std::size_t> best;
  double best_spread = 0.0;
  for (std::size_t seed = 0; seed < candidates.size(); ++seed) {
    std::vector<std::size_t> group{seed};
    double spread = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (i == seed) continue;
      const bool fits = std::all_of(group.begin(), group.end(), [&](std::size_t member) {
        return agree(candidates[member], candidates[i], distance_m, yaw_rad);
      });
      if (!fits) continue;
      for (const std::size_t member : group) spread += (candidates[member].z - candidates[i].z).head<2>().norm();
      group.push_back(i);
    }
    if (group.size() > best.size() || (group.size() == best.size() && spread < best_spread)) {
      best = group;
      best_spread = spread;
    }
  }
  return best;
}

void fuseLiteral(const std::vector<Candidate>& candidates, const Vector6d& predicted_state, FusionResult* result) {
  double total = 0.0;
  Vector6d d = Vector6d::Zero();
  Vector6d variances = Vector6d::Zero();
  for (const Candidate& c : candidates) {
    const double w = result->weights[c.input];
    total += w;
    d += w * stateDifference(c.z, predicted_state);
    variances += w * c.R.diagonal();
  }
  result->z = predicted_state + d / total;
  result->R = (variances / total).cwiseMax(kSmallestVariance).asDiagonal();
  result->has_measurement = true;
}

void fuseByInformation(const std::vector<Candidate>& candidates, FusionResult* result) {
  const Candidate& heaviest = *std::max_element(
      candidates.begin(), candidates.end(),
      [&](const Candidate& a, const Candidate& b) { return result->weights[a.input] < result->weights[b.input]; });
  double total = 0.0;
  int used = 0;
  for (const Candidate& c : candidates) {
    const double w = result->weights[c.input];
    if (w <= 0.0) continue;
    total += w;
    ++used;
  }
  result->z = heaviest.z;
  result->R = heaviest.R;
  result->has_measurement = true;
  if (used == 1) return;

  // About the heaviest measurement, so that angles are averaged far from their wrap.
  Matrix6d information = Matrix6d::Zero();
  Vector6d information_d = Vector6d::Zero();
  for (const Candidate& c : candidates) {
    const Matrix6d weighted = (result->weights[c.input] / total) * c.information;
    information += weighted;
    information_d += weighted * stateDifference(c.z, heaviest.z);
  }
  const std::optional<Matrix6d> R = inverseOfCovariance(information);
  if (!R) return;
  result->R = *R;
  result->z += *R * information_d;
}

}  // namespace

void MeasurementFusion::Params::validate() const {
  requirePositive("gate_sigma", gate_sigma);
  requireParameter(std::isfinite(min_weight) && min_weight >= 0.0 && min_weight < 1.0, "min_weight", min_weight,
                   "in [0, 1)");
  requireNotNegative("agreement_distance_m", agreement_distance_m);
  requireWithin("agreement_yaw_deg", agreement_yaw_deg, 0.0, 180.0);
}

MeasurementFusion::MeasurementFusion(const Params& params) : params_(params) { params_.validate(); }

namespace {

struct Distance {
  std::size_t one, other;  ///< inputs
  double distance_m;       ///< horizontal
  bool abstains;           ///< one of them is external and its covariance bears the other out
  bool expected;           ///< both know where they are, and their covariances say no better
  bool by_chance;  ///< one of them is external and does not know where it is: being near each other says nothing
};

/// How much a measurement's disagreement counts: in full, or if those that the prediction bears out better outnumber it,
/// as much as the prediction bears it out (its weight).
double credence(std::size_t input, const std::vector<Distance>& distances, const std::vector<double>& weights,
                double agreement_distance_m) {
  int votes_for = 1, votes_against = 0;
  for (const Distance& d : distances) {
    if (d.abstains || (d.one != input && d.other != input)) continue;
    if (weights[d.one == input ? d.other : d.one] > weights[input]) {
      ++votes_against;
    } else if (d.distance_m <= agreement_distance_m) {
      ++votes_for;
    }
  }
  return votes_against > votes_for ? weights[input] : 1.0;
}

void judgeDisagreement(const std::vector<Distance>& distances, double agreement_distance_m, FusionResult* result) {
  std::vector<double> credences;
  for (std::size_t input = 0; input < result->weights.size(); ++input) {
    credences.push_back(credence(input, distances, result->weights, agreement_distance_m));
  }
  bool any_agree = false;
  double farthest_m = 0.0;
  for (const Distance& d : distances) {
    any_agree = any_agree || (!d.by_chance && d.distance_m < agreement_distance_m);
    if (d.abstains) continue;
    result->disagreement_m = std::max(result->disagreement_m, d.distance_m);
    if (d.expected) continue;
    const double counts = std::min(credences[d.one], credences[d.other]);
    result->undecided_m = std::max(result->undecided_m, counts * d.distance_m);
    if (counts > 0.0) farthest_m = std::max(farthest_m, d.distance_m);
  }
  result->confirmed = any_agree && farthest_m < agreement_distance_m;
}

}  // namespace

FusionResult MeasurementFusion::fuse(const Vector6d& predicted_state, const Matrix6d& predicted_P,
                                     const std::vector<FusionInput>& inputs) const {
  FusionResult result;
  result.weights.assign(inputs.size(), 0.0);
  result.nis.assign(inputs.size(), -1.0);
  if (!predicted_state.allFinite() || predicted_state.head<3>().cwiseAbs().maxCoeff() > kFarthestPose_m ||
      !inverseOfCovariance(predicted_P)) {
    result.prediction_invalid = true;
    return result;
  }
  const Matrix6d P = withBoundedVariances(0.5 * predicted_P + 0.5 * predicted_P.transpose());
  result.z = predicted_state;
  result.R = P;

  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!inputs[i].measurement || !inputs[i].measurement->ok()) continue;
    const std::optional<Candidate> candidate = makeCandidate(i, *inputs[i].measurement);
    if (candidate && stateDifference(candidate->z, predicted_state).head<3>().norm() <= kFarthestOff_m) {
      candidates.push_back(*candidate);
    } else {
      ++result.invalid_inputs;
    }
  }
  result.valid_inputs = static_cast<int>(candidates.size());

  std::vector<Distance> distances;
  bool any_inside = false;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const Vector6d d = stateDifference(c.z, predicted_state);
    if (const std::optional<Matrix6d> inverse = inverseOfCovariance(P + c.R)) result.nis[c.input] = d.dot(*inverse * d);
    const Eigen::Matrix2d P_xy = P.topLeftCorner<2, 2>();
    const Eigen::Matrix2d gate = params_.literal ? Eigen::Matrix2d(P_xy.diagonal().asDiagonal())
                                                 : Eigen::Matrix2d(P_xy + c.R.topLeftCorner<2, 2>());
    const double w = 1.0 - mahalanobis2d(d.head<2>(), gate) / params_.gate_sigma;
    if (w > 0.0 && (params_.literal || w >= params_.min_weight)) result.weights[c.input] = w;
    any_inside = any_inside || result.weights[c.input] > 0.0;
    for (std::size_t j = 0; j < i; ++j) {
      const Vector6d apart = stateDifference(c.z, candidates[j].z);
      const bool external = inputs[c.input].external || inputs[candidates[j].input].external;
      const Eigen::Matrix2d R_xy = c.R.topLeftCorner<2, 2>() + candidates[j].R.topLeftCorner<2, 2>();
      const bool borne_out = mahalanobis2d(apart.head<2>(), R_xy) <= kDisagreementSigmas;
      const bool known = R_xy.trace() <= params_.agreement_distance_m * params_.agreement_distance_m;
      const double distance_m = apart.head<2>().norm();
      const bool abstains = external && borne_out;
      distances.push_back({c.input, candidates[j].input, distance_m, abstains, borne_out && known, external && !known});
      if (!abstains) result.disagreement_yaw_rad = std::max(result.disagreement_yaw_rad, std::abs(apart[5]));
    }
  }
  result.all_gated_out = !candidates.empty() && !any_inside;

  if (result.all_gated_out && !params_.literal) {
    const std::vector<std::size_t> group =
        largestAgreement(candidates, params_.agreement_distance_m, params_.agreement_yaw_deg * kDegree);
    if (group.size() >= 2) {
      result.prediction_overruled = true;
      for (const std::size_t member : group) result.weights[candidates[member].input] = 1.0;
    }
  }
  if (any_inside && params_.literal) fuseLiteral(candidates, predicted_state, &result);
  if ((any_inside || result.prediction_overruled) && !params_.literal) fuseByInformation(candidates, &result);
  for (int i = 3; i < 6; ++i) result.z[i] = wrapAngle(result.z[i]);
  judgeDisagreement(distances, params_.agreement_distance_m, &result);
  return result;
}

}  // namespace fail_aware
