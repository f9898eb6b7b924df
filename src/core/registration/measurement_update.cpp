#include "core/registration/measurement_update.hpp"

#include "core/registration/normal_equations.hpp"

namespace fail_aware {

void addOffset(const Vector6d& along, double offset, double sigma, Measurement& measurement) {
  const Vector6d C_along = measurement.covariance * along;
  const Vector6d gain = C_along / (along.dot(C_along) + sigma * sigma);
  measurement.T_odom_cog = applyStep(measurement.T_odom_cog, gain * offset);
  measurement.covariance -= (gain * C_along.transpose()).eval();
  measurement.covariance = (0.5 * (measurement.covariance + measurement.covariance.transpose())).eval();
}

void addPosition(const Eigen::Vector3d& axis, double offset_m, double sigma_m, Measurement& measurement) {
  Vector6d along = Vector6d::Zero();
  along.head<3>() = axis;
  addOffset(along, offset_m, sigma_m, measurement);
}

}  // namespace fail_aware
