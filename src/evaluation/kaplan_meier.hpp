// The share of failures by a given value where some were only watched up to a value (right-censored): the product-limit
// estimator of Kaplan and Meier, S(v) = prod over failures v_i <= v of (1 - failures at v_i / at risk at v_i).
#pragma once

#include <optional>
#include <vector>

namespace fail_aware {

struct CensoredValue {
  double value = 0.0;
  bool failed = false;  ///< false: it would have failed at some larger value
};

/// The smallest value by which the share `q` has failed; nothing if it is never reached.
std::optional<double> kaplanMeierQuantile(std::vector<CensoredValue> values, double q);

}  // namespace fail_aware
