#include "core/aiding/open_country_aid.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/geometry/symmetric_eigen.hpp"
#include "core/registration/measurement_update.hpp"

namespace fail_aware {

namespace {

// Hysteresis: in the kOpenSweeps sweeps after a clearly open one, the limit of the planes' ratio is kStaysOpen times as
// large. Clearly open: the planes' ratio is below its limit, the above-ground ratio below kClearlyOpen of its limit.
constexpr double kStaysOpen = 2.0;
constexpr int kOpenSweeps = 5;
constexpr double kClearlyOpen = 0.5;

}  // namespace

OpenCountryAid::Result OpenCountryAid::find(const RegistrationScan& scan, const LocalMap& map,
                                            const InitialGuess& guess, double sigma_yaw_rad) {
  Result result;
  const AboveGroundMatcher::Params& params = match_.params();
  if (!params.enabled) return result;
  const double slack = open_sweeps_left_ > 0 ? kStaysOpen : 1.0;
  open_sweeps_left_ = std::max(0, open_sweeps_left_ - 1);
  const double share = match_.ratioOfPlanes(scan.cloud.plane_points_cog, map.map(), guess.T_odom_cog, sigma_yaw_rad);
  nearly_open_ = share <= kStaysOpen * params.max_information_ratio;
  if (share > slack * params.max_information_ratio) return result;
  const AboveGroundPoints standing = match_.select(scan.cloud.map_points_cog);
  result.open_country = standing.share <= params.max_above_ground_ratio;
  if (!result.open_country) return result;
  if (share <= params.max_information_ratio && standing.share <= kClearlyOpen * params.max_above_ground_ratio) {
    open_sweeps_left_ = kOpenSweeps;
  }
  result.pose = match_.find(standing, map.standing(), guess.T_odom_cog);
  return result;
}

void OpenCountryAid::reset() {
  open_sweeps_left_ = 0;
  nearly_open_ = true;
}

void addOpenCountry(const OpenCountryAid::Result& found, const AboveGroundMatcher::Params& params,
                    const InitialGuess& guess, Measurement& measurement) {
  if (!found.open_country || !measurement.ok()) return;
  // what travels with the sensor causes an error of at most the distance driven
  const double distance_m = guess.twist_cog.head<3>().norm() * guess.dt_s;
  const double surface_sigma_m = std::min(params.surface_sigma_m, 0.5 * distance_m);
  const double surface_sigma_rad = params.surface_sigma_deg * kDegree * surface_sigma_m / params.surface_sigma_m;
  measurement.covariance.diagonal().head<2>().array() += surface_sigma_m * surface_sigma_m;
  measurement.covariance(5, 5) += surface_sigma_rad * surface_sigma_rad;
  if (!found.pose) return;
  const Pose& T = found.pose->T_odom_cog;
  const auto eigen = symmetricEigen(found.pose->covariance);
  for (int i = 0; i < 3; ++i) {  // along the eigenvectors the errors are independent
    Vector6d direction = Vector6d::Zero();
    direction.head<2>() = eigen.eigenvectors().col(i).head<2>();
    direction[5] = eigen.eigenvectors()(2, i);
    Vector6d offset;
    offset << T.translation() - measurement.T_odom_cog.translation(),
        logSo3(T.linear() * measurement.T_odom_cog.linear().transpose());
    addOffset(direction, direction.dot(offset), std::sqrt(std::max(eigen.eigenvalues()[i], 0.0)), measurement);
  }
}

}  // namespace fail_aware
