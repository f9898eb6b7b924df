#include "core/preprocessing/vertical_reference.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/preprocessing/lean_weights.hpp"
#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr double kStartTilt = 0.1;       // rad: mount and slope at the start
constexpr double kFewBeams = 16.0;       // of the head that new_map_tilt_deg was found with
constexpr std::size_t kUsualBeams = 64;  // of sweeps without rings
constexpr int kReweightings = 5;
constexpr std::size_t kMinProfiles = 6;
// A look changes e by sqrt(P_before - P_after), one sigma. One that changes it by more than three contradicts itself:
// where hedges lean in all directions, e became 0.44 deg in the first look, and the road rose by 6 m in 100 m.
constexpr double kMostSigmas = 3.0, kRounding_rad2 = 1e-14;
// The tilt since the start is corrected over this ratio of the distance since then, within limits: near the start it is
// known to some hundredths of a degree, later registration knows the tilt over 100 m better than
// upright objects show it.
constexpr double kCorrectionRatio = 0.25, kShortestCorrection_m = 20.0, kLongestCorrection_m = 100.0;
// The map still has e in it, so e is corrected over this distance; and by at most so many sigmas of the prior.
constexpr double kElevationCorrection_m = 20.0, kMostElevationSigmas = 5.0;
constexpr double kShortestStep_m = 0.1;  // below, the jitter of the pose at standstill decides the direction

}  // namespace

VerticalReference::VerticalReference(const Params& params, double sigma_elevation_deg)
    : params_(params), sigma_elevation_rad_(sigma_elevation_deg * kDegree) {
  reset();
}

void VerticalReference::reset() {
  report_ = Report();
  tilt_moment_.setZero();
  correction_ = {};
  x_.setZero(VerticalState::kBeams);
  P_.setZero(VerticalState::kBeams, VerticalState::kBeams);
  x_[VerticalState::kDriftPerElevation] = params_.drift_per_elevation_per_m;
  const auto setSigma = [&](Eigen::Index i, double sigma) { P_(i, i) = sigma * sigma; };
  setSigma(VerticalState::kElevation, sigma_elevation_rad_);
  setSigma(VerticalState::kDriftPerElevation, params_.sigma_drift_per_elevation_per_m);
  setSigma(VerticalState::kOtherDrift, params_.sigma_other_drift_deg_per_m * kDegree);
  ranges_.clear();
  forgetOdom();
  beams_ = 0;
  odom_reset_count_ = 0;
}

/// What is known about odom's axes: the tilt, which begins as that of the start. The map begins anew, too.
void VerticalReference::forgetOdom() {
  x_.head<4>().setZero();
  P_.topRows<4>().setZero();
  P_.leftCols<4>().setZero();
  for (const Eigen::Index axis : {0, 1}) {  // the same now and at the start
    const Eigen::Index now = VerticalState::kTilt + axis, start = VerticalState::kStart + axis;
    for (const auto& [row, column] : {std::pair(now, now), {now, start}, {start, now}, {start, start}}) {
      P_(row, column) = kStartTilt * kStartTilt;
    }
  }
  last_position_odom_.reset();
  pitch_axis_.setZero();
  since_look_m_ = params_.look_every_m;
  since_start_m_ = 0.0;
}

void VerticalReference::apply(std::vector<Eigen::Vector3f>& points_lidar) const {
  correctVerticalAngle(correction_.raise_rad, points_lidar);
  if (correction_.curvature_per_m == 0.0) return;
  const auto half_curvature = static_cast<float>(0.5 * correction_.curvature_per_m);
  const auto reach = static_cast<float>(params_.curvature_range_m);
  changeBlocks(points_lidar, [&](PointBlock& p) {
    const PointBlock::Array h = (p.x * p.x + p.y * p.y).sqrt();
    p.z += half_curvature * h * h.min(reach);
  });
}

void VerticalReference::observe(const std::vector<Eigen::Vector3f>& points_lidar,
                                const std::vector<std::uint16_t>& rings, const Pose& T_odom_lidar,
                                int odom_reset_count) {
  if (!params_.enabled || !isFinite(T_odom_lidar)) return;
  if (odom_reset_count != odom_reset_count_) forgetOdom();
  odom_reset_count_ = odom_reset_count;
  for (const std::uint16_t ring : rings) {
    if (ring < UprightProfileFinder::kMaxBeams) beams_ = std::max(beams_, std::size_t{1} + ring);
  }
  const double distance_m = advance(T_odom_lidar);
  if (since_look_m_ >= params_.look_every_m) {
    since_look_m_ = 0.0;
    beginLook();
    finder_.find(points_lidar, rings, ranges_, T_odom_lidar.linear());
    resizeBeams();
    update();
    ++report_.looks;
  }
  setRaise(distance_m);
  setBend();
}

/// How far the vehicle moved.
double VerticalReference::advance(const Pose& T_odom_lidar) {
  const Eigen::Vector3d position = T_odom_lidar.translation();
  if (!last_position_odom_) last_position_odom_ = position;
  const Eigen::Vector3d step = position - *last_position_odom_;
  const double distance_m = step.norm();
  if (distance_m < kShortestStep_m) return 0.0;
  last_position_odom_ = position;
  since_look_m_ += distance_m;
  // The bend is the same on all sides: it pitches the estimate about the axis across the motion, however the sensor is
  // turned on the vehicle, and the other way round in reverse.
  const Eigen::Vector2d turned = T_odom_lidar.linear().col(2).cross(step).head<2>();
  pitch_axis_ = turned / std::max(turned.norm(), 1e-9);
  move(turned);
  // a new map is sparse
  const double in_new_map_m = std::clamp(params_.new_map_m - since_start_m_, 0.0, distance_m);
  since_start_m_ += distance_m;
  const auto beams = static_cast<double>(beams_ > 0 ? beams_ : kUsualBeams);
  const double new_map_tilt = params_.new_map_tilt_deg * kDegree * std::pow(kFewBeams / beams, 2);
  P_.diagonal().head<2>().array() += distance_m * std::pow(params_.tilt_walk_deg * kDegree, 2) +
                                     in_new_map_m / params_.new_map_m * new_map_tilt * new_map_tilt;
  P_(VerticalState::kOtherDrift, VerticalState::kOtherDrift) +=
      distance_m * std::pow(params_.drift_walk_deg_per_m * kDegree, 2);
  P_.diagonal().tail(x_.size() - VerticalState::kBeams).array() +=
      distance_m * params_.range_walk_m * params_.range_walk_m;
  return distance_m;
}

double VerticalReference::drift() const {
  return x_[VerticalState::kDriftPerElevation] * x_[VerticalState::kElevation] + x_[VerticalState::kOtherDrift];
}

Eigen::VectorXd VerticalReference::driftGradient() const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(x_.size());
  gradient[VerticalState::kElevation] = x_[VerticalState::kDriftPerElevation];
  gradient[VerticalState::kDriftPerElevation] = x_[VerticalState::kElevation];
  gradient[VerticalState::kOtherDrift] = 1.0;
  return gradient;
}

/// turned: change of the tilt on this step at a drift of 1 rad/m.
void VerticalReference::move(const Eigen::Vector2d& turned) {
  const Eigen::VectorXd gradient = driftGradient();
  x_.head<2>() += (drift() - params_.response * correction_.curvature_per_m) * turned;
  P_.topRows<2>() += turned * (gradient.transpose() * P_);
  P_.leftCols<2>() += (P_ * gradient) * turned.transpose();
}

void VerticalReference::beginLook() {
  for (const Eigen::Index i : {VerticalState::kJitter, VerticalState::kJitter + 1}) {
    x_[i] = 0.0;
    P_.row(i).setZero();
    P_.col(i).setZero();
    P_(i, i) = std::pow(params_.jitter_deg * kDegree, 2);
  }
  ranges_.resize(static_cast<std::size_t>(x_.size() - VerticalState::kBeams));
  for (std::size_t ring = 0; ring < ranges_.size(); ++ring) {
    const Eigen::Index i = VerticalState::kBeams + static_cast<Eigen::Index>(ring);
    ranges_[ring] = {static_cast<float>(x_[i]), static_cast<float>(std::sqrt(P_(i, i)))};
  }
}

void VerticalReference::resizeBeams() {
  Eigen::Index size = x_.size();
  for (const UprightProfile::Beam& beam : finder_.beams()) {
    size = std::max(size, VerticalState::kBeams + static_cast<Eigen::Index>(beam.ring) + 1);
  }
  const Eigen::Index added = size - x_.size();
  if (added == 0) return;
  x_.conservativeResize(size);
  x_.tail(added).setZero();
  P_.conservativeResize(size, size);
  P_.rightCols(added).setZero();
  P_.bottomRows(added).setZero();
  P_.diagonal().tail(added).setConstant(params_.sigma_range_m * params_.sigma_range_m);
}

void VerticalReference::update() {
  std::vector<ProfileEquations> all;
  for (const UprightProfile& profile : finder_.profiles()) all.emplace_back(profile, finder_.beams(), ranges_, P_);
  if (all.size() < kMinProfiles) return;
  const Eigen::VectorXd prior = x_;
  const Eigen::Index size = x_.size();
  Eigen::MatrixXd information, gain;
  for (int iteration = 0; iteration < kReweightings; ++iteration) {
    information.setZero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    const LeanWeights weights = leanWeights(finder_.profiles(), all, x_, iteration == 0 ? &P_ : nullptr);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const ProfileEquations& e = all[k];
      const double weight = weights.kernel[k] / params_.correlation_inflation;
      const double lean_weight = weights.lean[k] / params_.correlation_inflation;
      const Eigen::VectorXd at = e.pick(prior);
      const Eigen::MatrixXd H =
          lean_weight * e.lean * e.lean.transpose() + weight * e.straight.transpose() * e.straight;
      const Eigen::VectorXd r = lean_weight * e.lean * (e.lean_value - e.lean.dot(at)) +
                                weight * e.straight.transpose() * (e.straight_values - e.straight * at);
      for (std::size_t i = 0; i < e.of.size(); ++i) {
        right[e.of[i]] += r[static_cast<Eigen::Index>(i)];
        for (std::size_t j = 0; j < e.of.size(); ++j) {
          information(e.of[i], e.of[j]) += H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        }
      }
    }
    const Eigen::MatrixXd M = Eigen::MatrixXd::Identity(size, size) + P_ * information;
    gain = M.partialPivLu().solve(P_);
    x_ = prior + gain * right;
  }
  const Eigen::Index e = VerticalState::kElevation;
  const double change = x_[e] - prior[e], learnt = P_(e, e) - gain(e, e);
  const bool contradicts = change * change > kMostSigmas * kMostSigmas * std::max(learnt, 0.0) + kRounding_rad2;
  if (!x_.allFinite() || !gain.allFinite() || contradicts) {
    x_ = prior;
    return;
  }
  P_ = symmetric(gain);
}

void VerticalReference::setRaise(double distance_m) {
  double& left_rad = x_[VerticalState::kElevation];
  const double limit = kMostElevationSigmas * sigma_elevation_rad_, before = correction_.raise_rad;
  const double wanted = before + left_rad * std::min(1.0, distance_m / kElevationCorrection_m);
  correction_.raise_rad = std::clamp(wanted, -limit, limit);
  left_rad -= correction_.raise_rad - before;
}

void VerticalReference::setBend() {
  const Eigen::Vector2d tilt = x_.head<2>() - x_.segment<2>(VerticalState::kStart);
  const Eigen::Matrix2d cross = P_.block<2, 2>(0, VerticalState::kStart);
  const Eigen::Matrix2d covariance = P_.topLeftCorner<2, 2>() +
                                     P_.block<2, 2>(VerticalState::kStart, VerticalState::kStart) - cross -
                                     cross.transpose();
  const double limit = params_.max_curvature_deg_per_m * kDegree;
  const double correction_m =
      std::clamp(kCorrectionRatio * since_start_m_, kShortestCorrection_m, kLongestCorrection_m);
  const double unwanted = drift() + pitch_axis_.dot(tilt) / correction_m;
  correction_.curvature_per_m = std::clamp(unwanted / params_.response, -limit, limit);
  report_.tilt_deg = pitch_axis_.dot(tilt) / kDegree;
  report_.tilt_sigma_deg = std::sqrt(std::max(pitch_axis_.dot(covariance * pitch_axis_), 0.0)) / kDegree;
  const Eigen::VectorXd gradient = driftGradient();
  report_.drift_deg_per_m = drift() / kDegree;
  report_.drift_sigma_deg_per_m = std::sqrt(std::max(gradient.dot(P_ * gradient), 0.0)) / kDegree;
  report_.elevation_deg = (correction_.raise_rad + x_[VerticalState::kElevation]) / kDegree;
  report_.elevation_sigma_deg = std::sqrt(P_(VerticalState::kElevation, VerticalState::kElevation)) / kDegree;
  report_.curvature_deg_per_m = correction_.curvature_per_m / kDegree;
  tilt_moment_ = covariance + tilt * tilt.transpose();
}

}  // namespace fail_aware
