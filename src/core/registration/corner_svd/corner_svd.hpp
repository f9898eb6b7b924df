// The corner measurement of the CornerSvd nodelet: extraction, alignment, reference (paper, section "SVD Cornering
// Algorithm").
//
// Call measure() and then place() once per sweep. Corners come from the sweep as deskewed for the prediction; a refined
// motion would move them by millimetres only. While the motion is unknown, sweeps are distorted: no measurement and no
// reference update.
// Input: a corrected sweep (m, lidar frame) and poses of the centre of gravity in odom.
// Failure: the status of the Measurement. Cost: that of corner_extraction.hpp.
#pragma once

#include <vector>

#include "core/registration/corner_svd/corner_alignment.hpp"
#include "core/registration/corner_svd/corner_extraction.hpp"
#include "core/registration/corner_svd/corner_reference.hpp"
#include "core/types/corrected_sweep.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/measurement.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

class CornerSvd {
 public:
  CornerSvd(const CornerExtractor::Params& extraction, const CornerReference::Params& reference,
            const CornerAlignment& alignment);

  Measurement measure(const CorrectedSweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar);
  void place(const FilterState& state);
  /// In place of place(): the estimate of a sweep that was not measured here.
  void skip(const FilterState& state);
  void reset();
  /// Valid from the next sweep; the reference stays.
  void setAlignment(const CornerAlignment& params) { alignment_ = params; }

  const std::vector<Corner>& cornersCog() const { return corners_cog_; }
  const std::vector<Corner>& referenceOdom() const { return reference_.corners(); }

 private:
  void enterOdom(int odom_reset_count);

  CornerExtractor extractor_;
  CornerReference reference_;
  CornerAlignment alignment_;
  std::vector<Corner> corners_cog_;
  bool motion_known_ = false;
  int odom_reset_count_ = 0;  ///< of the reference, as in local_map.hpp
};

}  // namespace fail_aware
