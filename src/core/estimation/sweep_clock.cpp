#include "core/estimation/sweep_clock.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kShortestTurn_s = TurnLine::kShortestTurn_s, kLongestTurn_s = TurnLine::kLongestTurn_s;
constexpr std::size_t kIntervalsNeeded = 3;
constexpr std::size_t kDifferencesNeeded = 5, kQuietDifferencesNeeded = 2;  // two differences rarely hide jitter

constexpr double kNegligible_s = 0.5e-3;    // 15 mm at 30 m/s: less than the vehicle model's noise in one sweep
constexpr double kUnknownJitter_s = 3e-3;   // of a usual host, until the stamps give it
constexpr double kLeastJitter_s = 0.05e-3;  // lower limit for any clock

constexpr double kTurnNoise_s = 0.03e-3;   // per revolution, an HDL-64E on a vehicle
constexpr double kSurePeriod = 0.01;       // relative standard deviation of a period from point times
constexpr double kWholeRevolution = 0.75;  // a cloud after more than this part of a revolution holds all of it
constexpr double kOtherPeriod = 0.02;      // if point times differ by this ratio twice, the spin rate has changed

constexpr double kLeastTolerance_s = 3e-3;  // a stamp farther off the model of a quiet clock is wrong
constexpr double kToleranceSigmas = 4.0;
constexpr double kMostTolerance = 0.4;  // in periods
constexpr std::size_t kLine = 3;        // stamps in a row that must agree on another clock or on another period
constexpr double kTurnsBetweenSets =
    30.0;  // if a clock seems to be set more often, the period is wrong and is estimated again
// of the tolerance, for a period: the onset of jitter may look like a new period by chance
constexpr double kSameSlope = 0.25;
constexpr double kTurnsOfGap = 3.0;      // after a gap of this many revolutions the head may have restarted
constexpr double kRightAfterAll = 0.05;  // probability that a stamp which contradicts the model is right
constexpr double kLostLogOdds = 4.6;     // of a sweep that is not lost: 1 % are
constexpr double kLeastLate = 0.01;      // probability of a stamp late by a period: jitter has long tails
constexpr double kSetBackSigma = 0.5;    // of the time that a clock may have been set back by
constexpr double kPhaseFollowed = 0.1;   // ratio of a phase correction that is applied in one sweep

// A whole number of revolutions, or the inverse of a whole number.
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

// Revolutions and times count from the last sweep.
void SweepClock::setPeriod(double period_s, double sigma_s) {
  line_.restart(period_s, sigma_s);
  last_.turn = last_.time_s = 0.0;
  set_at_turn_ = -kTurnsBetweenSets;
  line_.add(last_.turn, last_.time_s, noise_s());
  deviations_.clear();
}

// A period from point times alone is accurate to a thousandth: enough to judge stamps, too little to time
// points, but for the first sweeps (timing.hpp).
std::optional<double> SweepClock::period_s() const {
  if (!hasPeriod() || (!(given_period_s_ > 0.0) && intervals_ < kIntervalsNeeded)) return std::nullopt;
  return wholeMicroseconds(line_.period_s());
}

SweepTime SweepClock::next(double stamp_s, double set_back_s) {
  SweepTime sweep(stamp_s);
  if (!std::isfinite(stamp_s)) return sweep;
  sweep.set_back_s = lastExplains(set_back_s) ? 0.0 : set_back_s;
  if (last_.stamp_s) {
    const double stamps_apart_s = last_apart_s_ = secondsBetween(*last_.stamp_s, stamp_s);
    double since_s = stamps_apart_s + last_.error_s - offset_s_, found_s = 0.0;
    if (wasSetBack(since_s, sweep.set_back_s)) {
      found_s = uncounted_s(sweep.set_back_s);
      offset_s_ -= found_s;
      since_s += found_s;
      sweep.set_back_s = 0.0;
      jitter_.interrupt();
    }
    ++intervals_;
    const Interval found = interval(since_s, stamps_apart_s + found_s);
    sweep.error_s = last_.error_s + stamps_apart_s - found.seconds;
    if (found.seconds == since_s) sweep.error_s = offset_s_;
    sweep.interval_sigma_s = std::hypot(found.sigma_s, kSetBackSigma * uncounted_s(sweep.set_back_s));
  } else if (line_.empty()) {
    line_.add(last_.turn, last_.time_s, noise_s());
  }
  sweep.period_s = period_s().value_or(0.0);
  last_.stamp_s = stamp_s;
  last_.error_s = sweep.error_s;
  return sweep;
}

// True if no clock was set: the last stamp was ahead, or the refused sweep belongs into the gap before it.
bool SweepClock::lastExplains(double set_back_s) const {
  if (!hasPeriod()) return false;
  const double ahead_s = last_.error_s - offset_s_, half_s = 0.5 * line_.period_s();
  const bool was_ahead = ahead_s > kLeastTolerance_s && set_back_s <= ahead_s + tolerance_s();
  return was_ahead || (set_back_s > half_s && set_back_s < last_apart_s_ - half_s);
}

// True if the refused stamp came one revolution after the last sweep.
bool SweepClock::wasSetBack(double since_s, double set_back_s) const {
  if (!hasPeriod() || !(set_back_s > 0.0)) return false;
  const auto fits = [this](double interval_s) {
    return std::abs(interval_s - std::max(1.0, std::round(interval_s / line_.period_s())) * line_.period_s()) <=
           tolerance_s();
  };
  return !fits(since_s) && fits(since_s + uncounted_s(set_back_s));
}

SweepClock::Interval SweepClock::interval(double since_s, double stamps_apart_s) {
  // A shorter interval may be that of a driver that began in mid-revolution, or jitter: then more stamps decide.
  if (!hasPeriod() && new_revolution_s_ > 0.0 && stamps_apart_s > kWholeRevolution * new_revolution_s_) {
    turns_per_cloud_ = 1.0;  // a larger value may mean a lost sweep
    const double shorter_s = new_revolution_s_ - stamps_apart_s;
    followRevolution(new_revolution_s_);
    if (shorter_s > kLeastTolerance_s) {  // likelier jitter; the line begins at this stamp
      offset_s_ -= shorter_s;
      return {wholeMicroseconds(line_.period_s()), shorter_s};
    }
  }
  const double stamp_s = last_.time_s + since_s;
  if (!hasPeriod()) {
    jitter_.add(stamps_apart_s);
    line_.add(last_.turn + 1.0, stamp_s, noise_s());
    return advance(1.0, since_s);
  }
  // The difference of two stamps is the noisier one; it is needed where the last stamp was left out.
  const double by_line = turnsIn(stamp_s - line_.at(last_.turn));
  const double turns = deviations_.empty() ? by_line : std::min(by_line, turnsIn(stamps_apart_s));
  if (turns == 1.0) {
    jitter_.add(stamps_apart_s);
  } else {
    jitter_.interrupt();
  }
  const double deviation_s = stamp_s - line_.at(last_.turn + turns);
  if (std::abs(deviation_s) > tolerance_s(turns)) {
    if (turns < kTurnsOfGap) return withoutStamp({deviation_s, turns});
    setPeriod(line_.period_s(), line_.periodSigma_s());
    return {since_s, std::sqrt(kRightAfterAll) * std::abs(deviation_s)};
  }
  deviations_.clear();
  const double fewer_sigma_s = fewerTurnsSigma_s(turns, deviation_s);
  line_.add(last_.turn + turns, stamp_s, noise_s());
  Interval found = advance(turns, isTrusted(deviation_s) ? std::optional<double>(since_s) : std::nullopt);
  found.sigma_s = std::hypot(found.sigma_s, fewer_sigma_s);
  return found;
}

// What one turn less would change, times the root of its probability: the stamp may be late instead.
double SweepClock::fewerTurnsSigma_s(double turns, double deviation_s) const {
  const double noise = noise_s();
  if (turns < 2.0 || !jitter_.sigma_s() || noise <= kNegligible_s) return 0.0;
  const double late_s = deviation_s + line_.period_s();
  const double log_odds = 0.5 * (late_s * late_s - deviation_s * deviation_s) / (noise * noise) - kLostLogOdds;
  const double late_probability = std::max(kLeastLate, 1.0 / (1.0 + std::exp(log_odds)));
  return std::sqrt(late_probability) * line_.period_s();
}

// Only intervals matter. A correction of the phase also applies to earlier times, so it is applied gradually.
SweepClock::Interval SweepClock::advance(double turns, std::optional<double> trusted_s) {
  last_.turn += turns;
  const double turning_s = turns * line_.period_s();
  const double behind_s = line_.at(last_.turn) - last_.time_s - turning_s;
  const Interval interval = trusted_s ? Interval{*trusted_s, 0.0}
                                      : Interval{wholeMicroseconds(turning_s + kPhaseFollowed * behind_s),
                                                 line_.periodSigma_s() + kTurnNoise_s};
  last_.time_s += interval.seconds;
  return interval;
}

void SweepClock::observeRevolution(double revolution_s) {
  if (!(revolution_s >= kShortestTurn_s && revolution_s <= kLongestTurn_s) || given_period_s_ > 0.0) return;
  const auto differ = [](double a_s, double b_s) { return std::abs(a_s - b_s) > kOtherPeriod * b_s; };
  const double last_s = new_revolution_s_;
  new_revolution_s_ = revolution_s;
  if (!hasPeriod()) return;  // the next interval gives the number of revolutions per cloud
  if (!(turns_per_cloud_ > 0.0)) turns_per_cloud_ = turnsPerCloud(line_.period_s(), revolution_s);
  if (!differ(turns_per_cloud_ * revolution_s, line_.period_s())) {
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

// An interval clearly below two periods counts as one period with a wrong stamp. A wrong stamp is rarer than a lost
// sweep, but more likely than both together. With jitter, the likelier of a late stamp and a lost sweep counts.
double SweepClock::turnsIn(double since_s) const {
  const double turns = since_s / line_.period_s(), noise = noise_s() / line_.period_s();
  if (turns < std::max(2.0 - tolerance_s() / line_.period_s(), 1.5 + noise * noise * kLostLogOdds)) return 1.0;
  return std::round(turns);
}

double SweepClock::noise_s() const { return std::max(jitter_.sigma_s().value_or(kUnknownJitter_s), kLeastJitter_s); }

double SweepClock::tolerance_s(double turns) const {
  const double most_s = kMostTolerance * line_.period_s();
  if (!jitter_.sigma_s() && !period_sure_) return most_s;
  const double sigmas_s = kToleranceSigmas * noise_s() * line_.predictionFactor(last_.turn + turns);
  return std::min(std::max(sigmas_s, kLeastTolerance_s), most_s);
}

bool SweepClock::isTrusted(double deviation_s) const {
  const std::optional<double> jitter_s = jitter_.sigma_s();
  if (jitter_s) return *jitter_s <= kNegligible_s;
  return !period_sure_ || std::abs(deviation_s) <= kNegligible_s;
}

SweepClock::Interval SweepClock::withoutStamp(const Deviation& deviation) {
  ++outliers_;
  const double turning_s = wholeMicroseconds(deviation.turns * line_.period_s());
  last_.turn += deviation.turns;
  last_.time_s += turning_s;
  deviations_.push_back(deviation);
  if (followsAnotherLine()) return {turning_s, 0.0};
  return {turning_s, std::sqrt(kRightAfterAll) * std::abs(deviation.seconds)};
}

bool SweepClock::followsAnotherLine() {
  const std::size_t count = deviations_.size();
  if (count < kLine) return false;
  double mean_s = 0.0;
  for (std::size_t i = count - kLine; i < count; ++i) mean_s += deviations_[i].seconds / kLine;
  const auto agrees = [&](const Deviation& d) { return std::abs(d.seconds - mean_s) <= tolerance_s(); };
  if (std::all_of(deviations_.end() - kLine, deviations_.end(), agrees)) {
    offset_s_ += mean_s;
    jitter_.interrupt();
    const double turns = mean_s / line_.period_s();
    if (std::round(turns) != 0.0 && std::abs(mean_s - std::round(turns) * line_.period_s()) <= tolerance_s()) {
      deviations_.clear();  // no clock was set: a late stamp was counted as a lost sweep, or the other way round
    } else if (!period_sure_ && last_.turn - set_at_turn_ < kTurnsBetweenSets) {
      setPeriod(0.0, 0.0);
    } else {
      deviations_.clear();
      set_at_turn_ = last_.turn;
    }
    return true;
  }
  std::array<double, kLine - 1> per_turn_s{};
  for (std::size_t i = 0; i < per_turn_s.size(); ++i) {
    const Deviation &before = deviations_[count - kLine + i], &after = deviations_[count - kLine + i + 1];
    per_turn_s[i] = (after.seconds - before.seconds) / after.turns;
  }
  const auto [least, most] = std::minmax_element(per_turn_s.begin(), per_turn_s.end());
  const double other_period_s = line_.period_s() + 0.5 * (*least + *most);
  if (*most - *least > kSameSlope * tolerance_s() || other_period_s < kShortestTurn_s ||
      other_period_s > kLongestTurn_s)
    return false;
  offset_s_ += deviations_.back().seconds;
  jitter_.interrupt();
  turns_per_cloud_ = 0.0;  // it may be what was wrong
  setPeriod(other_period_s, tolerance_s());
  return true;
}

}  // namespace fail_aware
