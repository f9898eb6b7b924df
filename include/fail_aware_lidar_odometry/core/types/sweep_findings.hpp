// What the checks of a raw sweep found (each is explained in sweep/sweep_check.hpp), and what its correction tells of
// the head.
#pragma once

namespace fail_aware {

struct SweepFindings {
  bool incomplete = false;
  bool low_visibility = false;
  bool frozen = false;
  bool repeats = false;
  bool time_jump = false;
  double azimuth_coverage = 0.0;  ///< share of the sectors that hold points; 0 for an empty sweep
  double far_ratio = 0.0;         ///< share of the points beyond visible_range_m
  int repetitions = 0;            ///< sweeps in a row that repeated the one before
  // Of SweepCorrectorReport; not found by SweepCheck.
  double middle_s = 0.0;            ///< of the points' times, s relative to the stamp
  double revolution_s = 0.0;        ///< time of one turn of the head, s; 0: not known
  bool time_field_refused = false;  ///< TimingResult::guessed()
};

}  // namespace fail_aware
