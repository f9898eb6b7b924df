#include "fail_aware_lidar_odometry/core/sweep/sweep_clock.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/sweep/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kShortestTurn_s = 0.02;  // 50 Hz: no head turns faster
constexpr double kLongestTurn_s = 0.22;   // 5 Hz, the slowest that heads turn: a longer interval holds a gap
constexpr std::size_t kIntervalsNeeded = 3;
constexpr double kOtherFirstPeriod = 0.3;  // a head that still speeds up or slows down, relative
constexpr std::size_t kDifferencesNeeded = 5, kQuietDifferencesNeeded = 2;  // jitter hardly hides in two

constexpr double kNegligible_s = 0.5e-3;    // 15 mm at 30 m/s: less than the vehicle model's noise in one sweep
constexpr double kUnknownJitter_s = 3e-3;   // until the stamps tell: a usual host
constexpr double kLeastJitter_s = 0.05e-3;  // no clock is believed to less

constexpr double kTurnNoise_s = 0.03e-3;     // of one turn, an HDL-64E on a vehicle
constexpr double kPeriodNoise_s = 0.008e-3;  // by which the period wanders in one turn
constexpr double kSurePeriod = 0.01;         // relative standard deviation of a period that point times tell
constexpr double kOtherPeriod = 0.02;        // point times that differ by so much, twice, tell another spin rate

constexpr double kLeastTolerance_s = 3e-3;  // a stamp that is farther off a quiet clock's model is wrong
constexpr double kUnknownTolerance_s = 20e-3;
constexpr double kToleranceSigmas = 4.0;
constexpr double kMostTolerance = 0.4;       // periods
constexpr std::size_t kLine = 3;             // stamps in a row that must agree on another clock or period
constexpr double kTurnsOfGap = 3.0;          // after so many the head may have begun anew
constexpr double kRightAfterAll = 0.05;      // probability that a stamp which contradicts the model is right
constexpr std::size_t kBiasedResiduals = 4;  // in a row, of one sign and beyond the noise: the period changes
constexpr double kBiasSigmas = 2.0;
constexpr double kPhaseFollowed = 0.1;  // of a correction of the phase, in one sweep

// A whole number of turns, or a turn divided by one.
double turnsPerCloud(double interval_s, double revolution_s) {
  const double turns = interval_s / revolution_s;
  return turns < 1.0 ? 1.0 / std::round(1.0 / turns) : std::round(turns);
}

}  // namespace

void StampJitter::add(double interval_s) {
  if (last_interval_s_) {
    const double difference_s = std::abs(interval_s - *last_interval_s_);
    second_differences_s_.add(difference_s);
    newest_differences_s_.add(difference_s);
    largest_difference_s_ = std::max(largest_difference_s_, difference_s);
  }
  last_interval_s_ = interval_s;
}

void StampJitter::clear() {
  interrupt();
  second_differences_s_.clear();
  newest_differences_s_.clear();
  largest_difference_s_ = 0.0;
}

// A second difference of stamps with independent errors has 6 times their variance.
std::optional<double> StampJitter::sigma_s() const {
  constexpr double kSigmaOfMedian = 1.4826;
  const bool is_quiet =
      largest_difference_s_ <= kNegligible_s && second_differences_s_.size() >= kQuietDifferencesNeeded;
  if (second_differences_s_.size() < kDifferencesNeeded && !is_quiet) return std::nullopt;
  return kSigmaOfMedian * std::max(second_differences_s_.median(), newest_differences_s_.median()) / std::sqrt(6.0);
}

SweepClock::SweepClock(double given_period_s) : given_period_s_(given_period_s) {
  if (given_period_s_ > 0.0) setPeriod(given_period_s_, kSurePeriod * given_period_s_);
  period_sure_ = given_period_s_ > 0.0;
}

void SweepClock::setPeriod(double period_s, double sigma_s) {
  period_s_ = period_s;
  const double jitter_s = jitter_.sigma_s().value_or(kUnknownJitter_s);
  P_ = Eigen::Vector2d(jitter_s * jitter_s, sigma_s * sigma_s).asDiagonal();
  lead_s_ = 0.0;
  residuals_s_.clear();
  deviations_.clear();
}

// What point times tell alone is true to a thousandth: enough to judge stamps, too little to time points by it.
std::optional<double> SweepClock::period_s() const {
  if (!(period_s_ > 0.0) || (!(given_period_s_ > 0.0) && first_intervals_s_.size() < kIntervalsNeeded)) {
    return std::nullopt;
  }
  return wholeMicroseconds(period_s_);
}

SweepTime SweepClock::next(double stamp_s, double set_back_s) {
  SweepTime sweep(stamp_s);
  sweep.set_back_s = set_back_s;
  if (!std::isfinite(stamp_s)) return sweep;
  if (last_stamp_s_) {
    const double stamps_apart_s = secondsBetween(*last_stamp_s_, stamp_s);
    double since_s = stamps_apart_s + last_error_s_ - offset_s_;
    if (set_back_s > 0.0 && wasSetBack(since_s, set_back_s)) {
      offset_s_ -= set_back_s + period_s_;
      since_s += set_back_s + period_s_;
      sweep.set_back_s = 0.0;
      jitter_.interrupt();
    }
    const Interval found = interval(since_s, stamps_apart_s);
    sweep.error_s = last_error_s_ + stamps_apart_s - found.seconds;
    if (found.seconds == since_s) sweep.error_s = offset_s_;
    sweep.interval_sigma_s = found.sigma_s;
  }
  sweep.period_s = period_s().value_or(0.0);
  last_stamp_s_ = stamp_s;
  last_error_s_ = sweep.error_s;
  return sweep;
}

// The stamp that was refused came one turn after the last sweep.
bool SweepClock::wasSetBack(double since_s, double set_back_s) const {
  if (!(period_s_ > 0.0)) return false;
  const auto fits = [this](double interval_s) {
    return std::abs(interval_s - std::max(1.0, std::round(interval_s / period_s_)) * period_s_) <= tolerance_s();
  };
  return !fits(since_s) && fits(since_s + set_back_s + period_s_);
}

SweepClock::Interval SweepClock::interval(double since_s, double stamps_apart_s) {
  const bool is_known = period_s_ > 0.0;
  if (first_intervals_s_.size() < kUsualIntervals) learnPeriod(stamps_apart_s);
  if (!is_known && new_revolution_s_ > 0.0 && stamps_apart_s >= kShortestTurn_s) {
    turns_per_cloud_ = std::min(1.0, turnsPerCloud(stamps_apart_s, new_revolution_s_));  // more: a sweep may be lost
    followRevolution(new_revolution_s_);
  } else if (!is_known) {
    jitter_.add(stamps_apart_s);
    return {since_s, 0.0};
  }
  const double turns = turnsIn(since_s);
  if (turns == 1.0) {
    jitter_.add(stamps_apart_s);
  } else {
    jitter_.interrupt();
  }
  predict(turns);
  const double predicted_s = turns * period_s_ + lead_s_;
  const double deviation_s = since_s - predicted_s;
  if (std::abs(deviation_s) > tolerance_s()) {
    if (turns < kTurnsOfGap) return withoutStamp({deviation_s, turns});
    setPeriod(period_s_, std::sqrt(P_(1, 1)));
    return {since_s, 0.0};
  }
  deviations_.clear();
  const double phase_s = predicted_s + correct(deviation_s);
  const bool is_trusted = isTrusted(deviation_s);
  // Only intervals matter. Each correction of the phase corrects the last times as well, so it is taken over slowly.
  const double turning_s = turns * period_s_;
  const double interval_s =
      is_trusted ? since_s : wholeMicroseconds(turning_s + kPhaseFollowed * (phase_s - turning_s));
  lead_s_ = phase_s - interval_s;
  return {interval_s, is_trusted ? 0.0 : std::sqrt(P_(1, 1)) + kTurnNoise_s};
}

// Sweeps may be lost from the start, and a head may still speed up: the median of the first intervals that it can take.
void SweepClock::learnPeriod(double interval_s) {
  if (interval_s < kShortestTurn_s || interval_s > kLongestTurn_s) return;
  first_intervals_s_.push_back(interval_s);
  if (period_sure_ || first_intervals_s_.size() < kIntervalsNeeded) return;
  std::vector<double> sorted = first_intervals_s_;
  std::sort(sorted.begin(), sorted.end());
  const double median_s = sorted[sorted.size() / 2];
  if (std::abs(median_s - period_s_) > kOtherFirstPeriod * median_s) setPeriod(median_s, kUnknownJitter_s);
}

void SweepClock::observeRevolution(double revolution_s) {
  if (!(revolution_s >= kShortestTurn_s && revolution_s <= kLongestTurn_s) || given_period_s_ > 0.0) return;
  const auto differ = [](double a_s, double b_s) { return std::abs(a_s - b_s) > kOtherPeriod * b_s; };
  const double last_s = new_revolution_s_;
  new_revolution_s_ = revolution_s;
  if (!(period_s_ > 0.0)) return;  // the next interval tells how many turns a cloud holds
  if (!(turns_per_cloud_ > 0.0)) turns_per_cloud_ = turnsPerCloud(period_s_, revolution_s);
  if (!differ(turns_per_cloud_ * revolution_s, period_s_)) {
    new_revolution_s_ = 0.0;
  } else if (last_s > 0.0 && !differ(last_s, revolution_s)) {
    followRevolution(revolution_s);
  }
}

void SweepClock::followRevolution(double revolution_s) {
  jitter_.interrupt();
  setPeriod(turns_per_cloud_ * revolution_s, kSurePeriod * turns_per_cloud_ * revolution_s);
  period_sure_ = true;
  new_revolution_s_ = 0.0;
}

// Less than two whole ones is one whose stamp is wrong: rarer than a lost sweep, but not together with it.
double SweepClock::turnsIn(double since_s) const {
  const double turns = since_s / period_s_;
  if (turns < 2.0 - tolerance_s() / period_s_) return 1.0;
  return std::round(turns);
}

double SweepClock::tolerance_s() const {
  const std::optional<double> jitter_s = jitter_.sigma_s();
  if (!jitter_s && !period_sure_) return std::min(kUnknownTolerance_s, kMostTolerance * period_s_);
  const double sigmas_s = kToleranceSigmas * jitter_s.value_or(kUnknownJitter_s);
  return std::min(std::max(sigmas_s, kLeastTolerance_s), kMostTolerance * period_s_);
}

bool SweepClock::isTrusted(double deviation_s) const {
  const std::optional<double> jitter_s = jitter_.sigma_s();
  if (jitter_s) return *jitter_s <= kNegligible_s;
  return !period_sure_ || std::abs(deviation_s) <= kNegligible_s;
}

void SweepClock::predict(double turns) {
  double period_noise_s = kPeriodNoise_s;
  if (residuals_s_.size() == kBiasedResiduals) {
    const auto [low, high] = std::minmax_element(residuals_s_.begin(), residuals_s_.end());
    const double bias_s = *low > 0.0 ? *low : *high < 0.0 ? -*high : 0.0;
    if (bias_s > kBiasSigmas * jitter_.sigma_s().value_or(kUnknownJitter_s))
      period_noise_s = std::max(period_noise_s, bias_s);
  }
  Eigen::Matrix2d F;
  F << 1.0, turns, 0.0, 1.0;
  P_ = (F * P_ * F.transpose()).eval();
  P_(0, 0) += turns * kTurnNoise_s * kTurnNoise_s;
  P_(1, 1) += turns * period_noise_s * period_noise_s;
}

// The phase's correction; the period takes its own.
double SweepClock::correct(double residual_s) {
  const double jitter_s = std::max(jitter_.sigma_s().value_or(kUnknownJitter_s), kLeastJitter_s);
  const Eigen::Vector2d gain = P_.col(0) / (P_(0, 0) + jitter_s * jitter_s);
  const Eigen::RowVector2d row = P_.row(0);
  P_ -= gain * row;
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  period_s_ = std::max(period_s_ + gain[1] * residual_s, 0.5 * period_s_);
  residuals_s_.push_back(residual_s);
  if (residuals_s_.size() > kBiasedResiduals) residuals_s_.pop_front();
  return gain[0] * residual_s;
}

SweepClock::Interval SweepClock::withoutStamp(const Deviation& deviation) {
  ++outliers_;
  const double turning_s = wholeMicroseconds(deviation.turns * period_s_);
  deviations_.push_back(deviation);
  if (followsAnotherLine()) return {turning_s, 0.0};
  return {turning_s, std::sqrt(kRightAfterAll) * std::abs(deviation.seconds)};
}

bool SweepClock::followsAnotherLine() {
  if (deviations_.size() < kLine) return false;
  const Deviation &a = deviations_[deviations_.size() - 3], &b = deviations_[deviations_.size() - 2],
                  &c = deviations_.back();
  const double per_turn_ab_s = (b.seconds - a.seconds) / b.turns, per_turn_bc_s = (c.seconds - b.seconds) / c.turns;
  if (std::abs(per_turn_bc_s - per_turn_ab_s) > tolerance_s()) return false;
  const double per_turn_s = 0.5 * (per_turn_ab_s + per_turn_bc_s), other_period_s = period_s_ + per_turn_s;
  if (std::abs(per_turn_s) > tolerance_s() && (other_period_s < kShortestTurn_s || other_period_s > kLongestTurn_s)) {
    return false;
  }
  offset_s_ += c.seconds;
  const bool is_other_period = std::abs(per_turn_s) > tolerance_s();
  jitter_.interrupt();
  setPeriod(is_other_period ? other_period_s : period_s_, is_other_period ? tolerance_s() : std::sqrt(P_(1, 1)));
  return true;
}

}  // namespace fail_aware
