#include "simulation/vehicle_drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace fail_aware::vehicle_drive_test {
namespace {

/// Drives, keeping the road ahead; calls look(vehicle, road, terrain) each step.
template <class Look>
void drive(const std::string& scene, std::uint64_t seed, double duration_s, const VehicleDrive::Params& params,
           Look&& look) {
  const ScenePlan plan = ScenePlan::parse(scene, duration_s);
  Road road(seed, plan);
  const Terrain terrain(seed, plan.grade());
  road.extendTo(400.0);
  VehicleDrive vehicle(seed, params, road, terrain);
  const int steps = static_cast<int>(duration_s / VehicleDrive::kStep_s);
  for (int i = 0; i < steps; ++i) {
    if (i % 1000 == 0) {
      road.extendTo(vehicle.state().s_m + 400.0);
      road.forgetBefore(vehicle.state().s_m - 190.0);
    }
    vehicle.step(road, terrain);
    look(vehicle, road, terrain);
  }
}

/// Of the body against the ground below it: nose down, left side up.
double bodyPitch(const VehicleDrive::State& state, const Terrain& terrain) {
  return state.pitch_rad +
         terrain.gradient(state.position).dot(Eigen::Vector2d(std::cos(state.yaw_rad), std::sin(state.yaw_rad)));
}
double bodyRoll(const VehicleDrive::State& state, const Terrain& terrain) {
  return state.roll_rad -
         terrain.gradient(state.position).dot(Eigen::Vector2d(-std::sin(state.yaw_rad), std::cos(state.yaw_rad)));
}

TEST(VehicleDrive, StaysPhysicalOnItsLane) {
  for (const char* scene : {"town", "country", "highway", "tunnel", "open"}) {
    double off_lane = 0.0, lateral = 0.0, forward = 0.0, pitch = 0.0, roll = 0.0, height = 0.0, s_m = 0.0;
    const auto keep = [](double& most, double value) { most = std::max(most, std::abs(value)); };
    drive(scene, 1, 70.0, {}, [&](const VehicleDrive& vehicle, const Road& road, const Terrain& terrain) {
      const VehicleDrive::State& state = vehicle.state();
      ASSERT_TRUE(isFinite(vehicle.T_world_base()));
      const RoadPoint point = road.at(state.s_m);
      keep(off_lane, (state.position - point.position).dot(point.left()) + road.laneOffset(state.s_m));
      keep(lateral, state.left_mps2);
      keep(forward, state.forward_mps2);
      keep(pitch, bodyPitch(state, terrain));
      keep(roll, bodyRoll(state, terrain));
      keep(height, state.height_m - 0.543 - terrain.height(state.position));
      ASSERT_GE(state.forward_mps, 0.0);
      ASSERT_GE(state.wheel_loads_n.minCoeff(), 0.0);
      s_m = state.s_m;
    });
    EXPECT_LT(off_lane, 1.0) << scene;
    EXPECT_LT(lateral, 5.0) << scene;
    EXPECT_LT(forward, 5.5) << scene;
    EXPECT_LT(pitch, 0.05) << scene;
    EXPECT_LT(roll, 0.05) << scene;
    EXPECT_LT(height, 0.15) << scene;
    EXPECT_GT(s_m, 250.0) << scene << ": it does not get on";
  }
}

TEST(VehicleDrive, PoseIsContinuous) {
  Pose last = Pose::Identity();
  bool has_last = false;
  drive("town", 3, 40.0, {}, [&](const VehicleDrive& vehicle, const Road&, const Terrain&) {
    const Pose T = vehicle.T_world_base();
    if (has_last) {
      const Vector6d rate = logSe3(last.inverse() * T) / VehicleDrive::kStep_s;
      ASSERT_LT(rate.head<3>().norm(), 16.0);
      ASSERT_LT(rate.tail<3>().norm(), 1.5);
    }
    last = T;
    has_last = true;
  });
}

TEST(VehicleDrive, StopsInTownAndGoesOn) {
  int stops = 0;
  double after_stop_mps = 0.0;
  bool standing = false;
  VehicleDrive::Params params;
  params.start_speed_mps = 8.0;
  drive("town", 1, 120.0, params, [&](const VehicleDrive& vehicle, const Road&, const Terrain&) {
    const bool stands = vehicle.state().forward_mps < 0.01;
    if (stands && !standing) ++stops;
    if (stops > 0) after_stop_mps = std::max(after_stop_mps, vehicle.state().forward_mps);
    standing = stands;
  });
  EXPECT_GE(stops, 1);
  EXPECT_GT(after_stop_mps, 5.0);
}

TEST(VehicleDrive, BrakesDiveAndBendsLeanAsTheSpringsAllow) {
  const VehicleParameters car;
  const double pitch_stiffness = 2.0 * (car.spring_front_n_per_m * std::pow(car.cog_to_front_axle_m, 2) +
                                        car.spring_rear_n_per_m * std::pow(car.cog_to_rear_axle_m, 2));
  const double roll_stiffness =
      0.5 * (car.spring_front_n_per_m + car.spring_rear_n_per_m) * std::pow(car.track_front_m, 2);
  const double pitch_per_mps2 = car.mass_kg * car.cog_above_pitch_axis_m / pitch_stiffness;
  const double roll_per_mps2 = car.mass_kg * car.cog_above_roll_axis_m / roll_stiffness;
  double pitch = 0.0, braking = 0.0, roll = 0.0, lateral = 0.0;
  drive("town", 2, 120.0, {}, [&](const VehicleDrive& vehicle, const Road&, const Terrain& terrain) {
    const VehicleDrive::State& state = vehicle.state();
    pitch -= bodyPitch(state, terrain) * state.forward_mps2;
    braking += state.forward_mps2 * state.forward_mps2;
    roll += bodyRoll(state, terrain) * state.left_mps2;
    lateral += state.left_mps2 * state.left_mps2;
  });
  EXPECT_NEAR(pitch / braking, pitch_per_mps2, 0.35 * pitch_per_mps2);
  EXPECT_NEAR(roll / lateral, roll_per_mps2, 0.35 * roll_per_mps2);
}

TEST(VehicleDrive, WheelsCarryTheCar) {
  double load_n = 0.0;
  int steps = 0;
  drive("highway", 4, 30.0, {}, [&](const VehicleDrive& vehicle, const Road&, const Terrain&) {
    load_n += vehicle.state().wheel_loads_n.sum();
    ++steps;
  });
  const double weight_n = 1750.0 * 9.81;
  EXPECT_NEAR(load_n / steps, weight_n, 0.02 * weight_n);
}

}  // namespace
}  // namespace fail_aware::vehicle_drive_test
