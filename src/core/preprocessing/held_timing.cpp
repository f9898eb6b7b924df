#include "core/preprocessing/held_timing.hpp"

#include <cmath>
#include <complex>

#include "core/geometry/degree.hpp"
#include "core/preprocessing/timing.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kPointsLookedAt = 256;
constexpr double kFollows = 0.98;  // mean resultant length; 1: each point lies exactly where its time says
constexpr int kMostCloudsARevolution = 4;

}  // namespace

std::optional<HeldTiming::Head> HeldTiming::headOf(const Sweep& sweep, const std::vector<float>& times_s,
                                                   double first_s, double period_s) {
  std::optional<Head> head;
  const std::size_t stride = (sweep.size() / kPointsLookedAt) | 1u;
  double best = kFollows;
  for (int clouds = 1; clouds <= kMostCloudsARevolution; ++clouds) {
    const double revolution_s = clouds * period_s;
    std::complex<double> clockwise, counter_clockwise;
    double looked_at = 0.0;
    for (std::size_t i = 0; i < sweep.size(); i += stride) {
      if (!std::isfinite(times_s[i])) continue;
      const Eigen::Vector3f& p = sweep.points_lidar[i];
      const double yaw = std::atan2(p.y(), p.x());
      const double turned = 2.0 * M_PI * (static_cast<double>(times_s[i]) - first_s) / revolution_s;
      clockwise += std::polar(1.0, yaw + turned);
      counter_clockwise += std::polar(1.0, yaw - turned);
      ++looked_at;
    }
    for (const bool is_clockwise : {true, false}) {
      const std::complex<double>& sum = is_clockwise ? clockwise : counter_clockwise;
      const double follows = std::abs(sum) / looked_at;  // NaN without points
      if (!(follows > best)) continue;
      best = follows;
      head = Head{sweep.stamp_s, first_s, period_s, revolution_s, std::arg(sum), is_clockwise};
    }
  }
  return head;
}

bool HeldTiming::apply(const Sweep& sweep, std::vector<float>& times_s) const {
  if (!head_) return false;
  // clouds of half a revolution start on alternating sides
  const double clouds = std::round(secondsBetween(head_->stamp_s, sweep.stamp_s) / head_->period_s);
  const double turned = std::remainder(2.0 * M_PI * clouds * head_->period_s / head_->revolution_s, 2.0 * M_PI);
  SweepTimingParams as_held;
  as_held.clockwise = head_->clockwise;
  as_held.start_azimuth_deg = (head_->start_azimuth_rad + (head_->clockwise ? -turned : turned)) / kDegree;
  timesByAzimuth(as_held, sweep.points_lidar, 0.0, head_->revolution_s, times_s);
  for (float& time_s : times_s) time_s += static_cast<float>(head_->first_s);
  return true;
}

}  // namespace fail_aware
