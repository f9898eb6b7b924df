#include "core/integrity/indicator.hpp"

#include <algorithm>
#include <cmath>

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {
constexpr double kLargestSigma = 1e6;  // rad
constexpr double kLargestSpeed = 1e6;  // m/s
}  // namespace

void FailAwareIndicator::start(double stamp_s) {
  stop();
  if (std::isfinite(stamp_s)) start_stamp_s_ = stamp_s;
}

void FailAwareIndicator::update(double stamp_s, double sigma_yaw_rad, double speed_mps) {
  if (!std::isfinite(stamp_s)) return;
  if (!(sigma_yaw_rad >= 0.0 && sigma_yaw_rad <= kLargestSigma)) return;
  if (!(std::abs(speed_mps) <= kLargestSpeed)) return;
  if (!start_stamp_s_ || stamp_s < *start_stamp_s_) return;

  if (last_stamp_s_) {
    const double dt_s = secondsBetween(*last_stamp_s_, stamp_s);
    if (dt_s < params_.min_interval_s) return;
    if (dt_s > params_.max_gap_s) {
      last_.reset();
      last_slope_.reset();
      window_.clear();
      summed_ = 0;
    }
  }
  last_stamp_s_ = stamp_s;
  if (params_.average_s <= 0.0) {
    add({stamp_s, sigma_yaw_rad, speed_mps});
    return;
  }
  if (summed_ > 0 && secondsBetween(average_from_s_, stamp_s) >= params_.average_s - kStampTolerance_s) {
    add({average_from_s_ + sum_.stamp_s / summed_, sum_.sigma_rad / summed_, sum_.speed_mps / summed_});
    summed_ = 0;
  }
  if (summed_ == 0) {
    sum_ = {};
    average_from_s_ = stamp_s;
  }
  sum_.stamp_s += secondsBetween(average_from_s_, stamp_s);
  sum_.sigma_rad += sigma_yaw_rad;
  sum_.speed_mps += speed_mps;
  ++summed_;
}

void FailAwareIndicator::add(const Sample& sample) {
  if (last_) {
    const double slope = (sample.sigma_rad - last_->sigma_rad) / secondsBetween(last_->stamp_s, sample.stamp_s);
    if (last_slope_) {
      const double weight =
          params_.reference_speed_mps > 0.0 ? std::abs(sample.speed_mps) / params_.reference_speed_mps : 1.0;
      eta_ += weight * params_.reference_period_s * std::abs(slope - *last_slope_);
    }
    last_slope_ = slope;
    window_.push_back({sample.stamp_s, eta_});
    if (window_.size() > static_cast<std::size_t>(params_.rate_window_samples) + 1) window_.pop_front();
  }
  last_ = sample;
}

std::optional<double> FailAwareIndicator::etaRate() const {
  if (window_.size() < 2) return std::nullopt;
  return (window_.back().eta - window_.front().eta) / secondsBetween(window_.front().stamp_s, window_.back().stamp_s);
}

TimeToFailure FailAwareIndicator::timeToFailure() const {
  if (!started()) return TimeToFailure::unknown();
  if (eta_ >= params_.threshold) return TimeToFailure::reached();
  const std::optional<double> rate = etaRate();
  if (!rate) return TimeToFailure::unknown();
  if (*rate <= 0.0) return TimeToFailure::fromSeconds(params_.horizon_s, params_.horizon_s);
  // eta is that of the last sample, the time counts from the last stamp
  const double from_sample_s = (params_.threshold - eta_) / *rate;
  const double left_s = from_sample_s - secondsBetween(last_->stamp_s, *last_stamp_s_);
  const double soonest_s = std::min(from_sample_s, params_.reference_period_s);  // not reached as far as is known
  return TimeToFailure::fromSeconds(std::max(left_s, soonest_s), params_.horizon_s);
}

}  // namespace fail_aware
