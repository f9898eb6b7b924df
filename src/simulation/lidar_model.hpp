// A spinning lidar's geometry and errors. Default: a Velodyne HDL-64E as in KITTI (clockwise from
// the rear, 10 Hz, 2083 columns).
//
// The head gives the elevations of the beams (lidar_head.hpp).
// Calibration is imperfect: each beam has a range bias and an elevation error, constant over a drive and drawn from the
// seed. Added to this: range noise, the surface's roughness, pulses lost at random or because the return is weak
// (reflectivity, incidence, range squared). Rings count from the lowest beam. No failure modes. Cost: some ns a return.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulation/ray_caster.hpp"

namespace fail_aware {

class LidarModel {
 public:
  struct Params {
    std::string head = "hdl64e";
    int columns = 2083;
    double period_s = 0.1;
    double min_range_m = 0.9;
    double max_range_m = 120.0;
    double range_noise_m = 0.015;
    double range_bias_m = 0.025;        ///< standard deviation over the beams
    double elevation_error_deg = 0.08;  ///< standard deviation over the beams
    double dropout = 0.01;              ///< ratio of pulses lost at random

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("head", self.head);
      v("columns", self.columns);
      v("period_s", self.period_s);
      v("min_range_m", self.min_range_m);
      v("max_range_m", self.max_range_m);
      v("range_noise_m", self.range_noise_m);
      v("range_bias_m", self.range_bias_m);
      v("elevation_error_deg", self.elevation_error_deg);
      v("dropout", self.dropout);
    }
    void validate() const;
  };

  static constexpr std::size_t kMaxBeams = 128;

  LidarModel(std::uint64_t seed, const Params& params);

  std::size_t beams() const { return beams_.size(); }
  const Params& params() const { return params_; }

  /// The middle of a column: yaw in the sensor's frame (rad), seconds from the sweep's start.
  double azimuth(int column) const;
  double columnTime(int column) const;

  /// The true directions of the beams at this azimuth (sensor frame); `directions` has room for beams().
  void pointing(double azimuth_rad, Eigen::Vector3f* directions) const;

  struct Return {
    Eigen::Vector3f point_lidar;
    float intensity;  ///< 0..1
  };
  /// The sensor's report for this hit: none if the pulse is lost. `random_key`: unique per pulse.
  std::optional<Return> measure(std::size_t beam, double azimuth_rad, const RayHit& hit,
                                std::uint64_t random_key) const;

 private:
  struct Beam {
    float sin_nominal, cos_nominal, sin_real, cos_real;
    float range_bias_m;
  };
  Params params_;
  std::vector<Beam> beams_;
};

}  // namespace fail_aware
