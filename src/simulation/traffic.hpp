// Other vehicles: oncoming ones, ones in the same direction, a car ahead that keeps its distance, and, as a fault, a
// ring of vehicles close around the car that move with it.
//
// They follow the road at a constant lateral position; none touches the car. Poses are those of the ground under them,
// x forward, world frame. Deterministic in the seed and in the sequence of updates. Cost: a few us an update.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/pose.hpp"
#include "simulation/random.hpp"
#include "simulation/road.hpp"
#include "simulation/scene_objects.hpp"
#include "simulation/terrain.hpp"

namespace fail_aware {

struct TrafficVehicle {
  VehicleShape shape = VehicleShape::kCar;
  Pose T_world_begin = Pose::Identity();  ///< at the start of the interval
  Pose T_world_end = Pose::Identity();    ///< at its end
};

class Traffic {
 public:
  explicit Traffic(std::uint64_t seed) : random_(combineKeys(seed, 41)) {}

  /// The vehicles' poses during [t, t + dt], in which the car moves from s_begin to s_end along the road.
  /// `around`: number of vehicles in the ring around the car, 0 for none.
  std::vector<TrafficVehicle> update(const Road& road, const Terrain& terrain, double t_s, double dt_s,
                                     double s_begin_m, double s_end_m, int around);

 private:
  struct Stream {
    double s_m = 0.0, speed_mps = 0.0, lateral_m = 0.0;
    VehicleShape shape = VehicleShape::kCar;
  };
  void refill(const Road& road, double s_m);
  static TrafficVehicle place(const Road& road, const Terrain& terrain, VehicleShape shape, double s_begin_m,
                              double s_end_m, double lateral_m, bool oncoming);

  RandomStream random_;
  std::vector<Stream> oncoming_, same_way_;
  double next_oncoming_m_ = 0.0, next_same_way_m_ = 0.0;
};

}  // namespace fail_aware
