#include "core/aiding/road_profile_odometry.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kGateSigmas = 3.0;
constexpr double kLastIsNear_s = 0.5;  // with it the acceleration is known
constexpr double kSmallestEnergy = 1e-12;
constexpr std::size_t kFewestSweeps = 6;  // of a mean by direction, for a place

// The abscissa of the parabola through three equidistant values, relative to the middle one, in steps.
double parabolaPeak(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature < 0.0 ? std::clamp(0.5 * (left - right) / curvature, -1.0, 1.0) : 0.0;
}

// A profile's yaw relative to the newest one, as the overlay of score() uses it.
struct Heading {
  double cos_yaw, sin_yaw, tan_half_yaw;
};

Heading headingOf(const RoadProfile& profile) {
  const double yaw_rad = rpyFromRotation(profile.T_newest_this.linear()).z();
  return {std::cos(yaw_rad), std::sin(yaw_rad), std::tan(0.5 * yaw_rad)};
}

}  // namespace

void RoadProfileOdometry::Params::checkRules() const {
  requireWithin("max_speed_mps", max_speed_mps, min_speed_mps, 100.0);
}

void RoadProfileOdometry::clear() {
  window_.clear();
  last_.reset();
}

RoadProfileOdometry::Score RoadProfileOdometry::score(const std::vector<RoadProfile>& profiles,
                                                      const MiddleMotion& motion) const {
  const double acceleration_mps2 = motion.acceleration_mps2;
  const double speed_mps = motion.speed_mps + 0.5 * acceleration_mps2 * profiles.front().age_s;
  // in the newest sweep's frame; with room for the path behind or ahead
  const auto place = [&](double age_s) { return -speed_mps * age_s + 0.5 * acceleration_mps2 * age_s * age_s; };
  double low = 0.0, high = 0.0, aside = 0.0;
  for (const RoadProfile& profile : profiles) {
    const Heading heading = headingOf(profile);
    const double s = place(profile.age_s);
    low = std::min(low, s);
    high = std::max(high, s);
    aside = std::max(aside, std::abs(s * heading.tan_half_yaw) + kRoadRange_m * std::abs(heading.sin_yaw));
  }
  const double reach = kRoadRange_m + 2.0 * params_.cell_m + 0.1 * std::abs(speed_mps) + 5.0;
  aside = std::min(aside, 50.0) + kRoadHalfWidth_m + params_.cell_m;
  const double x0 = low - reach;
  const int nx = static_cast<int>((high - low + 2.0 * reach) / params_.cell_m) + 1;
  const int ny = static_cast<int>(2.0 * aside / params_.cell_m) + 1;
  // per cell: sum of w h, of w, of (w h)^2, number of sweeps
  grid_.assign(4 * static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), 0.0f);
  const auto inverse = static_cast<float>(1.0 / params_.cell_m);
  for (const RoadProfile& profile : profiles) {
    const Heading heading = headingOf(profile);
    const double s = place(profile.age_s);
    const auto tx = static_cast<float>(s - x0), ty = static_cast<float>(s * heading.tan_half_yaw + aside);
    const auto c = static_cast<float>(heading.cos_yaw), sn = static_cast<float>(heading.sin_yaw);
    const auto faster = static_cast<float>(speed_mps - acceleration_mps2 * profile.age_s - profile.speed_mps);
    for (const RoadProfile::Cell& cell : profile.cells) {
      const float x = cell.x + faster * cell.time_s;
      const auto ix = static_cast<int>((c * x - sn * cell.y + tx) * inverse);
      const auto iy = static_cast<int>((sn * x + c * cell.y + ty) * inverse);
      if (ix < 0 || ix >= nx || iy < 0 || iy >= ny) continue;
      float* sum = &grid_[4 * static_cast<std::size_t>(ix * ny + iy)];
      const float wh = cell.weight * cell.height;
      sum[0] += wh;
      sum[1] += cell.weight;
      sum[2] += wh * wh;
      sum[3] += 1.0f;
    }
  }
  Score score;
  double largest = 0.0;  // the energy if all sweeps were equal
  const auto prior = static_cast<float>(1.0 / (params_.profile_sigma_m * params_.profile_sigma_m));
  for (std::size_t i = 0; i < grid_.size(); i += 4) {
    if (grid_[i + 3] < 2.0f) continue;
    const float weight = 1.0f / (grid_[i + 1] + prior);
    score.energy += static_cast<double>((grid_[i] * grid_[i] - grid_[i + 2]) * weight);
    largest += static_cast<double>(grid_[i + 2] * (grid_[i + 3] - 1.0f) * weight);
  }
  score.correlation = largest > 0.0 ? score.energy / largest : 0.0;
  return score;
}

// The speed in the middle of the window, if one peak is distinct.
std::optional<double> RoadProfileOdometry::searchAllSpeeds(const std::vector<RoadProfile>& profiles) const {
  constexpr double kStep_mps = 0.5;
  std::vector<double> energies;
  for (double v = params_.min_speed_mps; v <= params_.max_speed_mps; v += kStep_mps) {
    energies.push_back(score(profiles, {v, 0.0}).energy);
  }
  const auto best = std::max_element(energies.begin(), energies.end());
  if (!(*best > 0.0)) return std::nullopt;
  // outside the peak: where the first and last sweep of the window are more than a wave apart
  const double beside_mps = 2.0 * params_.smoothing_m / std::max(profiles.front().age_s, 0.1) * 1.5;
  const auto k = best - energies.begin();
  for (std::size_t i = 0; i < energies.size(); ++i) {
    const bool aside = std::abs(static_cast<double>(i) - static_cast<double>(k)) * kStep_mps > beside_mps;
    if (aside && energies[i] > params_.max_second_peak * *best) return std::nullopt;
  }
  return params_.min_speed_mps + kStep_mps * static_cast<double>(k);
}

// Alternates between the speed in the middle of the window and the acceleration: they are nearly independent.
void RoadProfileOdometry::climb(const std::vector<RoadProfile>& profiles, MiddleMotion& motion) const {
  double speed_step = 0.5, acceleration_step = 1.0;
  for (int round = 0; round < 4; ++round) {
    for (double* value : {&motion.speed_mps, &motion.acceleration_mps2}) {
      double& step = value == &motion.speed_mps ? speed_step : acceleration_step;
      const double was = *value;
      const auto correlation = [&](double v) {  // the energy falls with the speed: less road is seen twice
        *value = v;
        return score(profiles, motion).correlation;
      };
      const double left = correlation(was - step), here = correlation(was), right = correlation(was + step);
      if (here >= left && here >= right) {
        *value = was + step * parabolaPeak(left, here, right);
        step *= 0.5;
      } else {
        *value = was + (left > right ? -step : step);
      }
    }
    motion.acceleration_mps2 =
        std::clamp(motion.acceleration_mps2, -params_.max_acceleration_mps2, params_.max_acceleration_mps2);
  }
}

std::optional<RoadProfileOdometry::Speed> RoadProfileOdometry::findSpeed(double expected_mps,
                                                                         double expected_sigma_mps) {
  if (!params_.enabled || static_cast<int>(window_.size()) < params_.min_sweeps) return std::nullopt;
  const std::vector<RoadProfile> all = window_.profiles(0.0);
  const double span_s = all.front().age_s;
  MiddleMotion motion;
  const double since_s = window_.newestStamp_s() - last_stamp_s_;
  if (last_ && since_s <= kLastIsNear_s) {
    motion.acceleration_mps2 = last_->acceleration_mps2;
    motion.speed_mps = last_->speed_mps + last_->acceleration_mps2 * (since_s - 0.5 * span_s);
  } else if (std::isfinite(expected_sigma_mps)) {
    motion.speed_mps = expected_mps;
  } else {
    const std::optional<double> found = searchAllSpeeds(all);
    if (!found) return std::nullopt;
    motion.speed_mps = *found;
  }
  climb(all, motion);
  Speed speed;
  speed.acceleration_mps2 = motion.acceleration_mps2;
  speed.speed_mps = motion.speed_mps + 0.5 * motion.acceleration_mps2 * span_s;
  const Score here = score(all, motion);
  const double opposite = score(all, {-motion.speed_mps, -motion.acceleration_mps2}).energy;
  const double mirrored = std::max(0.0, opposite / std::max(here.energy, kSmallestEnergy));
  speed.sigma_mps = std::hypot(params_.speed_sigma_mps, params_.mirrored_sigma_mps * mirrored);
  // The result's own sigma is not part of the tolerance: the next results share all sweeps but one, and the filter
  // would follow them all.
  const double tolerance_mps = kGateSigmas * std::hypot(expected_sigma_mps, params_.speed_sigma_mps);
  if (here.correlation < params_.min_correlation || std::abs(speed.speed_mps - expected_mps) > tolerance_mps) {
    last_.reset();
    return std::nullopt;
  }
  last_ = speed;
  last_stamp_s_ = window_.newestStamp_s();
  return speed;
}

std::optional<RoadPlace> RoadProfileOdometry::findPlace(double expected_sigma_m) const {
  constexpr double kLeastRange_m = 0.3, kLargestRange_m = 1.2;  // the profile repeats itself after a wave or two
  if (!params_.enabled || window_.size() < kFewestSweeps) return std::nullopt;
  const double range_m = std::max(kGateSigmas * expected_sigma_m, kLeastRange_m);
  if (range_m > kLargestRange_m) return std::nullopt;
  return findRoadPlace(window_.profiles(kAlike_m), params_.cell_m, params_.profile_sigma_m, range_m);
}

}  // namespace fail_aware
