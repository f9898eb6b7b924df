// Where a sweep begins and which way the head turns, as the cloud shows it: times that are taken from the azimuth
// (timing.hpp) are wrong by a whole period between the true start and the parameters' one.
//
// Told where the points come in the order of their measurement (a driver's packets): then consecutive blocks of points
// lie in consecutive directions, all around once. Clouds in another order (beam by beam, organised, filtered) and parts
// of a revolution tell nothing: no answer, no warning.
// Input: points in the lidar's frame, m. Azimuths: deg, counter-clockwise from the x axis, in (-180, 180].
// Cost: 20 us for 120 000 points (it looks at some 1500 of them).
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/core/sweep/timing.hpp"

namespace fail_aware {

struct SweepSeam {
  double start_azimuth_deg = 0.0;  ///< of the first points; a head's lasers, which point to both sides of it, averaged
  bool clockwise = true;           ///< seen from above
};

/// Nothing: the points' order does not tell it.
std::optional<SweepSeam> findSweepSeam(const std::vector<Eigen::Vector3f>& points_lidar);

/// Compares what the last sweeps show with the parameters. Give it the seams of sweeps that are timed by their azimuth.
class SweepSeamCheck {
 public:
  static constexpr double kTolerance_deg = 10.0;   ///< beyond it a 36th of the points is timed wrong
  static constexpr std::size_t kSweepsKept = 11;   ///< of them most must contradict
  static constexpr std::size_t kSweepsNeeded = 3;  ///< before anything is said

  explicit SweepSeamCheck(const SweepTimingParams& params) : params_(params) {}

  void observe(const SweepSeam& seam);
  void reset() { seams_.clear(); }

  /// One line for people: what the clouds show, what the parameters say and what to set. Empty: no contradiction.
  std::string contradiction() const;

 private:
  bool contradicts(const SweepSeam& seam) const;

  SweepTimingParams params_;
  std::deque<SweepSeam> seams_;
};

}  // namespace fail_aware
