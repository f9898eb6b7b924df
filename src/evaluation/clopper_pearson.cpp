#include "evaluation/clopper_pearson.hpp"

#include <cmath>

namespace fail_aware {

namespace {

constexpr int kBisections = 60;

double probabilityOf(std::size_t successes, std::size_t trials, double p) {
  const auto k = static_cast<double>(successes), n = static_cast<double>(trials);
  return std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(p) +
                  (n - k) * std::log1p(-p));
}

double probabilityOfUpTo(std::size_t successes, std::size_t trials, double p) {
  double sum = 0.0;
  for (std::size_t k = 0; k <= successes; ++k) sum += probabilityOf(k, trials, p);
  return sum;
}

// The p at which P(X <= successes | p), which falls with p, is `probability`.
double proportionFor(std::size_t successes, std::size_t trials, double probability) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (probabilityOfUpTo(successes, trials, middle) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::optional<Interval> clopperPearson(std::size_t part, std::size_t whole, double level) {
  if (whole == 0) return std::nullopt;
  const double tail = 0.5 * (1.0 - level);
  Interval interval{0.0, 1.0};
  if (part > 0) interval.low = proportionFor(part - 1, whole, 1.0 - tail);
  if (part < whole) interval.high = proportionFor(part, whole, tail);
  return interval;
}

}  // namespace fail_aware
