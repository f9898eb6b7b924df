// The quantile of a sample, interpolated between the two nearest order statistics (q = 0: smallest, 1: largest).
#pragma once

#include <vector>

namespace fail_aware {

/// `values` in any order, not empty; q in [0, 1].
double quantile(std::vector<double> values, double q);

}  // namespace fail_aware
