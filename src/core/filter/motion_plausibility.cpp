#include "fail_aware_lidar_odometry/core/filter/motion_plausibility.hpp"

#include <algorithm>
#include <cmath>

#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"
#include "fail_aware_lidar_odometry/core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr int kSweepsToForgetPlanes = 10;
constexpr double kTimeSigmas = 2.0;  // of an innovation: it says nothing against the measurement

}  // namespace

void MotionPlausibility::Params::validate() const {
  requirePositive("lasting_disagreement_m", lasting_disagreement_m);
  requireNotNegative("lasting_innovation_m", lasting_innovation_m);
  requireWithin("fitting_share", fitting_share, 0.0, 1.0);
  requireNotNegative("unfitting_sigma_m", unfitting_sigma_m);
  requireNotNegative("usual_turn_deg", usual_turn_deg);
  requireWithin("wrong_share_of_turn", wrong_share_of_turn, 0.0, 1.0);
}

MotionPlausibility::MotionPlausibility(const Params& params) : params_(params) { params_.validate(); }

void MotionPlausibility::clear() {
  undecided_m_.clear();
  innovation_m_.clear();
  fitting_share_.clear();
  sweeps_without_planes_ = 0;
  fitted_ = false;
}

MotionPlausibility::Doubt MotionPlausibility::add(const Sweep& sweep) {
  undecided_m_.add(sweep.undecided_m);
  innovation_m_.add(std::max(0.0, sweep.innovation_m - kTimeSigmas * sweep.time_sigma_m));
  ++sweeps_without_planes_;
  if (sweep.fitting_share) {
    fitting_share_.add(*sweep.fitting_share);
    sweeps_without_planes_ = 0;
  }
  if (sweeps_without_planes_ > kSweepsToForgetPlanes) fitting_share_.clear();

  const double apart_m =
      undecided_m_.isFull() ? std::max(0.0, undecided_m_.median() - params_.lasting_disagreement_m) : 0.0;
  const double open_m = unfitting_m(), lasting_m = std::max(lastingInnovation_m(sweep.dt_s), open_m);
  const bool turned = params_.usual_turn_deg > 0.0 && sweep.turn_rad > params_.usual_turn_deg * kDegree;
  Doubt doubt;
  doubt.sigma_m = std::hypot(apart_m, lasting_m);
  doubt.sigma_yaw_rad = turned ? params_.wrong_share_of_turn * sweep.turn_rad : 0.0;
  doubt.unbelievable = lasting_m > 0.0 || turned;
  const bool fits_not = sweep.fitting_share && *sweep.fitting_share < params_.fitting_share;
  const bool fitted_not = fitting_share_.isFull() && fitting_share_.median() < params_.fitting_share;
  doubt.tells_no_motion = fitted_ && (fitted_not || fits_not);  // at once: a speed taken from one such sweep stays
  if (fitting_share_.isFull() && !fitted_not) fitted_ = true;
  return doubt;
}

double MotionPlausibility::lastingInnovation_m(double dt_s) const {
  if (params_.lasting_innovation_m == 0.0 || !innovation_m_.isFull()) return 0.0;
  const double periods = std::max(1.0, dt_s / kUsualPeriod_s);  // an acceleration grows with its square
  const double median_m = innovation_m_.median();
  return median_m > params_.lasting_innovation_m * periods * periods ? median_m : 0.0;
}

double MotionPlausibility::unfitting_m() const {
  if (params_.fitting_share == 0.0 || !fitting_share_.isFull()) return 0.0;
  return std::max(0.0, params_.unfitting_sigma_m * (1.0 - fitting_share_.median() / params_.fitting_share));
}

}  // namespace fail_aware
