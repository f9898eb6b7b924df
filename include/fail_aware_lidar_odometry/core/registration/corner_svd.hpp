// The corner measurement as one object: extraction, alignment with the reference, keeping the reference. What the
// CornerSvd nodelet holds.
//
// measure() and place() are called once a sweep, in this order. Corners are taken from the sweep as it was corrected;
// the refined motion moves them by millimetres. While no motion is known sweeps are bent: no measurement, no reference.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/registration/corner_alignment.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_extraction.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_reference.hpp"
#include "fail_aware_lidar_odometry/core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"
#include "fail_aware_lidar_odometry/core/types/measurement.hpp"
#include "fail_aware_lidar_odometry/core/types/sweep_prediction.hpp"

namespace fail_aware {

class CornerSvd {
 public:
  CornerSvd(const CornerExtractor::Params& extraction, const CornerReference::Params& reference,
                    const CornerAlignment::Params& alignment);

  Measurement measure(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);
  void place(const FilterState& state);
  void reset();
  /// From the next sweep on; the reference stays. Throws ParameterError.
  void setAlignment(const CornerAlignment::Params& params) { alignment_ = CornerAlignment(params); }

  const std::vector<Corner>& cornersCog() const { return corners_cog_; }
  const std::vector<Corner>& referenceOdom() const { return reference_.corners(); }

 private:
  void enterOdom(int epoch);

  CornerExtractor extractor_;
  CornerReference reference_;
  CornerAlignment alignment_;
  std::vector<Corner> corners_cog_;
  bool motion_known_ = false;
  int odom_reset_count_ = 0;  ///< of the reference, as in local_map.hpp
};

}  // namespace fail_aware
