#include "core/aiding/road_profile_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kGateSigmas = 3.0;
constexpr double kSmallestEnergy = 1e-12;
constexpr double kLongestGap_s = 1.0;  // after it the speed is another, and the visible road has changed

// Subtracts the mean over a square of 2 half + 1 cells from every cell's height.
void subtractLocalMean(const std::vector<float>& sums, const std::vector<float>& weights, int nx, int ny, int half,
                       std::vector<float>& heights) {
  const auto at = [ny](int x, int y) { return static_cast<std::size_t>(x * (ny + 1) + y); };
  std::vector<double> S(static_cast<std::size_t>((nx + 1) * (ny + 1)), 0.0), W(S);
  // limits the weight of a cell relative to its neighbours, however many points it has
  constexpr float kMaxWeight = 1.0f / (0.0015f * 0.0015f);
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      const auto i = static_cast<std::size_t>(x * ny + y);
      const float w = std::min(weights[i], kMaxWeight);
      const float s = weights[i] > 0.0f ? sums[i] / weights[i] * w : 0.0f;
      S[at(x + 1, y + 1)] = s + S[at(x, y + 1)] + S[at(x + 1, y)] - S[at(x, y)];
      W[at(x + 1, y + 1)] = w + W[at(x, y + 1)] + W[at(x + 1, y)] - W[at(x, y)];
    }
  }
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      const auto i = static_cast<std::size_t>(x * ny + y);
      if (weights[i] <= 0.0f) continue;
      const int x0 = std::max(0, x - half), x1 = std::min(nx, x + half + 1);
      const int y0 = std::max(0, y - half), y1 = std::min(ny, y + half + 1);
      const auto sum = [&](const std::vector<double>& T) {
        return T[at(x1, y1)] - T[at(x0, y1)] - T[at(x1, y0)] + T[at(x0, y0)];
      };
      heights[i] = sums[i] / weights[i] - static_cast<float>(sum(S) / sum(W));
    }
  }
}

// The abscissa of the parabola through three equidistant values, relative to the middle one, in steps.
double parabolaPeak(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature < 0.0 ? std::clamp(0.5 * (left - right) / curvature, -1.0, 1.0) : 0.0;
}

}  // namespace

void RoadProfileOdometry::Params::checkRules() const {
  requireWithin("max_speed_mps", max_speed_mps, min_speed_mps, 100.0);
}

void RoadProfileOdometry::clear() {
  sweeps_.clear();
  directions_.clear();
  means_.clear();
  last_.reset();
}

void RoadProfileOdometry::forgetOldest() {
  for (const Sample& sample : sweeps_.front().samples) {
    Mean& mean = means_[sample.direction];
    mean.sum -= static_cast<double>(sample.height);
    --mean.count;
  }
  sweeps_.pop_front();
}

void RoadProfileOdometry::setYaw(double yaw_rad) {
  if (!sweeps_.empty()) sweeps_.back().yaw_rad = yaw_rad;
}

void RoadProfileOdometry::add(const CorrectedSweep& sweep, const Pose& T_cog_lidar, const Vector6d& twist_cog,
                              double yaw_rad) {
  const auto samples = sampleRoad(sweep, T_cog_lidar, twist_cog);
  if (!sweeps_.empty() && sweep.stamp_s - sweeps_.back().stamp_s > kLongestGap_s) clear();
  if (!samples) return clear();
  Record record;
  record.stamp_s = sweep.stamp_s;
  record.yaw_rad = yaw_rad;
  record.speed_mps = sweep.times_s.empty() ? 0.0 : twist_cog[0];
  record.samples.reserve(samples->size());
  for (const RoadSample& sample : *samples) {
    const auto [it, added] = directions_.try_emplace(sample.direction, static_cast<std::uint32_t>(means_.size()));
    if (added) means_.emplace_back();
    record.samples.push_back({it->second, sample.x, sample.y, sample.time_s, sample.height, sample.weight});
    means_[it->second].sum += static_cast<double>(sample.height);
    ++means_[it->second].count;
  }
  sweeps_.push_back(std::move(record));
  if (static_cast<int>(sweeps_.size()) > params_.window_sweeps) forgetOldest();
}

std::vector<RoadProfileOdometry::Layer> RoadProfileOdometry::layers() const {
  const int nx = 2 * static_cast<int>(std::ceil(kRoadRange_m / params_.cell_m));
  const int ny = 2 * static_cast<int>(std::ceil(kRoadHalfWidth_m / params_.cell_m));
  const auto cells = static_cast<std::size_t>(nx * ny);
  const int half = static_cast<int>(std::lround(params_.smoothing_m / params_.cell_m));
  const int min_count = std::max(3, static_cast<int>(sweeps_.size()) / 2);
  std::vector<float> sums(cells), weights(cells), times(cells), heights(cells);
  std::vector<Layer> layers;
  for (const Record& record : sweeps_) {
    std::fill(sums.begin(), sums.end(), 0.0f);
    std::fill(weights.begin(), weights.end(), 0.0f);
    std::fill(times.begin(), times.end(), 0.0f);
    for (const Sample& sample : record.samples) {
      const Mean& mean = means_[sample.direction];
      if (mean.count < min_count) continue;
      const float height = sample.height - static_cast<float>(mean.sum / mean.count);
      if (std::abs(height) > static_cast<float>(kRoadHeight_m)) continue;
      const int x = fastFloor(static_cast<double>(sample.x) / params_.cell_m) + nx / 2;
      const int y = fastFloor(static_cast<double>(sample.y) / params_.cell_m) + ny / 2;
      if (x < 0 || x >= nx || y < 0 || y >= ny) continue;
      const auto i = static_cast<std::size_t>(x * ny + y);
      sums[i] += sample.weight * height;
      weights[i] += sample.weight;
      times[i] += sample.weight * sample.time_s;
    }
    subtractLocalMean(sums, weights, nx, ny, half, heights);
    const double yaw = wrapAngle(record.yaw_rad - sweeps_.back().yaw_rad);
    Layer layer{sweeps_.back().stamp_s - record.stamp_s,
                std::cos(yaw),
                std::sin(yaw),
                std::tan(0.5 * yaw),
                record.speed_mps,
                {}};
    for (int x = 0; x < nx; ++x) {
      for (int y = 0; y < ny; ++y) {
        const auto i = static_cast<std::size_t>(x * ny + y);
        if (weights[i] <= 0.0f) continue;
        layer.cells.push_back({static_cast<float>((x - nx / 2 + 0.5) * params_.cell_m),
                               static_cast<float>((y - ny / 2 + 0.5) * params_.cell_m), times[i] / weights[i],
                               heights[i], weights[i]});
      }
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

RoadProfileOdometry::Score RoadProfileOdometry::score(const std::vector<Layer>& layers, double speed_mps,
                                                      double acceleration_mps2) const {
  // in the newest sweep's frame; with room for the path behind or ahead
  const auto place = [&](double age_s) { return -speed_mps * age_s + 0.5 * acceleration_mps2 * age_s * age_s; };
  double low = 0.0, high = 0.0, aside = 0.0;
  for (const Layer& layer : layers) {
    const double s = place(layer.age_s);
    low = std::min(low, s);
    high = std::max(high, s);
    aside = std::max(aside, std::abs(s * layer.tan_half_yaw) + kRoadRange_m * std::abs(layer.sin_yaw));
  }
  const double reach = kRoadRange_m + 2.0 * params_.cell_m + 0.1 * std::abs(speed_mps) + 5.0;
  aside = std::min(aside, 50.0) + kRoadHalfWidth_m + params_.cell_m;
  const double x0 = low - reach;
  const int nx = static_cast<int>((high - low + 2.0 * reach) / params_.cell_m) + 1;
  const int ny = static_cast<int>(2.0 * aside / params_.cell_m) + 1;
  // per cell: sum of w h, of w, of (w h)^2, number of sweeps
  grid_.assign(4 * static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), 0.0f);
  const auto inverse = static_cast<float>(1.0 / params_.cell_m);
  for (const Layer& layer : layers) {
    const double s = place(layer.age_s);
    const auto tx = static_cast<float>(s - x0), ty = static_cast<float>(s * layer.tan_half_yaw + aside);
    const auto c = static_cast<float>(layer.cos_yaw), sn = static_cast<float>(layer.sin_yaw);
    const auto faster = static_cast<float>(speed_mps - acceleration_mps2 * layer.age_s - layer.speed_mps);
    for (const Cell& cell : layer.cells) {
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
std::optional<double> RoadProfileOdometry::searchAllSpeeds(const std::vector<Layer>& layers) const {
  constexpr double kStep_mps = 0.5;
  std::vector<double> energies;
  for (double v = params_.min_speed_mps; v <= params_.max_speed_mps; v += kStep_mps) {
    energies.push_back(score(layers, v, 0.0).energy);
  }
  const auto best = std::max_element(energies.begin(), energies.end());
  if (!(*best > 0.0)) return std::nullopt;
  // outside the peak: where the first and last sweep of the window are more than a wave apart
  const double beside_mps = 2.0 * params_.smoothing_m / std::max(layers.front().age_s, 0.1) * 1.5;
  const auto k = best - energies.begin();
  for (std::size_t i = 0; i < energies.size(); ++i) {
    const bool aside = std::abs(static_cast<double>(i) - static_cast<double>(k)) * kStep_mps > beside_mps;
    if (aside && energies[i] > params_.max_second_peak * *best) return std::nullopt;
  }
  return params_.min_speed_mps + kStep_mps * static_cast<double>(k);
}

std::optional<RoadProfileOdometry::Speed> RoadProfileOdometry::findSpeed(double expected_mps,
                                                                         double expected_sigma_mps) {
  if (!params_.enabled || static_cast<int>(sweeps_.size()) < params_.min_sweeps) return std::nullopt;
  const std::vector<Layer> all = layers();
  const double span_s = all.front().age_s;
  double acceleration = 0.0, middle_mps = 0.0;
  if (last_) {
    acceleration = last_->acceleration_mps2;
    const double since_s = sweeps_.back().stamp_s - last_stamp_s_;
    middle_mps = last_->speed_mps + acceleration * (since_s - 0.5 * span_s);
  } else {
    const std::optional<double> found = searchAllSpeeds(all);
    if (!found) return std::nullopt;
    middle_mps = *found;
  }
  const auto scoreAt = [&](double middle, double a) { return score(all, middle + 0.5 * a * span_s, a); };
  // alternate between the speed in the middle of the window and the acceleration: they are nearly independent
  double speed_step = 0.5, acceleration_step = 1.0;
  for (int round = 0; round < 4; ++round) {
    for (double* value : {&middle_mps, &acceleration}) {
      double& step = value == &middle_mps ? speed_step : acceleration_step;
      const double was = *value;
      const auto energy = [&](double v) {
        *value = v;
        const double e = scoreAt(middle_mps, acceleration).energy;
        *value = was;
        return e;
      };
      const double left = energy(was - step), here = energy(was), right = energy(was + step);
      if (here >= left && here >= right) {
        *value = was + step * parabolaPeak(left, here, right);
        step *= 0.5;
      } else {
        *value = was + (left > right ? -step : step);
      }
    }
    acceleration = std::clamp(acceleration, -params_.max_acceleration_mps2, params_.max_acceleration_mps2);
  }
  Speed speed;
  speed.acceleration_mps2 = acceleration;
  speed.speed_mps = middle_mps + 0.5 * acceleration * span_s;
  const Score here = scoreAt(middle_mps, acceleration);
  const double opposite = scoreAt(-middle_mps, -acceleration).energy;
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
  last_stamp_s_ = sweeps_.back().stamp_s;
  return speed;
}

}  // namespace fail_aware
