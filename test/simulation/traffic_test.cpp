#include "simulation/traffic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace fail_aware::traffic_test {
namespace {

struct World {
  explicit World(const std::string& scene) : road(1, ScenePlan::parse(scene, 60.0)), terrain(1, 0.02) {}
  Road road;
  Terrain terrain;
};

TEST(Traffic, NobodyTouchesTheCarAndMotionIsSteady) {
  for (const char* scene : {"town", "highway", "tunnel", "country"}) {
    for (int around : {0, 14}) {
      World world(scene);
      Traffic traffic(2);
      std::size_t most = 0;
      for (int i = 0; i < 600; ++i) {
        const double s = 1.2 * i;
        world.road.extendTo(s + 400.0);
        const auto vehicles = traffic.update(world.road, world.terrain, 0.1 * i, 0.1, s, s + 1.2, around);
        most = std::max(most, vehicles.size());
        const RoadPoint road = world.road.at(s);
        for (const TrafficVehicle& vehicle : vehicles) {
          const Eigen::Vector2d to = vehicle.T_world_begin.translation().head<2>() - road.position;
          const double along = std::abs(to.dot(road.forward()));
          const double across = std::abs(to.dot(road.left()) + world.road.laneOffset(s));
          const double half_length = vehicle.shape == VehicleShape::kTruck ? 5.8 : 2.8;
          ASSERT_TRUE(along > half_length + 2.0 || across > 1.8) << scene << " " << along << " " << across;
          ASSERT_LT((vehicle.T_world_end.translation() - vehicle.T_world_begin.translation()).norm(), 4.0);
          ASSERT_NEAR(vehicle.T_world_begin.linear().determinant(), 1.0, 1e-9);
        }
      }
      EXPECT_GE(most, static_cast<std::size_t>(around + 1)) << scene;
    }
  }
}

TEST(Traffic, TheRingStaysWithTheCar) {
  World world("tunnel");
  world.road.extendTo(1500.0);
  Traffic traffic(2);
  for (int i = 0; i < 200; ++i) {
    const double s = 1.5 * i;
    int near = 0;
    for (const TrafficVehicle& v : traffic.update(world.road, world.terrain, 0.1 * i, 0.1, s, s + 1.5, 12)) {
      near += (v.T_world_begin.translation().head<2>() - world.road.at(s).position).norm() < 30.0;
    }
    EXPECT_GE(near, 12);
  }
}

}  // namespace
}  // namespace fail_aware::traffic_test
