#include "core/aiding/open_country_aid.hpp"

#include <algorithm>

#include "core/geometry/degree.hpp"

namespace fail_aware {

namespace {

// Hysteresis: in the kOpenSweeps sweeps after a clearly open one, the limit of the planes' ratio is kStaysOpen times as
// large. Clearly open: the planes' ratio is below its limit, the above-ground ratio below kClearlyOpen of its limit.
constexpr double kStaysOpen = 1.5;
constexpr int kOpenSweeps = 5;
constexpr double kClearlyOpen = 0.5;

}  // namespace

OpenCountryAid::Result OpenCountryAid::find(const RegistrationScan& scan, const LocalMap& map,
                                            const InitialGuess& guess, double sigma_yaw_rad) {
  Result result;
  const AboveGroundMatcher::Params& params = match_.params();
  if (!params.reference.enabled) return result;
  const double slack = open_sweeps_left_ > 0 ? kStaysOpen : 1.0;
  open_sweeps_left_ = std::max(0, open_sweeps_left_ - 1);
  const double ratio = match_.ratioOfPlanes(scan.cloud.plane_points_cog, map.map(), guess.T_odom_cog, sigma_yaw_rad);
  nearly_open_ = ratio <= kStaysOpen * params.max_information_ratio;
  if (ratio > slack * params.max_information_ratio) return result;
  const AboveGroundPoints above_ground = match_.select(scan.cloud.map_points_cog);
  result.open_country = above_ground.ratio <= params.reference.max_above_ground_ratio;
  if (!result.open_country) return result;
  if (ratio <= params.max_information_ratio &&
      above_ground.ratio <= kClearlyOpen * params.reference.max_above_ground_ratio) {
    open_sweeps_left_ = kOpenSweeps;
  }
  result.pose = match_.find(above_ground, map.aboveGround(), guess.T_odom_cog);
  return result;
}

void OpenCountryAid::reset() {
  open_sweeps_left_ = 0;
  nearly_open_ = true;
}

void inflateInOpenCountry(const AboveGroundMatcher::Params& params, const InitialGuess& guess,
                          Measurement& measurement) {
  if (!measurement.ok()) return;
  // what travels with the sensor causes an error of at most the distance driven
  const double distance_m = guess.twist_cog.head<3>().norm() * guess.dt_s;
  const double surface_sigma_m = std::min(params.surface_sigma_m, 0.5 * distance_m);
  const double surface_sigma_rad = params.surface_sigma_deg * kDegree * surface_sigma_m / params.surface_sigma_m;
  measurement.covariance.diagonal().head<2>().array() += surface_sigma_m * surface_sigma_m;
  measurement.covariance(5, 5) += surface_sigma_rad * surface_sigma_rad;
}

Measurement aboveGroundMeasurement(const AboveGroundPose& pose) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.T_odom_cog = pose.T_odom_cog;
  measurement.covariance = kUnobservedVariance * Matrix6d::Identity();
  setHorizontalBlock(pose.covariance, measurement.covariance);
  return measurement;
}

}  // namespace fail_aware
