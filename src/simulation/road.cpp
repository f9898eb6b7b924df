#include "simulation/road.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kStep_m = 0.5;
constexpr double kLeadIn_m = 200.0, kFirstStraight_m = 40.0;
constexpr double kBlend_m = 40.0;
constexpr double kStreetCornerRadius_m = 13.0, kStreetCornerRamp_m = 6.0;
constexpr double kTurnBack_rad = 0.6;  // beyond this heading the road turns back

}  // namespace

Eigen::Vector2d RoadPoint::forward() const { return {std::cos(heading_rad), std::sin(heading_rad)}; }
Eigen::Vector2d RoadPoint::left() const { return {-std::sin(heading_rad), std::cos(heading_rad)}; }

Road::Road(std::uint64_t seed, const ScenePlan& plan) : plan_(plan), random_(combineKeys(seed, 11)) {
  first_index_ = static_cast<std::int64_t>(-kLeadIn_m / kStep_m);
  RoadPoint start;
  start.position.x() = -kLeadIn_m;
  points_.push_back(start);
  appendPiece({kLeadIn_m + kFirstStraight_m, 0.0, 0.0});
}

double Road::begin() const { return kStep_m * static_cast<double>(first_index_); }
double Road::end() const {
  return kStep_m * static_cast<double>(first_index_ + static_cast<std::int64_t>(points_.size()) - 1);
}

void Road::extendTo(double s_m) {
  while (end() < s_m) planBend();
}

void Road::forgetBefore(double s_m) {
  while (points_.size() > 2 && begin() + kStep_m < s_m) {
    points_.pop_front();
    ++first_index_;
  }
}

void Road::planBend() {
  const RoadCharacter& character = roadCharacter(kindAt(end()));
  const double heading = points_.back().heading_rad;
  appendPiece({random_.uniform(character.straight_min_m, character.straight_max_m), 0.0, 0.0});
  const bool corner = random_.chance(character.right_angle_ratio);
  double radius = random_.uniform(character.bend_radius_min_m, character.bend_radius_max_m);
  double angle = random_.uniform(character.bend_angle_min_rad, character.bend_angle_max_rad);
  double ramp = std::min(0.3 * radius, 0.4 * angle * radius);
  if (corner) {
    radius = kStreetCornerRadius_m;
    angle = 0.5 * M_PI;
    ramp = kStreetCornerRamp_m;
  }
  const double random_side = random_.sign();
  const double side = std::abs(heading) > kTurnBack_rad ? (heading > 0.0 ? -1.0 : 1.0) : random_side;
  const double curvature = side / radius;
  appendPiece({ramp, 0.0, curvature});
  appendPiece({std::max(kStep_m, angle * radius - ramp), curvature, curvature});
  appendPiece({ramp, curvature, 0.0});
}

void Road::appendPiece(const Piece& piece) {
  const int steps = std::max(1, static_cast<int>(std::lround(piece.length_m / kStep_m)));
  for (int i = 0; i < steps; ++i) {
    const double middle = (i + 0.5) / steps, after = (i + 1.0) / steps;
    const double curvature = piece.curvature_begin + middle * (piece.curvature_end - piece.curvature_begin);
    const RoadPoint& last = points_.back();
    RoadPoint next;
    const double middle_heading = last.heading_rad + 0.5 * curvature * kStep_m;
    next.position = last.position + kStep_m * Eigen::Vector2d(std::cos(middle_heading), std::sin(middle_heading));
    next.heading_rad = last.heading_rad + curvature * kStep_m;
    next.curvature_per_m = piece.curvature_begin + after * (piece.curvature_end - piece.curvature_begin);
    points_.push_back(next);
  }
}

RoadPoint Road::at(double s_m) const {
  const double place = std::clamp(s_m / kStep_m - static_cast<double>(first_index_), 0.0,
                                  static_cast<double>(points_.size() - 1) - 1e-9);
  const auto i = static_cast<std::size_t>(place);
  const double f = place - static_cast<double>(i);
  const RoadPoint &a = points_[i], &b = points_[i + 1];
  RoadPoint p;
  p.position = a.position + f * (b.position - a.position);
  p.heading_rad = a.heading_rad + f * (b.heading_rad - a.heading_rad);
  p.curvature_per_m = a.curvature_per_m + f * (b.curvature_per_m - a.curvature_per_m);
  return p;
}

double Road::blended(double s_m, double RoadCharacter::*value) const {
  const double before = roadCharacter(kindAt(s_m - 0.5 * kBlend_m)).*value;
  const double after = roadCharacter(kindAt(s_m + 0.5 * kBlend_m)).*value;
  if (before == after) return before;
  // the border lies within these 40 m; f: distance from the border to their end, as a ratio of 40 m
  const ScenePlan::Range range = plan_.partAt(s_m + 0.5 * kBlend_m);
  const double f = std::clamp((s_m + 0.5 * kBlend_m - range.begin_m) / kBlend_m, 0.0, 1.0);
  return before + f * (after - before);
}

double Road::halfWidth(double s_m) const { return blended(s_m, &RoadCharacter::half_width_m); }
double Road::laneOffset(double s_m) const { return blended(s_m, &RoadCharacter::lane_offset_m); }

double Road::project(const Eigen::Vector2d& p, double s_guess_m) const {
  double s = s_guess_m;
  for (int i = 0; i < 3; ++i) {
    const RoadPoint road = at(s);
    s += road.forward().dot(p - road.position);
  }
  return s;
}

double Road::distance(const Eigen::Vector2d& p, double s_m, double reach_m) const {
  constexpr std::int64_t kStride = 4;  // 2 m: an error of a few cm at most where it matters
  const auto index = [&](double s) {
    return std::clamp(static_cast<std::int64_t>(s / kStep_m) - first_index_, std::int64_t{0},
                      static_cast<std::int64_t>(points_.size()) - 1);
  };
  double nearest2 = 1e12;
  for (std::int64_t i = index(s_m - reach_m); i <= index(s_m + reach_m); i += kStride) {
    nearest2 = std::min(nearest2, (points_[static_cast<std::size_t>(i)].position - p).squaredNorm());
  }
  return std::sqrt(nearest2);
}

}  // namespace fail_aware
