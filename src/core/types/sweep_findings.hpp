// Results of the checks of a raw sweep (explained in preprocessing/sweep_check.hpp), and what its correction shows
// about the head.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace fail_aware {

struct SweepFindings {
  bool incomplete = false;
  bool low_visibility = false;
  bool frozen = false;
  bool repeats = false;
  bool time_jump = false;
  bool partial_start = false;
  double azimuth_coverage = 0.0;  ///< ratio of the sectors that hold points; 0 for an empty sweep
  double view_range_m = 0.0;      ///< 2 % of the points are farther; 0 for an empty sweep
  int repetitions = 0;            ///< consecutive sweeps that repeated the previous one
  // From SweepCorrectorReport, not from SweepCheck.
  double middle_s = 0.0;                       ///< middle of the points' times, s relative to the stamp
  double revolution_s = 0.0;                   ///< time of one revolution of the head, s; 0: not known
  std::optional<Eigen::Matrix2d> tilt_moment;  ///< none: not known anew
  bool time_field_refused = false;             ///< TimingResult::guessed()
  bool point_times_contradicted = false;       ///< SweepSeamCheck::contradicted()
};

/// Nothing of the sweep is used. `first`: of a drive.
inline bool isLeftOut(const SweepFindings& findings, bool first) {
  return findings.partial_start || (findings.repeats && !first);
}

}  // namespace fail_aware
