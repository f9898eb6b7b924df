#include "simulation/speed_profile.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kLookStep_m = 3.0;
constexpr double kStopped_mps = 0.15, kAtStop_m = 3.0;
constexpr double kFirstStop_m = 60.0;
constexpr double kShortestWait_s = 2.0, kLongestWait_s = 6.0;

}  // namespace

void SpeedProfile::Params::validate() const {
  requireWithin("speed_mps", speed_mps, 0.0, 60.0);
  requirePositive("lateral_mps2", lateral_mps2);
  requirePositive("brake_mps2", brake_mps2);
}

double SpeedProfile::limit(const Road& road, double s_m) const {
  const double own = params_.speed_mps > 0.0 ? params_.speed_mps : roadCharacter(road.kindAt(s_m)).speed_mps;
  const double curvature = std::abs(road.at(s_m).curvature_per_m);
  return curvature < 1e-6 ? own : std::min(own, std::sqrt(params_.lateral_mps2 / curvature));
}

void SpeedProfile::planStop(const Road& road, double s_m) {
  if (has_stop_ && s_m < next_stop_m_ + 5.0) return;
  const double spacing_m = roadCharacter(road.kindAt(s_m)).stop_spacing_m;
  has_stop_ = spacing_m > 0.0;
  if (!has_stop_) return;
  next_stop_m_ = std::max(s_m, 0.0) + kFirstStop_m + spacing_m * random_.uniform(0.3, 1.1);
  wait_s_ = random_.uniform(kShortestWait_s, kLongestWait_s);
  wait_until_s_ = -1.0;
}

double SpeedProfile::target(const Road& road, double s_m, double speed_mps, double t_s) {
  planStop(road, s_m);
  double target = limit(road, s_m);
  const double reach_m = speed_mps * speed_mps / (2.0 * params_.brake_mps2) + 10.0;
  const int steps = static_cast<int>(std::ceil(reach_m / kLookStep_m)) - 1;
  for (int step = 1; step <= steps; ++step) {
    const double d = kLookStep_m * step;
    const double there = limit(road, s_m + d);
    target = std::min(target, std::sqrt(there * there + 2.0 * params_.brake_mps2 * d));
  }
  if (!has_stop_ || roadCharacter(road.kindAt(next_stop_m_)).stop_spacing_m == 0.0) return target;
  const double to_stop_m = next_stop_m_ - s_m;
  if (wait_until_s_ < 0.0 && to_stop_m < kAtStop_m && speed_mps < kStopped_mps) wait_until_s_ = t_s + wait_s_;
  if (wait_until_s_ >= 0.0) return t_s >= wait_until_s_ ? target : 0.0;
  return std::min(target, std::sqrt(2.0 * params_.brake_mps2 * std::max(0.0, to_stop_m - 1.0)));
}

}  // namespace fail_aware
