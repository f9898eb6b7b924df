// The minimum of a function of a few variables without derivatives: Nelder and Mead's simplex, begun anew from its
// result until that no longer helps. Deterministic. For calibration, not for a sweep.
#pragma once

#include <functional>
#include <vector>

namespace fail_aware {

struct NelderMeadResult {
  std::vector<double> x;
  double value = 0.0;
  int evaluations = 0;
  bool converged = false;  ///< false: max_evaluations came first
};

/// `step`: size of the first simplex along every variable. Values that are not finite count as worst.
NelderMeadResult nelderMead(const std::function<double(const std::vector<double>&)>& f, std::vector<double> start,
                            double step, double tolerance = 1e-7, int max_evaluations = 5000);

}  // namespace fail_aware
