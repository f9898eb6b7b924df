// From a raw sweep to a corrected one: rings where they have to be found, vertical angle, azimuth, vertical reference,
// time of each point, constant-twist correction, in this order. Before, the vertical reference learns from the
// corrected points of the last sweep, at its estimate.
// What the SweepCorrection nodelet holds. Cost: about 1 ms for 120 000 points, 6 ms with a look.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/preprocessing/angle_corrections.hpp"
#include "core/preprocessing/correction.hpp"
#include "core/preprocessing/sweep_seam.hpp"
#include "core/preprocessing/timing.hpp"
#include "core/preprocessing/vertical_reference.hpp"
#include "core/types/corrected_sweep.hpp"
#include "core/types/sweep_findings.hpp"
#include "core/types/sweep_prediction.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

struct SweepCorrectorReport {
  TimingResult timing;
  CorrectionStatus correction = CorrectionStatus::kOff;
  /// Middle of the points' times, s relative to the stamp; 0 if nothing was corrected. At this instant the sweep's
  /// place does not depend on the motion that was corrected for.
  double middle_s = 0.0;
  double revolution_s = 0.0;  ///< of the head, from the points' times (revolution.hpp); 0: not known
  Eigen::Matrix2d tilt_moment = Eigen::Matrix2d::Zero();  ///< VerticalReference::tiltMoment()
  bool point_times_contradicted = false;                  ///< SweepSeamCheck::contradicted()

  /// What the estimator and the monitor need of it.
  void addTo(SweepFindings& findings) const {
    findings.middle_s = middle_s;
    findings.revolution_s = revolution_s;
    findings.tilt_moment = tilt_moment;
    findings.time_field_refused = timing.guessed();
    findings.point_times_contradicted = point_times_contradicted;
  }
};

class SweepCorrector {
 public:
  /// timing: for points whose azimuth is corrected (SensorParameters::correctedTiming()).
  SweepCorrector(const VerticalAngleCorrectionParams& vertical_angle, const AzimuthCorrectionParams& azimuth,
                 const SweepTimingParams& timing, const SweepCorrectionParams& correction,
                 const VerticalReferenceParams& vertical_reference);

  /// `sweep` is changed by the corrections of its angles and by the vertical reference, and given rings where it has
  /// none and its order shows them; points without a usable time are left out (TimingResult::outliers). The motion
  /// corrected for is that from the previous estimate to the prediction; in the first sweep, where there is none,
  /// points stay and times are kept. `corrected`: on input the corrected points of the last sweep.
  SweepCorrectorReport correct(Sweep& sweep, const SweepPrediction& prediction, const Pose& T_cog_lidar,
                               CorrectedSweep& corrected);

  const VerticalReference& verticalReference() const { return vertical_reference_; }

  /// One line: how the clouds contradict the timing's parameters (sweep_seam.hpp). Empty: they do not.
  std::string seamContradiction() const { return seam_.contradiction(); }

  void reset() {
    timing_.reset();
    seam_.reset();
    vertical_reference_.reset();
    last_s_.reset();
  }

 private:
  void lookAtLast(const CorrectedSweep& last, const SweepPrediction& prediction, const Pose& T_cog_lidar);

  VerticalAngleCorrectionParams vertical_angle_;
  AzimuthCorrectionParams azimuth_;
  SweepTiming timing_;
  SweepSeamCheck seam_;
  SweepCorrectionParams correction_;
  VerticalReference vertical_reference_;
  std::optional<double> last_s_;  ///< time of the last sweep
  std::vector<float> times_s_;
};

}  // namespace fail_aware
