// Beyond the paper: the time at which the horizontal error since t1 passes the alert limit with a given probability,
// from the accumulated covariance and its present growth.
//
// The radius is that of confidence_radius.hpp, the growth that of covariance_growth.hpp, in steps; the crossing is
// found inside its step by bisection.
//
// Two times. To the alarm: until a failure has a probability of 1 - alarm_confidence. To the failure: what has not
// failed by now (probability 1 - p) fails before it with 1 - confidence, so until p has grown to
// p + (1 - confidence)(1 - p); or the time to the alarm if that is sooner. The second says how soon, the first whether
// the pose can be used at all.
//
// Inputs: m, rad, s. Failure: input that is not finite, not a covariance or above 1e12 bounds no error: failed already,
// radius 1e6 m, the largest there is. Cost: horizon_s / step_s 6x6 products.
#pragma once

#include "core/integrity/confidence_radius.hpp"
#include "core/integrity/covariance_growth.hpp"
#include "core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

struct CovariancePrediction {
  TimeToFailure time_to_failure;
  TimeToFailure time_to_alarm;  ///< later, or the same
  double radius_m = 0.0;        ///< the radius now with `confidence`
};

class CovariancePredictor {
 public:
  struct Params {
    double alert_limit_m = 0.6;
    double confidence = 0.98;         ///< that what works now does not fail before the published time
    double alarm_confidence = 0.9;    ///< of the time that the state acts on: a lower one gives fewer false alarms
    double degrees_of_freedom = 8.0;  ///< of the error's distribution; 0: Gaussian
    double horizon_s = 60.0;
    /// step of the prediction: may be coarse: the crossing is found inside a step by bisection
    double step_s = 0.25;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("alert_limit_m", self.alert_limit_m, requirePositive);
      v("confidence", self.confidence);
      v("alarm_confidence", self.alarm_confidence);
      v("degrees_of_freedom", self.degrees_of_freedom);
      v("horizon_s", self.horizon_s, requirePositive);
    }
    void checkRules() const;
  };

  explicit CovariancePredictor(const Params& params);

  CovariancePrediction predict(const CovarianceGrowth& growth) const;

 private:
  Params params_;
  ConfidenceRadius radius_;
};

}  // namespace fail_aware
