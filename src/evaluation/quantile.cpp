#include "evaluation/quantile.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(place));
  const std::size_t above = std::min(below + 1, values.size() - 1);
  const double share = place - static_cast<double>(below);
  return share <= 0.0 ? values[below] : (1.0 - share) * values[below] + share * values[above];
}

}  // namespace fail_aware
