#include "simulation/lidar_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "simulation/lidar_head.hpp"
#include "simulation/random.hpp"

namespace fail_aware {

namespace {

// The weakest detected return: the sensor's data sheet gives asphalt (0.1) up to 50 m, a car (0.8) up to 120 m.
constexpr float kWeakestReturn = 1.25e-5f;
constexpr float kIncidenceFloor = 0.3f;  // ratio of the return that does not depend on the angle

}  // namespace

void LidarModel::Params::validate() const {
  requireParameter(!lidarHeadElevationsDeg(head).empty(), "head", head, "a head of lidar_head.hpp");
  requireParameter(columns >= 16 && columns <= 20000, "columns", columns, "in [16, 20000]");
  requireWithin("period_s", period_s, 0.02, 1.0);
  requireParameter(std::isfinite(period_s) && std::abs(period_s * 1e3 - std::round(period_s * 1e3)) < 1e-6, "period_s",
                   period_s, "a whole number of milliseconds");
  requireNotNegative("min_range_m", min_range_m);
  requireWithin("max_range_m", max_range_m, 1.0, 125.0);
  requireNotNegative("range_noise_m", range_noise_m);
  requireNotNegative("range_bias_m", range_bias_m);
  requireWithin("elevation_error_deg", elevation_error_deg, 0.0, 5.0);
  requireWithin("dropout", dropout, 0.0, 1.0);
}

LidarModel::LidarModel(std::uint64_t seed, const Params& params) : params_(params) {
  params_.validate();
  RandomStream random(combineKeys(seed, 51));
  for (const double elevation_deg : lidarHeadElevationsDeg(params_.head)) {
    const double nominal = elevation_deg * kDegree;
    const double real = nominal + params_.elevation_error_deg * kDegree * random.normal();
    beams_.push_back({static_cast<float>(std::sin(nominal)), static_cast<float>(std::cos(nominal)),
                      static_cast<float>(std::sin(real)), static_cast<float>(std::cos(real)),
                      static_cast<float>(params_.range_bias_m * random.normal())});
  }
}

double LidarModel::azimuth(int column) const { return M_PI - 2.0 * M_PI * (column + 0.5) / params_.columns; }
double LidarModel::columnTime(int column) const { return params_.period_s * (column + 0.5) / params_.columns; }

void LidarModel::pointing(double azimuth_rad, Eigen::Vector3f* directions) const {
  const auto c = static_cast<float>(std::cos(azimuth_rad)), s = static_cast<float>(std::sin(azimuth_rad));
  for (const Beam& beam : beams_) *directions++ = {beam.cos_real * c, beam.cos_real * s, beam.sin_real};
}

std::optional<LidarModel::Return> LidarModel::measure(std::size_t beam_index, double azimuth_rad, const RayHit& hit,
                                                      std::uint64_t random_key) const {
  if (!hit.hit()) return std::nullopt;
  const MaterialProperties& surface = properties(hit.material);
  const std::uint64_t bits = mixBits(random_key);
  if (uniformFromBits(bits) < params_.dropout + static_cast<double>(surface.dropout)) return std::nullopt;
  const float incidence = kIncidenceFloor + (1.0f - kIncidenceFloor) * hit.incidence_cos;
  const float strength = surface.reflectivity * incidence / (hit.range_m * hit.range_m) / kWeakestReturn;
  // always detected above 1.3 times the weakest, never below 0.7 times
  if (strength < 0.7f + 0.6f * static_cast<float>(uniformFromBits(mixBits(bits + 1)))) return std::nullopt;

  const Beam& beam = beams_[beam_index];
  const auto noise_m = static_cast<float>(params_.range_noise_m);
  const float sigma_m = std::sqrt(noise_m * noise_m + surface.roughness_m * surface.roughness_m);
  const float range_m = hit.range_m + beam.range_bias_m + sigma_m * normalFromBits(mixBits(bits + 2));
  if (range_m < static_cast<float>(params_.min_range_m)) return std::nullopt;
  const auto c = static_cast<float>(std::cos(azimuth_rad)), s = static_cast<float>(std::sin(azimuth_rad));
  const float grain = 0.04f * normalFromBits(mixBits(bits + 3));
  return Return{range_m * Eigen::Vector3f(beam.cos_nominal * c, beam.cos_nominal * s, beam.sin_nominal),
                std::clamp(surface.reflectivity * incidence + grain, 0.0f, 1.0f)};
}

}  // namespace fail_aware
