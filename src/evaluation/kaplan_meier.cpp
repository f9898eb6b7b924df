#include "evaluation/kaplan_meier.hpp"

#include <algorithm>

namespace fail_aware {

std::optional<double> kaplanMeierQuantile(std::vector<CensoredValue> values, double q) {
  std::sort(values.begin(), values.end(), [](const CensoredValue& a, const CensoredValue& b) {
    return a.value != b.value ? a.value < b.value : a.failed > b.failed;  // what is censored here was at risk here
  });
  double survival = 1.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i].failed) continue;
    survival *= 1.0 - 1.0 / static_cast<double>(values.size() - i);
    if (1.0 - survival >= q - 1e-12) return values[i].value;
  }
  return std::nullopt;
}

}  // namespace fail_aware
