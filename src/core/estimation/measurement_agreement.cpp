#include "core/estimation/measurement_agreement.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimation/largest_values.hpp"
#include "core/geometry/decompositions.hpp"

namespace fail_aware {

namespace {

constexpr double kDisagreementSigmas = 3.0;

bool agree(const FusionCandidate& a, const FusionCandidate& b, double distance_m, double yaw_rad) {
  const Vector6d d = stateDifference(a.z, b.z);
  const Eigen::Matrix2d C = (a.R + b.R).topLeftCorner<2, 2>() + distance_m * distance_m * Eigen::Matrix2d::Identity();
  const double yaw_tolerance = std::sqrt(yaw_rad * yaw_rad + a.R(5, 5) + b.R(5, 5));
  return mahalanobis2d(d.head<2>(), C) <= 1.0 && std::abs(d[5]) <= yaw_tolerance;
}

struct Distance {
  std::size_t one, other;  ///< inputs
  double distance_m;       ///< horizontal
  double yaw_rad;
  bool abstains;   ///< one of them is external, and its covariance explains the distance
  bool expected;   ///< both know where they are, and their covariances say no better
  bool by_chance;  ///< one of them is external and does not know where it is: being near each other says nothing
};

/// How much a measurement's disagreement counts: in full, but only by its weight if the measurements of greater weight
/// outnumber it and those of no greater weight that agree with it.
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

std::vector<Distance> distancesBetween(const std::vector<FusionCandidate>& candidates, double agreement_distance_m) {
  std::vector<Distance> distances;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const FusionCandidate &a = candidates[i], &b = candidates[j];
      const Vector6d apart = stateDifference(a.z, b.z);
      const bool external = a.external || b.external;
      const Eigen::Matrix2d R_xy = a.R.topLeftCorner<2, 2>() + b.R.topLeftCorner<2, 2>();
      const bool explained_by_covariance = mahalanobis2d(apart.head<2>(), R_xy) <= kDisagreementSigmas;
      const bool known = R_xy.trace() <= agreement_distance_m * agreement_distance_m;
      distances.push_back({a.input, b.input, apart.head<2>().norm(), std::abs(apart[5]),
                           external && explained_by_covariance, explained_by_covariance && known, external && !known});
    }
  }
  return distances;
}

}  // namespace

void judgeDisagreement(const std::vector<FusionCandidate>& candidates, double agreement_distance_m,
                       FusionResult* result) {
  const std::vector<Distance> distances = distancesBetween(candidates, agreement_distance_m);
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
    result->disagreement_yaw_rad = std::max(result->disagreement_yaw_rad, d.yaw_rad);
    if (d.expected) continue;
    const double counts = std::min(credences[d.one], credences[d.other]);
    result->undecided_m = std::max(result->undecided_m, counts * d.distance_m);
    if (counts > 0.0) farthest_m = std::max(farthest_m, d.distance_m);
  }
  result->confirmed = any_agree && farthest_m < agreement_distance_m;
}

double mahalanobis2d(const Eigen::Vector2d& d, const Eigen::Matrix2d& C) {
  const auto eigen = symmetricEigen(C);
  const Eigen::Vector2d sigmas = eigen.eigenvalues().cwiseMax(kSmallestFusedVariance).cwiseSqrt();
  return (eigen.eigenvectors().transpose() * d).cwiseQuotient(sigmas).norm();
}

std::vector<std::size_t> largestAgreement(const std::vector<FusionCandidate>& candidates, double distance_m,
                                          double yaw_rad) {
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

}  // namespace fail_aware
