#include "core/preprocessing/sweep_corrector.hpp"

#include <cmath>
#include <utility>

#include "core/geometry/degree.hpp"
#include "core/preprocessing/revolution.hpp"
#include "core/preprocessing/rings_by_order.hpp"
#include "core/stamp_difference.hpp"
#include "core/types/sweep_points.hpp"

namespace fail_aware {

namespace {

// Undoes SensorParameters::correctedTiming().
SweepTimingParams timingOfRawPoints(SweepTimingParams timing, const AzimuthCorrectionParams& azimuth) {
  timing.start_azimuth_deg -= azimuth.angle_deg;
  return timing;
}

/// Leaves out the points whose time is NaN.
void dropUntimed(Sweep& sweep, std::vector<float>& times_s) {
  std::vector<std::size_t> kept;
  kept.reserve(times_s.size());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (std::isfinite(times_s[i])) kept.push_back(i);
  }
  keepPoints(kept, sweep);
  keepValues(kept, times_s);
}

}  // namespace

SweepCorrector::SweepCorrector(const VerticalAngleCorrectionParams& vertical_angle,
                               const AzimuthCorrectionParams& azimuth, const SweepTimingParams& timing,
                               const SweepCorrectionParams& correction,
                               const VerticalReferenceParams& vertical_reference)
    : vertical_angle_(vertical_angle),
      azimuth_(azimuth),
      timing_(timing),
      seam_(timingOfRawPoints(timing, azimuth)),
      correction_(correction),
      vertical_reference_(vertical_reference, vertical_angle.sigma_deg) {}

/// The last sweep, at its estimate: where the road's slope changes, the tilt that is predicted differs from it.
void SweepCorrector::lookAtLast(const CorrectedSweep& last, const SweepPrediction& prediction,
                                const Pose& T_cog_lidar) {
  const std::optional<double> last_s = std::exchange(last_s_, prediction.time_s());
  if (!prediction.motionKnown() || !last_s) return;
  // a sweep whose cloud did not arrive has an estimate, too
  if (std::abs(prediction.time_s() - prediction.dt_s - *last_s) > 0.5 * prediction.dt_s) return;
  vertical_reference_.observe(last.points_lidar, last.rings, prediction.T_odom_cog_previous * T_cog_lidar,
                              prediction.odom_reset_count);
}

SweepCorrectorReport SweepCorrector::correct(Sweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar,
                                             CorrectedSweep& corrected) {
  SweepCorrectorReport report;
  lookAtLast(corrected, prediction, T_cog_lidar);
  report.tilt_moment = vertical_reference_.tiltMoment();
  if (sweep.rings.empty()) sweep.rings = ringsByOrder(sweep.points_lidar);
  const std::optional<SweepSeam> seam = findSweepSeam(sweep.points_lidar);
  correctVerticalAngle(vertical_angle_.angle_deg * kDegree, sweep.points_lidar);
  correctAzimuth(azimuth_, sweep.points_lidar);
  vertical_reference_.apply(sweep.points_lidar);
  report.timing = timing_.assign(sweep, prediction.period_s, times_s_, prediction.stamp_error_s);
  if (report.timing.outliers > 0) dropUntimed(sweep, times_s_);
  if (report.timing.source == TimingSource::kField) {
    report.revolution_s = revolutionFromTimes(sweep.points_lidar, times_s_);
  }
  if (seam && report.timing.source == TimingSource::kAzimuth) seam_.observe(*seam);
  report.point_times_contradicted = seam_.contradicted();
  report.correction = correctSweep(correction_, sweep, times_s_, prediction.T_odom_cog_previous, prediction.T_odom_cog,
                                   prediction.dt_s, T_cog_lidar, corrected);
  // to the microsecond, as stamps are: what is computed from the two must not depend on when the drive was
  if (report.correction == CorrectionStatus::kCorrected) report.middle_s = wholeMicroseconds(middleOf(times_s_));
  return report;
}

}  // namespace fail_aware
