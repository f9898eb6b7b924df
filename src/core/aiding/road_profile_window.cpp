#include "core/aiding/road_profile_window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kLongestGap_s = 1.0;   // after it the speed is another, and the visible road has changed
constexpr double kLeastOnASide = 0.3;   // of the weight on the other side
constexpr double kLeastVariance = 0.1;  // cells^2, of a line's places: below it the line has no slope

using Moments = Eigen::Array<double, 5, 1>;  // of w, w x, w x^2, w h, w x h

/// The heights' moments summed over all cells before (x, y).
std::vector<Moments> summedMoments(const std::vector<float>& sums, const std::vector<float>& weights, int nx, int ny) {
  // limits the weight of a cell relative to its neighbours, however many points it has
  constexpr float kMaxWeight = 1.0f / (0.0015f * 0.0015f);
  const auto at = [ny](int x, int y) { return static_cast<std::size_t>(x * (ny + 1) + y); };
  std::vector<Moments> table(static_cast<std::size_t>((nx + 1) * (ny + 1)), Moments::Zero());
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      const auto i = static_cast<std::size_t>(x * ny + y);
      const double w = static_cast<double>(std::min(weights[i], kMaxWeight));
      const double s = weights[i] > 0.0f ? static_cast<double>(sums[i] / weights[i]) * w : 0.0;
      Moments cell;
      cell << w, w * x, w * x * x, s, s * x;
      table[at(x + 1, y + 1)] = cell + table[at(x, y + 1)] + table[at(x + 1, y)] - table[at(x, y)];
    }
  }
  return table;
}

// Subtracts from every cell's height the line along x that fits a square of 2 half + 1 cells. Their mean would not do:
// most of what is seen lies on the sensor's side of a cell, so the profile would be shifted towards the sensor, by more
// the farther it is, and all distances would be 0.3 % too short. A cell that has nearly all of its square's weight on
// one side loses its own weight.
void subtractLocalLine(const std::vector<float>& sums, int nx, int ny, int half, std::vector<float>& weights,
                       std::vector<float>& heights) {
  const std::vector<Moments> table = summedMoments(sums, weights, nx, ny);
  const auto at = [&](int x, int y) -> const Moments& { return table[static_cast<std::size_t>(x * (ny + 1) + y)]; };
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      const auto i = static_cast<std::size_t>(x * ny + y);
      if (weights[i] <= 0.0f) continue;
      const int y0 = std::max(0, y - half), y1 = std::min(ny, y + half + 1);
      const auto sum = [&](int from, int to) -> Moments {
        return at(to, y1) - at(from, y1) - at(to, y0) + at(from, y0);
      };
      const int x0 = std::max(0, x - half), x1 = std::min(nx, x + half + 1);
      const Moments m = sum(x0, x1);
      const double mean_x = m[1] / m[0], mean = m[3] / m[0], variance = m[2] / m[0] - mean_x * mean_x;
      const double slope = variance > kLeastVariance ? (m[4] / m[0] - mean_x * mean) / variance : 0.0;
      heights[i] = sums[i] / weights[i] - static_cast<float>(mean + slope * (x - mean_x));
      const double behind = sum(x0, x)[0], ahead = sum(x + 1, x1)[0];
      if (std::min(behind, ahead) < kLeastOnASide * std::max(behind, ahead)) weights[i] = 0.0f;
    }
  }
}

}  // namespace

void RoadProfileWindow::clear() {
  sweeps_.clear();
  directions_.clear();
  means_.clear();
  path_is_set_ = false;
}

void RoadProfileWindow::add(const CorrectedSweep& sweep, const Pose& T_cog_lidar, const Vector6d& twist_cog,
                            const Pose& T_odom_cog) {
  const auto samples = sampleRoad(sweep, T_cog_lidar, twist_cog);
  if (!sweeps_.empty() && sweep.stamp_s - sweeps_.back().stamp_s > kLongestGap_s) clear();
  if (!samples) return clear();
  Record record;
  record.stamp_s = sweep.stamp_s;
  record.lidar_cog = T_cog_lidar.translation();
  record.T_odom_lidar = T_odom_cog * Eigen::Translation3d(record.lidar_cog);
  record.speed_mps = sweep.times_s.empty() ? 0.0 : twist_cog[0];
  record.samples.reserve(samples->size());
  for (const RoadSample& sample : *samples) {
    const auto [it, added] = directions_.try_emplace(sample.direction, static_cast<std::uint32_t>(means_.size()));
    if (added) means_.emplace_back();
    record.samples.push_back({it->second, sample.x, sample.y, sample.time_s, sample.height, sample.weight});
    means_[it->second].add(sample.height);
  }
  sweeps_.push_back(std::move(record));
  path_is_set_ = false;
  if (sweeps_.size() <= max_sweeps_) return;
  for (const Sample& sample : sweeps_.front().samples) means_[sample.direction].remove(sample.height);
  sweeps_.pop_front();
}

void RoadProfileWindow::setPose(const Pose& T_odom_cog, bool moves_all) {
  if (sweeps_.empty()) return;
  Record& newest = sweeps_.back();
  const Pose T_odom_predicted = newest.T_odom_lidar;
  newest.T_odom_lidar = T_odom_cog * Eigen::Translation3d(newest.lidar_cog);
  if (!std::exchange(path_is_set_, false) && !moves_all) return;
  const Pose T_new_old = newest.T_odom_lidar * T_odom_predicted.inverse();
  for (std::size_t k = 0; k + 1 < sweeps_.size(); ++k) sweeps_[k].T_odom_lidar = T_new_old * sweeps_[k].T_odom_lidar;
}

void RoadProfileWindow::setPath(double speed_mps, double acceleration_mps2) {
  if (sweeps_.empty()) return;
  const Record& newest = sweeps_.back();
  for (std::size_t k = 0; k + 1 < sweeps_.size(); ++k) {
    const double age_s = newest.stamp_s - sweeps_[k].stamp_s;
    const double distance_m = -speed_mps * age_s + 0.5 * acceleration_mps2 * age_s * age_s;
    const double yaw_rad = rpyFromRotation(relativePose(sweeps_[k]).linear()).z();
    Pose T_newest_this(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    T_newest_this.translation() << distance_m, distance_m * std::tan(0.5 * yaw_rad), 0.0;
    sweeps_[k].T_odom_lidar = newest.T_odom_lidar * T_newest_this;
    sweeps_[k].faster_mps = speed_mps - acceleration_mps2 * age_s - sweeps_[k].speed_mps;
  }
  path_is_set_ = true;
}

std::vector<RoadProfileWindow::Mean> RoadProfileWindow::meansWithout(const Record& from, double alike_m) const {
  std::vector<Mean> means = means_;
  for (const Record& record : sweeps_) {
    if ((record.T_odom_lidar.translation() - from.T_odom_lidar.translation()).norm() >= alike_m) continue;
    for (const Sample& sample : record.samples) means[sample.direction].remove(sample.height);
  }
  return means;
}

std::vector<RoadProfile::Cell> RoadProfileWindow::cells(const Record& record, const std::vector<Mean>& means) const {
  const int nx = 2 * static_cast<int>(std::ceil(kRoadRange_m / cell_m_));
  const int ny = 2 * static_cast<int>(std::ceil(kRoadHalfWidth_m / cell_m_));
  const int min_count = std::max(3, static_cast<int>(sweeps_.size()) / 2);
  std::vector<float> sums(static_cast<std::size_t>(nx * ny)), weights(sums), times(sums), heights(sums);
  for (const Sample& sample : record.samples) {
    const Mean& mean = means[sample.direction];
    if (mean.count < min_count) continue;
    const float height = sample.height - static_cast<float>(mean.sum / mean.count);
    if (std::abs(height) > static_cast<float>(kRoadHeight_m)) continue;
    const int x = fastFloor(static_cast<double>(sample.x) / cell_m_) + nx / 2;
    const int y = fastFloor(static_cast<double>(sample.y) / cell_m_) + ny / 2;
    if (x < 0 || x >= nx || y < 0 || y >= ny) continue;
    const auto i = static_cast<std::size_t>(x * ny + y);
    sums[i] += sample.weight * height;
    weights[i] += sample.weight;
    times[i] += sample.weight * sample.time_s;
  }
  subtractLocalLine(sums, nx, ny, static_cast<int>(std::lround(smoothing_m_ / cell_m_)), weights, heights);
  std::vector<RoadProfile::Cell> cells;
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      const auto i = static_cast<std::size_t>(x * ny + y);
      if (weights[i] <= 0.0f) continue;
      cells.push_back({static_cast<float>((x - nx / 2 + 0.5) * cell_m_),
                       static_cast<float>((y - ny / 2 + 0.5) * cell_m_), times[i] / weights[i], heights[i],
                       weights[i]});
    }
  }
  return cells;
}

std::vector<RoadProfile> RoadProfileWindow::profiles(double alike_m) const {
  std::vector<RoadProfile> profiles;
  for (std::size_t k = 0; k < sweeps_.size(); ++k) {
    const Record& record = sweeps_[k];
    RoadProfile profile;
    profile.age_s = sweeps_.back().stamp_s - record.stamp_s;
    profile.T_newest_this = relativePose(record);
    profile.speed_mps = record.speed_mps;
    profile.faster_mps = record.faster_mps;
    profile.cells = cells(record, alike_m > 0.0 ? meansWithout(record, alike_m) : means_);
    profiles.push_back(std::move(profile));
  }
  return profiles;
}

}  // namespace fail_aware
