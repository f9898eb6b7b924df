// The road's centre line: made up as it is asked for, bend by bend, forgotten behind the vehicle.
//
// Bends have ramps of curvature at both ends, as real ones have. The road keeps within about 100 deg of the world's x,
// so it never meets itself. Arc length s from 0 at the world's origin; it begins straight, 200 m before that.
// at(s) is valid from `begin()` to `end()`, and clamped beyond. Same seed and plan: same road, however it is asked for.
// Cost: one point in 0.5 m; at(): two look-ups.
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
  double curvature_per_m = 0.0;  ///< > 0: to the left

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
  /// Half the asphalt's width; changes over 40 m between the plan's parts.
  double halfWidth(double s_m) const;
  /// Own lane's centre to the right of the road's; likewise.
  double laneOffset(double s_m) const;
  SceneKind kindAt(double s_m) const { return plan_.kindAt(s_m); }
  const ScenePlan& plan() const { return plan_; }

  /// s of the point beside p, by Newton steps from a near guess.
  double project(const Eigen::Vector2d& p, double s_guess_m) const;
  /// Distance (m) of p from the nearest centre-line point known, among those within `reach_m` of s.
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
