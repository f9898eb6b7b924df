#include "core/registration/look_ahead.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"
#include "plane_pairs.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kPlaces = 10;
constexpr double kSpacing_m = 10.0;
constexpr double kRadius_m = 25.0;
constexpr std::size_t kFirst = 2;           // the sweep itself registers against what is nearer
constexpr std::size_t kStretch = 3;         // places: a gap between two houses is shorter
constexpr int kFewestPoints = 12;           // around a place
constexpr std::size_t kStride = 2;          // every so many points
constexpr double kMaxWallZ = 0.5;           // a wall's normal is within 30 deg of the horizontal
constexpr double kAsGoodAsNothing = 0.002;  // a smaller ratio is as weak as any
constexpr double kSameRatio = 2.0;          // so much more is still the same stretch
constexpr double kReverse_mps = 0.5;        // slower, it stands
constexpr double kMinSpeed_mps = 3.0;       // slower, the curvature is not known
constexpr double kMaxCurvature = 0.05;      // 1/m: sharper bends leave the view

struct PlaceAhead {
  Eigen::Vector2d position_odom = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  double by_chance = 0.0;  ///< in each direction, by the errors of the normals
  int points = 0;

  /// Of the weakest direction.
  double ratio() const {
    return std::clamp((symmetricEigenvalues(information)[0] - by_chance) / std::max(information.trace(), 1e-9), 0.0,
                      0.5);
  }
};

using Places = std::array<PlaceAhead, kPlaces>;

Places placesAhead(const Pose& T_odom_cog, const Vector6d& twist_cog) {
  const double speed_mps = twist_cog[0];
  const double curvature =
      std::abs(speed_mps) < kMinSpeed_mps ? 0.0 : std::clamp(twist_cog[5] / speed_mps, -kMaxCurvature, kMaxCurvature);
  const double heading = rpyFromRotation(T_odom_cog.linear()).z();
  Places places;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const double way_m = (speed_mps < -kReverse_mps ? -1.0 : 1.0) * kSpacing_m * static_cast<double>(k);
    const double half_turn = 0.5 * curvature * way_m, direction = heading + half_turn;
    const double chord_m = std::abs(half_turn) < 1e-6 ? way_m : way_m * std::sin(half_turn) / half_turn;
    places[k].position_odom =
        T_odom_cog.translation().head<2>() + chord_m * Eigen::Vector2d(std::cos(direction), std::sin(direction));
  }
  return places;
}

// `weight`: without the growth by the range from here.
void add(const PlanePair& pair, double weight, Places& places) {
  const Eigen::Vector2d position = pair.position.head<2>(), normal = pair.normal.head<2>();
  for (PlaceAhead& place : places) {
    if ((position - place.position_odom).squaredNorm() > kRadius_m * kRadius_m) continue;
    place.information += weight * normal * normal.transpose();
    place.by_chance += weight * pair.normal_variance;
    ++place.points;
  }
}

// The best place of each stretch counts, and of the stretches the first that is about as weak as the weakest.
InformationAhead weakestStretch(const Places& places) {
  std::array<double, kPlaces> ratios;
  ratios.fill(1.0);  // where nothing is seen
  double weakest = 1.0;
  for (std::size_t k = kFirst; k + kStretch <= kPlaces; ++k) {
    const auto begin = places.begin() + k, end = begin + kStretch;
    if (std::any_of(begin, end, [](const PlaceAhead& place) { return place.points < kFewestPoints; })) continue;
    const auto less = [](const PlaceAhead& a, const PlaceAhead& b) { return a.ratio() < b.ratio(); };
    ratios[k] = std::max_element(begin, end, less)->ratio();
    weakest = std::min(weakest, ratios[k]);
  }
  if (!(weakest < 1.0)) return {};
  const double as_weak = std::max(kSameRatio * weakest, kAsGoodAsNothing);
  const auto first =
      std::find_if(ratios.begin() + kFirst, ratios.end(), [&](double ratio) { return ratio <= as_weak; });
  return {weakest, kSpacing_m * static_cast<double>(first - ratios.begin())};
}

}  // namespace

InformationAhead lookAhead(const IcpPointToPlane::Params& params, const std::vector<Eigen::Vector3f>& points_cog,
                           const VoxelMap& map, const Pose& T_odom_cog, const Vector6d& twist_cog) {
  if (!isFinite(T_odom_cog) || !twist_cog.allFinite()) return {};
  Places places = placesAhead(T_odom_cog, twist_cog);
  PlanePairs pairs(params, points_cog, map, T_odom_cog, 0.0, kStride);
  pairs.forEach(T_odom_cog, params.kernel_m, kAsCorrected, [&](const PlanePair& pair, std::size_t i) {
    if (std::abs(pair.normal.z()) > kMaxWallZ) return;
    const double range_m = params.range_weight_m > 0.0 ? std::max(1.0, static_cast<double>(points_cog[i].norm())) : 1.0;
    add(pair, pair.weight / range_m, places);
  });
  return weakestStretch(places);
}

}  // namespace fail_aware
