// The road's centre line. It is generated on demand, bend by bend, and deleted behind the vehicle.
//
// Bends have curvature ramps at both ends, as real ones have. The road keeps within about 100 deg of the world's x, so
// it never crosses itself. Arc length s is 0 at the world's origin; the road begins straight, 200 m before the origin.
// at(s) is valid from `begin()` to `end()` and clamped outside. The same seed and plan give the same road in any order
// of calls. Cost: one point per 0.5 m; at(): two look-ups.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>

#include "simulation/random.hpp"
#include "simulation/scene_kind.hpp"

namespace fail_aware {

struct RoadPoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< m
  double heading_rad = 0.0;
  double curvature_per_m = 0.0;  ///< > 0: left bend

  Eigen::Vector2d forward() const;
  Eigen::Vector2d left() const;
};

class Road {
 public:
  Road(std::uint64_t seed, const ScenePlan& plan);

  void extendTo(double s_m);
  void forgetBefore(double s_m);
  double begin() const;
  double end() const;

  RoadPoint at(double s_m) const;
  /// Half of the asphalt's width; changes over 40 m between the plan's parts.
  double halfWidth(double s_m) const;
  /// Distance of the own lane's centre to the right of the road's centre line; changes likewise.
  double laneOffset(double s_m) const;
  SceneKind kindAt(double s_m) const { return plan_.kindAt(s_m); }
  const ScenePlan& plan() const { return plan_; }

  /// s of the centre-line point closest to p, by Newton steps from a close guess.
  double project(const Eigen::Vector2d& p, double s_guess_m) const;
  /// Distance (m) from p to the nearest existing centre-line point within `reach_m` of s.
  double distance(const Eigen::Vector2d& p, double s_m, double reach_m) const;

 private:
  struct Piece {
    double length_m, curvature_begin, curvature_end;
  };
  void planBend();
  void appendPiece(const Piece& piece);
  double blended(double s_m, double RoadCharacter::*value) const;

  ScenePlan plan_;
  RandomStream random_;
  std::deque<RoadPoint> points_;
  std::int64_t first_index_ = 0;  ///< points_[0] is at s = first_index_ * kStep
};

}  // namespace fail_aware
