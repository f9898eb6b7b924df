#include "evaluation/elevation_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "core/io/input_error.hpp"

namespace fail_aware {

namespace {

constexpr double kLeastGain = 0.5;  // of the information, relative to the prior's

}  // namespace

std::optional<ElevationEstimate> withoutPrior(const ElevationEstimate& found, double prior_sigma_deg) {
  const double prior = 1.0 / (prior_sigma_deg * prior_sigma_deg), posterior = 1.0 / (found.sigma_deg * found.sigma_deg);
  const double own = posterior - prior;
  if (!(own > kLeastGain * prior)) return std::nullopt;
  return ElevationEstimate{found.angle_deg * posterior / own, std::sqrt(1.0 / own)};
}

ElevationEstimate meanElevation(const std::vector<ElevationEstimate>& drives) {
  if (drives.empty()) throw InputError("no run determines the elevation of the beams");
  const auto weightOf = [](const ElevationEstimate& drive) {
    return 1.0 / (drive.sigma_deg * drive.sigma_deg + kScenerySigma_deg * kScenerySigma_deg);
  };
  double weights = 0.0, weighted = 0.0;
  for (const ElevationEstimate& drive : drives) {
    if (!std::isfinite(drive.angle_deg) || !std::isfinite(drive.sigma_deg) || drive.sigma_deg <= 0.0) {
      throw InputError("an elevation or its sigma is not a number that can be used");
    }
    weights += weightOf(drive);
    weighted += weightOf(drive) * drive.angle_deg;
  }
  ElevationEstimate mean;
  mean.angle_deg = weighted / weights;
  double chi2 = 0.0;
  for (const ElevationEstimate& drive : drives) {
    const double off_deg = drive.angle_deg - mean.angle_deg;
    chi2 += weightOf(drive) * off_deg * off_deg;
  }
  const double freedom = std::max(1.0, static_cast<double>(drives.size()) - 1.0);
  mean.sigma_deg = std::sqrt(std::max(1.0, chi2 / freedom) / weights);
  return mean;
}

}  // namespace fail_aware
