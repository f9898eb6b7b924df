// The start of a sweep and the head's direction of rotation, from the cloud. Times from the azimuth (timing.hpp) are
// wrong by a whole period between the true start and the configured one. Not in the paper.
//
// This works if the points are in the order of measurement (a driver's packets): consecutive blocks of points then lie
// in consecutive directions, once around. Clouds in another order (beam by beam, organised, filtered) and parts of a
// revolution give no answer and no warning.
// Input: points in the lidar's frame, m. Azimuths: deg, counter-clockwise from the x axis, in (-180, 180].
// Failure: nullopt. Cost: 20 us for 120 000 points (about 1500 of them are used).
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/preprocessing/timing.hpp"

namespace fail_aware {

struct SweepSeam {
  double start_azimuth_deg = 0.0;  ///< of the first points; mean over a head's lasers, which point to both sides of it
  bool clockwise = true;           ///< seen from above
};

/// nullopt: the points' order does not show the seam.
std::optional<SweepSeam> findSweepSeam(const std::vector<Eigen::Vector3f>& points_lidar);

/// Compares the last sweeps with the parameters. Pass the seams of sweeps that are timed by their azimuth.
class SweepSeamCheck {
 public:
  static constexpr double kTolerance_deg = 10.0;   ///< beyond it a 36th of the points gets wrong times
  static constexpr std::size_t kSweepsKept = 11;   ///< most of them must contradict the parameters
  static constexpr std::size_t kSweepsNeeded = 3;  ///< before a contradiction is reported

  explicit SweepSeamCheck(const SweepTimingParams& params) : params_(params) {}

  void observe(const SweepSeam& seam);
  void reset() { seams_.clear(); }

  /// Most of the last sweeps contradict the parameters.
  bool contradicted() const;

  /// One line for people: what the clouds show, what the parameters say and what to set. Empty: no contradiction.
  std::string contradiction() const;

 private:
  bool contradicts(const SweepSeam& seam) const;

  SweepTimingParams params_;
  std::deque<SweepSeam> seams_;
};

}  // namespace fail_aware
