#include "core/estimation/consistency_monitor.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr double kForgetFit_s = 1.05;  // without planes
// At first the map holds a sweep or two: with 32 beams 0.24 and 0.33 of the points fit, though the pose is right.
constexpr int kYoungMap = 2;         // sweeps
constexpr double kTimeSigmas = 2.0;  // this much of an innovation can come from the interval's uncertainty
// Residuals of the points that fit. Simulated: sound sweeps leave 0.02 to 0.04 m, with 80 % of false returns in
// addition 0.043, with a noise of 0.05 m less than this, of 0.12 m 0.06, of 0.2 m 0.07.
constexpr double kNoisyResidual_m = 0.05;

// On real and simulated roads roll and pitch change by 0.2 to 0.5 deg more than predicted, at most; a speed bump tilts a
// car by 2 deg. If the lidar's mount tilts by 6 deg, the first sweep is off by 4.1 deg.
constexpr double kLargestTilt_rad = 3.5 * kDegree;

// A jump of less than this that the map confirms is the vehicle's: what a scene repeats is farther apart.
constexpr double kShortJump_m = 0.3;
constexpr double kOffWholeSweeps = 0.1;          // of the distance per sweep
constexpr double kMostLost = 5.0;                // sweeps
constexpr double kAsClose = 1.2, kAsMuch = 0.9;  // ratios to the sweeps before

// Whether the points are noisy: 0 to 1, by degrees.
double noisyRatio(double rms_residual_m) {
  const double ratio = rms_residual_m / kNoisyResidual_m;
  return std::sqrt(std::clamp(ratio * ratio - 1.0, 0.0, 1.0));
}

// Whether the jump is what lost sweeps that the stamps do not count leave: ahead by whole sweeps. A jump back is what
// repeated points leave.
bool isOfLostSweeps(const ConsistencyMonitor::Sweep& jump) {
  if (jump.per_period_m < kShortJump_m) return false;
  const double lost = std::round(jump.ahead_m / jump.per_period_m);
  const double aside_m = std::sqrt(std::max(0.0, jump.innovation_m * jump.innovation_m - jump.ahead_m * jump.ahead_m));
  const double off_m = std::hypot(jump.ahead_m - lost * jump.per_period_m, aside_m);
  return lost >= 1.0 && lost <= kMostLost && off_m <= kOffWholeSweeps * jump.per_period_m;
}

}  // namespace

void ConsistencyMonitor::clear() {
  lost_motion_.clear();
  forgetSweeps();
}

void ConsistencyMonitor::forgetSweeps() {
  undecided_m_.clear();
  innovation_m_.clear();
  residual_m_.clear();
  recent_fit_.clear();
  fitting_ratio_.clear();
  without_planes_s_ = 0.0;
  sweeps_in_map_ = 0;
  fitted_ = false;
}

ConsistencyMonitor::Inflation ConsistencyMonitor::add(const Sweep& sweep) {
  undecided_m_.add(sweep.undecided_m);
  const double innovation_m = std::max(0.0, sweep.innovation_m - kTimeSigmas * sweep.time_sigma_m);
  innovation_m_.add(innovation_m);
  without_planes_s_ += sweep.dt_s;
  if (without_planes_s_ > kForgetFit_s) recent_fit_.clear();
  double fit = 0.0;
  bool fits_not = false;
  if (sweep.inlier_ratio) {
    without_planes_s_ = 0.0;
    residual_m_.add(sweep.rms_residual_m);
    if (++sweeps_in_map_ > kYoungMap) {
      fit = fitting_ratio_.add(*sweep.inlier_ratio, sweep.inliers);
      fits_not = fit < params_.fitting_ratio;
      recent_fit_.add(fit);
    }
  }

  const double apart_m =
      undecided_m_.isFull() ? std::max(0.0, undecided_m_.median() - params_.persistent_disagreement_m) : 0.0;
  const double open_m = unfitting_m(), persistent_m = std::max(persistentInnovation_m(sweep.dt_s), open_m);
  const double found_m = fitted_ && sweep.inlier_ratio && !recent_fit_.isFull() ? sweep.disagreement_m : 0.0;
  const bool turned = params_.max_yaw_innovation_deg > 0.0 &&
                      (sweep.turn_rad > params_.max_yaw_innovation_deg * kDegree || sweep.tilt_rad > kLargestTilt_rad);
  const bool confirmed = sweep.overruled && fitsAsBefore(sweep, fit);
  Inflation inflation;
  inflation.sweeps_lost = confirmed && isOfLostSweeps(sweep);
  const bool explained = inflation.sweeps_lost || (confirmed && sweep.innovation_m < kShortJump_m);
  const double jump_m = sweep.overruled && !explained ? innovation_m : 0.0;
  const double noisy = residual_m_.isFull() ? noisyRatio(residual_m_.median()) : 0.0;
  inflation.doubt.sigma_m =
      std::hypot(std::hypot(apart_m, persistent_m, jump_m), std::hypot(found_m, noisy * sweep.increment_sigma_m));
  inflation.doubt.sigma_yaw_rad =
      std::hypot(turned ? params_.wrong_ratio_of_turn * sweep.turn_rad : 0.0, noisy * sweep.increment_sigma_yaw_rad);
  inflation.unbelievable = persistent_m > 0.0 || jump_m > 0.0 || turned;
  const bool fitted_not = recent_fit_.isFull() && recent_fit_.median() < params_.fitting_ratio;
  inflation.velocity_unobservable =
      fitted_ && (fitted_not || fits_not);  // without delay: a speed taken from one such sweep persists
  if (recent_fit_.isFull() && !fitted_not) fitted_ = true;
  inflation.motion_lost = lost_motion_.add(sweep.dead_reckoned, sweep.inlier_ratio);
  if (inflation.motion_lost) forgetSweeps();
  return inflation;
}

// The points fit as closely, and as many of them, as in the sweeps before.
bool ConsistencyMonitor::fitsAsBefore(const Sweep& sweep, double fit) const {
  return sweep.inlier_ratio && residual_m_.isFull() && recent_fit_.isFull() &&
         sweep.rms_residual_m <= kAsClose * residual_m_.median() && fit >= kAsMuch * recent_fit_.median();
}

double ConsistencyMonitor::persistentInnovation_m(double dt_s) const {
  if (params_.persistent_innovation_m == 0.0 || !innovation_m_.isFull()) return 0.0;
  const double periods = std::max(1.0, dt_s / kUsualPeriod_s);  // displacement grows with the square of the time
  const double median_m = innovation_m_.median();
  return median_m > params_.persistent_innovation_m * periods * periods ? median_m : 0.0;
}

double ConsistencyMonitor::unfitting_m() const {
  if (params_.fitting_ratio == 0.0 || !recent_fit_.isFull()) return 0.0;
  return std::max(0.0, params_.unfitting_sigma_m * (1.0 - recent_fit_.median() / params_.fitting_ratio));
}

}  // namespace fail_aware
