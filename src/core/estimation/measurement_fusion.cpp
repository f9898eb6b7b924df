#include "core/estimation/measurement_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/estimation/largest_values.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

constexpr double kSmallestEigenvalue = 1e-14;  // of a correlation matrix: what double precision leaves
constexpr double kIndefinite = -1e-9;
constexpr double kGimbalLockCosine = 1e-3;

using Candidate = FusionCandidate;

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
  const Vector6d scale = C.diagonal().cwiseMax(kSmallestFusedVariance).cwiseSqrt();
  const Vector6d inverse_scale = scale.cwiseInverse();
  Matrix6d correlation = inverse_scale.asDiagonal() * symmetric(C) * inverse_scale.asDiagonal();
  correlation.diagonal().setOnes();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen = symmetricEigen(correlation);
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()[0] >= kIndefinite)) return std::nullopt;
  const Vector6d values = eigen.eigenvalues().cwiseMax(kSmallestEigenvalue);
  const Matrix6d half =
      inverse_scale.asDiagonal() * eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal();
  return Matrix6d(half * half.transpose());
}

std::optional<Candidate> makeCandidate(std::size_t index, const FusionInput& input) {
  const Measurement& measurement = *input.measurement;
  const Pose& T = measurement.T_odom_cog;
  if (!isFinite(T) || T.translation().cwiseAbs().maxCoeff() > kFarthestPose_m) return std::nullopt;
  const Matrix6d& C = measurement.covariance;
  if (!C.allFinite() || C.diagonal().minCoeff() < 0.0) return std::nullopt;

  Candidate candidate;
  candidate.input = index;
  candidate.external = input.kind == FusionInput::Kind::kExternal;
  candidate.z = vectorFromPose(T);
  if (!candidate.z.allFinite() || std::abs(std::cos(candidate.z[4])) < kGimbalLockCosine) return std::nullopt;
  const Matrix6d state_from_pose = inverseOf(poseFromStateJacobian(candidate.z.tail<3>()));
  const Matrix6d bounded = withBoundedVariances(symmetric(C));
  candidate.R = symmetric(Matrix6d(state_from_pose * bounded * state_from_pose.transpose()));
  const std::optional<Matrix6d> information = inverseOfCovariance(candidate.R);
  if (!information) return std::nullopt;
  candidate.information = *information;
  return candidate;
}

/// Against P~ + R, 6 degrees of freedom; -1: cannot be computed.
double nisOf(const Candidate& c, const Vector6d& predicted_state, const Matrix6d& P) {
  const std::optional<Matrix6d> inverse = inverseOfCovariance(P + c.R);
  if (!inverse) return -1.0;
  const Vector6d d = stateDifference(c.z, predicted_state);
  return d.dot(*inverse * d);
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
  result->R = (variances / total).cwiseMax(kSmallestFusedVariance).asDiagonal();
  result->has_measurement = true;
}

void fuseByInformation(const std::vector<Candidate>& candidates, FusionResult* result) {
  const Candidate& heaviest = *std::max_element(
      candidates.begin(), candidates.end(),
      [&](const Candidate& a, const Candidate& b) { return result->weights[a.input] < result->weights[b.input]; });
  double total = 0.0;
  int used = 0;
  for (const Candidate& c : candidates) {
    total += result->weights[c.input];
    used += result->weights[c.input] > 0.0 ? 1 : 0;
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

/// Whether `c` knows nothing that another one does not know a hundred times better, in every direction.
bool addsNothing(const Candidate& c, const std::vector<Candidate>& candidates, const std::vector<double>& weights) {
  constexpr double kVaguer = 1e4;  // of the variances
  return std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
    return weights[other.input] > 0.0 && (c.R.diagonal().array() >= kVaguer * other.R.diagonal().array()).all();
  });
}

// The gate of a registration is horizontal: it starts at the prediction, so its height and yaw are near it. A pose from
// elsewhere may have another datum of height, or a compass of its own.
double externalSigmas(const Vector6d& d, const Matrix6d& covariance) {
  constexpr double kDatum_m = 1.0;  // odom's height drifts, and datums differ by that much
  return std::max(std::abs(d[2]) / std::sqrt(covariance(2, 2) + kDatum_m * kDatum_m),
                  std::abs(d[5]) / std::sqrt(covariance(5, 5)));
}

void weigh(const MeasurementFusion& params, const std::vector<Candidate>& candidates, const Vector6d& predicted_state,
           const Matrix6d& P, FusionResult* result) {
  for (const Candidate& c : candidates) {
    const Vector6d d = stateDifference(c.z, predicted_state);
    result->nis[c.input] = nisOf(c, predicted_state, P);
    const Eigen::Matrix2d P_xy = P.topLeftCorner<2, 2>();
    const Eigen::Matrix2d gate = params.literal ? Eigen::Matrix2d(P_xy.diagonal().asDiagonal())
                                                : Eigen::Matrix2d(P_xy + c.R.topLeftCorner<2, 2>());
    double sigmas = mahalanobis2d(d.head<2>(), gate);
    if (c.external && !params.literal) sigmas = std::max(sigmas, externalSigmas(d, P + c.R));
    const double w = 1.0 - sigmas / params.gate_sigma;
    const bool inside = w > 0.0 && (params.literal || w >= params.min_weight);
    (inside ? result->weights : result->refused_sigmas)[c.input] = inside ? w : sigmas;
  }
}

// Where most of the largest group that agrees are outside the gate, and all that are inside belong to it.
void overrule(const MeasurementFusion& params, const std::vector<Candidate>& candidates, FusionResult* result) {
  const auto isInside = [&](const Candidate& c) { return result->weights[c.input] > 0.0; };
  const auto inside = std::count_if(candidates.begin(), candidates.end(), isInside);
  if (inside == static_cast<std::ptrdiff_t>(candidates.size())) return;
  const std::vector<std::size_t> group =
      largestAgreement(candidates, params.agreement_distance_m, params.agreement_yaw_deg * kDegree);
  const auto members_inside =
      std::count_if(group.begin(), group.end(), [&](std::size_t member) { return isInside(candidates[member]); });
  const auto members_outside = static_cast<std::ptrdiff_t>(group.size()) - members_inside;
  if (members_inside < inside || members_outside < 2 || members_outside <= members_inside) return;
  result->prediction_overruled = true;
  for (const std::size_t member : group) result->weights[candidates[member].input] = 1.0;
}

/// The weight of a motion or a partial measurement; nullopt outside the gate (distance to the prediction under P + R).
/// Sets the input's NIS.
std::optional<double> weightInGate(const MeasurementFusion& params, const Candidate& c, const Vector6d& predicted_state,
                                   const Matrix6d& P, FusionResult* result) {
  const double nis = result->nis[c.input] = nisOf(c, predicted_state, P);
  const double w = 1.0 - std::sqrt(std::max(0.0, nis)) / params.gate_sigma;
  if (nis < 0.0 || w < params.min_weight) return std::nullopt;
  return w;
}

void addPartial(const MeasurementFusion& params, const std::vector<Candidate>& partial, const Vector6d& predicted_state,
                const Matrix6d& P, FusionResult* result) {
  for (const Candidate& c : partial) {
    const std::optional<double> w = weightInGate(params, c, predicted_state, P, result);
    const std::optional<Matrix6d> fused = inverseOfCovariance(result->R);
    if (!fused || !w) continue;
    const std::optional<Matrix6d> R = inverseOfCovariance(*fused + c.information);
    if (!R) continue;
    result->weights[c.input] = *w;
    result->z += *R * c.information * stateDifference(c.z, result->z);
    result->R = *R;
  }
}

}  // namespace

void MeasurementFusion::checkRules() const {
  requireParameter(std::isfinite(min_weight) && min_weight >= 0.0 && min_weight < 1.0, "min_weight", min_weight,
                   "in [0, 1)");
}

FusionResult MeasurementFusion::fuseMotion(const Vector6d& predicted_state, const Matrix6d& Q,
                                           const std::vector<FusionInput>& inputs) const {
  FusionResult result;
  result.weights.assign(inputs.size(), 0.0);
  result.nis.assign(inputs.size(), -1.0);
  result.refused_sigmas.assign(inputs.size(), 0.0);
  if (!predicted_state.allFinite() || !inverseOfCovariance(Q)) return result;
  Matrix6d information = Matrix6d::Zero();
  Vector6d information_d = Vector6d::Zero();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].kind != FusionInput::Kind::kMotion || !inputs[i].usable()) continue;
    const std::optional<Candidate> c = makeCandidate(i, inputs[i]);
    if (!c) {
      result.refused_sigmas[i] = std::numeric_limits<double>::infinity();
      ++result.invalid_inputs;
      continue;
    }
    ++result.valid_inputs;
    const std::optional<double> w = weightInGate(*this, *c, predicted_state, Q, &result);
    if (!w) continue;
    result.weights[i] = *w;
    information += c->information;
    information_d += c->information * stateDifference(c->z, predicted_state);
  }
  const std::optional<Matrix6d> R = inverseOfCovariance(information);
  if (R && !information.isZero(0.0)) result.motion = {stateSum(predicted_state, *R * information_d), *R};
  return result;
}

FusionResult MeasurementFusion::fuse(const Vector6d& predicted_state, const Matrix6d& predicted_P,
                                     const std::vector<FusionInput>& inputs, FusionResult result) const {
  result.weights.resize(inputs.size(), 0.0);
  result.nis.resize(inputs.size(), -1.0);
  result.refused_sigmas.resize(inputs.size(), 0.0);
  if (!predicted_state.allFinite() || predicted_state.head<3>().cwiseAbs().maxCoeff() > kFarthestPose_m ||
      !inverseOfCovariance(predicted_P)) {
    result.prediction_invalid = true;
    return result;
  }
  const Matrix6d P = withBoundedVariances(symmetric(predicted_P));
  result.z = predicted_state;
  result.R = P;

  std::vector<Candidate> candidates, partial;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!inputs[i].usable() || inputs[i].kind == FusionInput::Kind::kMotion) continue;
    const std::optional<Candidate> candidate = makeCandidate(i, inputs[i]);
    if (candidate && stateDifference(candidate->z, predicted_state).head<3>().norm() <= kFarthestOff_m) {
      (inputs[i].kind == FusionInput::Kind::kPartial ? partial : candidates).push_back(*candidate);
    } else {
      result.refused_sigmas[i] = std::numeric_limits<double>::infinity();
      ++result.invalid_inputs;
    }
  }
  result.valid_inputs += static_cast<int>(candidates.size() + partial.size());

  weigh(*this, candidates, predicted_state, P, &result);
  const bool any_inside = std::any_of(candidates.begin(), candidates.end(),
                                      [&](const Candidate& c) { return result.weights[c.input] > 0.0; });
  result.all_gated_out = !candidates.empty() && !any_inside;

  if (!literal) {
    overrule(*this, candidates, &result);
    for (const Candidate& c : candidates) {
      if (addsNothing(c, candidates, result.weights)) result.weights[c.input] = 0.0;
    }
  }
  if (any_inside && literal) fuseLiteral(candidates, predicted_state, &result);
  if ((any_inside || result.prediction_overruled) && !literal) fuseByInformation(candidates, &result);
  if (result.has_measurement) addPartial(*this, partial, predicted_state, P, &result);
  result.z = wrapAngles(result.z);
  judgeDisagreement(candidates, agreement_distance_m, &result);
  return result;
}

}  // namespace fail_aware
