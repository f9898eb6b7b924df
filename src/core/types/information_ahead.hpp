// What a sweep shows of the road ahead (registration/look_ahead.hpp).
#pragma once

#include <cmath>

namespace fail_aware {

struct InformationAhead {
  /// On the weakest stretch in view: ratio of the walls' horizontal information that is along the road, 0..1.
  /// 1: not known.
  double ratio = 1.0;
  double distance_m = 0.0;  ///< along the path, to where the weakest stretch begins

  bool known() const { return ratio < 1.0; }
  /// Whether both are numbers in their ranges.
  bool isValid() const { return ratio >= 0.0 && ratio <= 1.0 && distance_m >= 0.0 && std::isfinite(distance_m); }
};

}  // namespace fail_aware
