#include "core/integrity/covariance_predictor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fail_aware {

namespace {

constexpr double kMaxSteps = 100000.0;
constexpr double kLargestRadius_m = 1e6;

}  // namespace

void CovariancePredictor::Params::checkRules() const {
  requireParameter(std::isfinite(confidence) && confidence > 0.0 && confidence < 1.0, "confidence", confidence,
                   "in (0, 1)");
  requireParameter(alarm_confidence > 0.0 && alarm_confidence <= confidence, "alarm_confidence", alarm_confidence,
                   "> 0 and <= confidence", confidence);
  requireParameter(degrees_of_freedom == 0.0 || (degrees_of_freedom >= 1.0 && degrees_of_freedom <= 1e6),
                   "degrees_of_freedom", degrees_of_freedom, "0 or in [1, 1e6]");
  requireParameter(horizon_s / step_s <= kMaxSteps, "horizon_s", horizon_s, "at most 100000 steps of step_s");
}

CovariancePredictor::CovariancePredictor(const Params& params)
    : params_(params), radius_(params.confidence, params.degrees_of_freedom) {}

CovariancePrediction CovariancePredictor::predict(const CovarianceGrowth& growth) const {
  CovariancePrediction prediction;
  if (!isUsable(growth)) return {TimeToFailure::reached(), TimeToFailure::reached(), kLargestRadius_m};
  GrowingCovariance growing(growth);
  const auto horizontal = [&](const GrowingCovariance::Matrix& covariance) {
    return Eigen::Matrix2d(covariance.topLeftCorner<2, 2>() + growth.transient);
  };
  const auto failed = [&](const GrowingCovariance::Matrix& covariance) {
    return exceedance(horizontal(covariance), params_.alert_limit_m, params_.degrees_of_freedom);
  };
  prediction.radius_m = std::min(radius_(horizontal(growing.now())), kLargestRadius_m);
  struct Sought {
    TimeToFailure& time;
    double probability;
    bool found;
  };
  const double p = failed(growing.now());
  Sought all[] = {{prediction.time_to_failure, p + (1.0 - params_.confidence) * (1.0 - p), false},
                  {prediction.time_to_alarm, 1.0 - params_.alarm_confidence, false}};
  for (Sought& sought : all) {
    sought.time = TimeToFailure::fromSeconds(params_.horizon_s, params_.horizon_s);
    sought.found = p >= sought.probability;
    if (sought.found) sought.time = TimeToFailure::reached();
  }

  double t = 0.0;
  while (t < params_.horizon_s && !(all[0].found && all[1].found)) {
    const double step_s = growing.begin(t, std::min(params_.step_s, params_.horizon_s - t));
    const GrowingCovariance::Matrix next = growing.after(step_s);
    const double most = exceedanceBound(horizontal(next), params_.alert_limit_m, params_.degrees_of_freedom);
    std::optional<double> at_end;  // costly, and seldom needed
    for (Sought& sought : all) {
      if (sought.found || most < sought.probability) continue;
      if (!at_end) at_end = failed(next);
      if (*at_end < sought.probability) continue;
      const auto before = [&](double dt_s) { return failed(growing.after(dt_s)) < sought.probability; };
      sought.time = TimeToFailure::fromSeconds(t + endOf(before, step_s), params_.horizon_s);
      sought.found = true;
    }
    growing.advance(next);
    t += step_s;
  }
  prediction.time_to_failure = combine(prediction.time_to_failure, prediction.time_to_alarm);
  return prediction;
}

}  // namespace fail_aware
