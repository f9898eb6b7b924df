#include "core/registration/corner_svd/corner_svd.hpp"

namespace fail_aware {

CornerSvd::CornerSvd(const CornerExtractor::Params& extraction, const CornerReference::Params& reference,
                     const CornerAlignment& alignment)
    : extractor_(extraction), reference_(reference), alignment_(alignment) {}

Measurement CornerSvd::measure(const CorrectedSweep& sweep, const SweepPrediction& prediction,
                               const Pose& T_cog_lidar) {
  enterOdom(prediction.odom_reset_count);
  const Eigen::Matrix3d R_odom_lidar = prediction.T_odom_cog.linear() * T_cog_lidar.linear();
  corners_cog_ = movedCorners(T_cog_lidar, extractor_.extract(sweep.points_lidar, R_odom_lidar));
  motion_known_ = prediction.motionKnown();
  if (!motion_known_) return Measurement();
  return alignment_.align(corners_cog_, reference_.corners(), prediction.T_odom_cog, prediction.covariance);
}

void CornerSvd::place(const FilterState& state) {
  skip(state);
  // corners do not observe roll and pitch, so a sweep that only corners measured may update the reference
  if (motion_known_ && (state.measurement_applied || state.inMap())) reference_.update(corners_cog_, state.T_odom_cog);
}

void CornerSvd::skip(const FilterState& state) {
  enterOdom(state.odom_reset_count);
  if (state.map_update == MapUpdate::kRestart) reference_.clear();
}

void CornerSvd::enterOdom(int odom_reset_count) {
  if (odom_reset_count == odom_reset_count_) return;
  odom_reset_count_ = odom_reset_count;
  reference_.clear();
}

void CornerSvd::reset() {
  reference_.clear();
  corners_cog_.clear();
  motion_known_ = false;
}

}  // namespace fail_aware
