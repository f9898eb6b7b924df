#include "core/estimation/turn_line.hpp"

#include <algorithm>
#include <cmath>

#include "core/moving_median.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kStamps = 40;    // 4 s: the period is good to 0.014 of the jitter, the phase to 0.3 of it
constexpr std::size_t kFirst = 16;     // stamps whose revolutions are counted again while no period is known
constexpr std::size_t kIntervals = 3;  // needed for a period
// an interval of this many medians holds two revolutions: jitter is more usual than loss
constexpr double kTwoTurns = 1.7;
constexpr std::size_t kNewest = 5;        // if the mean of these residuals
constexpr double kOtherRateSigmas = 4.0;  // is this far from 0, the spin rate has changed

}  // namespace

void TurnLine::restart(double period_s, double sigma_s) {
  stamps_.clear();
  known_period_s_ = period_s_ = period_s;
  known_sigma_s_ = period_sigma_s_ = sigma_s;
  mean_turn_ = mean_s_ = period_factor_ = 0.0;
}

void TurnLine::add(double turn, double stamp_s, double noise_s) {
  stamps_.push_back({turn, stamp_s});
  if (stamps_.size() > kStamps) stamps_.pop_front();
  if (!(known_period_s_ > 0.0)) {
    const std::optional<double> interval_s = medianInterval_s();
    if (!interval_s) return;
    countTurns(*interval_s);
    if (stamps_.size() >= kFirst) known_period_s_ = known_sigma_s_ = *interval_s;
  }
  fit(noise_s);
  const double limit_s = kOtherRateSigmas * noise_s / std::sqrt(static_cast<double>(kNewest));
  while (stamps_.size() >= 2 * kNewest && std::abs(meanResidual_s()) > limit_s) {
    stamps_.erase(stamps_.begin(), stamps_.begin() + static_cast<std::ptrdiff_t>(stamps_.size() / 2));
    known_sigma_s_ = known_period_s_;  // the period has changed
    fit(noise_s);
  }
}

std::optional<double> TurnLine::medianInterval_s() const {
  MovingMedian intervals_s(kStamps);
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    const double interval_s = secondsBetween(stamps_[i - 1].stamp_s, stamps_[i].stamp_s);
    if (interval_s >= kShortestTurn_s && interval_s <= kLongestTurn_s) intervals_s.add(interval_s);
  }
  if (intervals_s.size() < kIntervals) return std::nullopt;
  return intervals_s.median();
}

/// Counts back from the newest stamp.
void TurnLine::countTurns(double interval_s) {
  for (std::size_t i = stamps_.size() - 1; i > 0; --i) {
    const double turns = (stamps_[i].stamp_s - stamps_[i - 1].stamp_s) / interval_s;
    stamps_[i - 1].turn = stamps_[i].turn - (turns < kTwoTurns ? 1.0 : std::round(turns));
  }
}

void TurnLine::fit(double noise_s) {
  const double count = static_cast<double>(stamps_.size());
  mean_turn_ = mean_s_ = 0.0;
  for (const Stamp& s : stamps_) {
    mean_turn_ += s.turn / count;
    mean_s_ += s.stamp_s / count;
  }
  // Distances from the known line, so that the period of a perfect head has no rounding error.
  double spread = 0.0, slope_s = 0.0;
  for (const Stamp& s : stamps_) {
    const double turns = s.turn - mean_turn_;
    spread += turns * turns;
    slope_s += turns * (s.stamp_s - mean_s_ - turns * known_period_s_);
  }
  const double known = known_sigma_s_ > 0.0 ? std::pow(noise_s / known_sigma_s_, 2) : 0.0;
  const double information = spread + known;
  if (!(information > 0.0)) return;
  period_s_ = std::max(known_period_s_ + slope_s / information, 0.5 * known_period_s_);
  period_factor_ = std::sqrt(1.0 / information);
  period_sigma_s_ = period_factor_ * noise_s;
}

double TurnLine::meanResidual_s() const {
  double sum_s = 0.0;
  for (auto s = stamps_.rbegin(); s != stamps_.rbegin() + kNewest; ++s) sum_s += s->stamp_s - at(s->turn);
  return sum_s / static_cast<double>(kNewest);
}

double TurnLine::predictionFactor(double turn) const {
  const double count = static_cast<double>(std::max<std::size_t>(stamps_.size(), 1));
  return std::sqrt(1.0 + 1.0 / count + std::pow((turn - mean_turn_) * period_factor_, 2));
}

}  // namespace fail_aware
