#include "simulation/traffic.hpp"

#include <algorithm>
#include <cmath>

namespace fail_aware {

namespace {

constexpr double kAppear_m = 170.0, kVanish_m = 130.0;
constexpr double kGap_m = 9.0, kGap_s = 1.5;
constexpr double kGapSwing_m = 3.0, kGapSwing_s = 24.0;
constexpr double kRingLane_m = 3.1;

VehicleShape randomShape(RandomStream& random) {
  const double draw = random.uniform();
  return draw < 0.75 ? VehicleShape::kCar : draw < 0.88 ? VehicleShape::kVan : VehicleShape::kTruck;
}

Pose placeOnRoad(const Road& road, const Terrain& terrain, double s_m, double lateral_m, bool oncoming) {
  const RoadPoint point = road.at(s_m);
  const Eigen::Vector2d p = point.position + lateral_m * point.left();
  const double turn = oncoming ? -1.0 : 1.0;
  const Eigen::Vector2d forward = turn * point.forward();
  const Eigen::Vector2d slope = terrain.gradient(p);
  Pose T = Pose::Identity();
  const Eigen::Vector3d z = Eigen::Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d(forward.x(), forward.y(), slope.dot(forward)).normalized();
  T.linear() << x, z.cross(x), z;
  T.translation() << p, terrain.height(p);
  return T;
}

/// The positions of the ring, nearest first: along the road and across it, in lanes.
struct RingPlace {
  double along_m;
  int lane;
};
RingPlace ringPlace(int i) {
  static constexpr RingPlace kNear[] = {{0, 1},     {0, -1}, {9, 0},   {-9, 0}, {7.5, 1}, {7.5, -1}, {-7.5, 1},
                                        {-7.5, -1}, {15, 1}, {15, -1}, {17, 0}, {-15, 1}, {-15, -1}, {-17, 0}};
  constexpr int kCount = static_cast<int>(sizeof(kNear) / sizeof(kNear[0]));
  if (i < kCount) return kNear[i];
  const int row = (i - kCount) / 6 + 1;
  const RingPlace column[] = {{1, 1}, {1, -1}, {1, 0}, {-1, 1}, {-1, -1}, {-1, 0}};
  const RingPlace& at = column[(i - kCount) % 6];
  return {at.along_m * (17.0 + 7.5 * row), at.lane};
}

}  // namespace

TrafficVehicle Traffic::place(const Road& road, const Terrain& terrain, VehicleShape shape, double s_begin_m,
                              double s_end_m, double lateral_m, bool oncoming) {
  return {shape, placeOnRoad(road, terrain, s_begin_m, lateral_m, oncoming),
          placeOnRoad(road, terrain, s_end_m, lateral_m, oncoming)};
}

void Traffic::refill(const Road& road, double s_m) {
  const auto spacing = [&](double per_km) { return 1000.0 / per_km * random_.uniform(0.4, 1.8); };
  const double appear_m = s_m + kAppear_m;
  const RoadCharacter& character = roadCharacter(road.kindAt(appear_m));
  const double speed = character.speed_mps;
  const bool wide = road.kindAt(appear_m) == SceneKind::kHighway;
  if (character.oncoming_per_km > 0.0 && appear_m >= next_oncoming_m_) {
    const double lateral = character.lane_offset_m + (wide && random_.chance(0.4) ? 3.6 : 0.0);
    oncoming_.push_back({appear_m, speed * random_.uniform(0.75, 1.0), lateral, randomShape(random_)});
    next_oncoming_m_ = appear_m + spacing(character.oncoming_per_km);
  }
  if (character.same_way_per_km > 0.0 && appear_m >= next_same_way_m_) {
    // the car overtakes slower ones on the right lane
    same_way_.push_back({appear_m, speed * random_.uniform(0.7, 0.8), -(character.lane_offset_m + 3.6),
                         random_.chance(0.6) ? VehicleShape::kTruck : randomShape(random_)});
    next_same_way_m_ = appear_m + 0.25 * spacing(character.same_way_per_km);
  }
}

std::vector<TrafficVehicle> Traffic::update(const Road& road, const Terrain& terrain, double t_s, double dt_s,
                                            double s_begin_m, double s_end_m, int around) {
  refill(road, s_begin_m);
  std::vector<TrafficVehicle> vehicles;
  const auto stream = [&](std::vector<Stream>& members, double way) {
    for (Stream& member : members) {
      const double before_m = member.s_m;
      member.s_m += way * member.speed_mps * dt_s;
      vehicles.push_back(place(road, terrain, member.shape, before_m, member.s_m, member.lateral_m, way < 0.0));
    }
    members.erase(std::remove_if(members.begin(), members.end(),
                                 [&](const Stream& member) {
                                   return member.s_m < s_begin_m - kVanish_m ||
                                          member.s_m > s_begin_m + kAppear_m + 30.0;
                                 }),
                  members.end());
  };
  stream(oncoming_, -1.0);
  stream(same_way_, 1.0);

  const double speed = (s_end_m - s_begin_m) / dt_s;
  const RoadCharacter& character = roadCharacter(road.kindAt(s_begin_m));
  if (character.car_ahead && around < 3) {
    const auto gap = [&](double t) {
      return kGap_m + kGap_s * character.speed_mps + kGapSwing_m * std::sin(2.0 * M_PI * t / kGapSwing_s);
    };
    vehicles.push_back(place(road, terrain, VehicleShape::kCar, s_begin_m + gap(t_s), s_end_m + gap(t_s + dt_s),
                             -road.laneOffset(s_begin_m + gap(t_s)), false));
  }
  for (int i = 0; i < around; ++i) {
    const RingPlace ring = ringPlace(i);
    const auto along = [&](double t) {
      const double stretch = 1.0 + 0.02 * std::min(speed, 20.0);
      return ring.along_m * stretch + 0.8 * std::sin(0.35 * t + 2.4 * i);
    };
    const VehicleShape shape = i % 5 == 4 ? VehicleShape::kTruck : i % 3 == 1 ? VehicleShape::kVan : VehicleShape::kCar;
    const bool fits = shape != VehicleShape::kTruck || std::abs(ring.along_m) > 12.0;
    vehicles.push_back(place(road, terrain, fits ? shape : VehicleShape::kVan, s_begin_m + along(t_s),
                             s_end_m + along(t_s + dt_s), -road.laneOffset(s_begin_m) + kRingLane_m * ring.lane,
                             false));
  }
  return vehicles;
}

}  // namespace fail_aware
