#include "core/integrity/rise_limit.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kRise_per_s = 0.4;  // a change by half within a second counts as a jump
constexpr double kLeast_s = 0.5;     // from which a shorter time rises

}  // namespace

TimeToFailure RiseLimit::limit(const TimeToFailure& time, double dt_s, double horizon_s) {
  if (time.isKnown() && last_.isKnown()) {
    const double highest_s = std::max(last_.seconds, kLeast_s) * std::pow(1.0 + kRise_per_s, std::max(dt_s, 0.0));
    last_ = time.seconds > highest_s ? TimeToFailure::fromSeconds(highest_s, horizon_s) : time;
  } else {
    last_ = time;
  }
  return last_;
}

}  // namespace fail_aware
