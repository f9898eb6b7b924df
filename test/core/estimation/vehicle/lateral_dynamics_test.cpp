#include "core/estimation/vehicle/lateral_dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::lateral_dynamics_test {
namespace {

// The dynamic single-track model that the equations come from, driven forwards by a known wheel angle.
struct Bicycle {
  VehicleParameters vehicle;
  double v_x = 10.0, v_y = 0.0, yaw_rate = 0.0;

  // Derivatives of (v_y, yaw_rate); tyre forces oppose each axle's sideways velocity.
  LateralMotion motion(double delta) const {
    const double l_f = vehicle.cog_to_front_axle_m, l_r = vehicle.cog_to_rear_axle_m;
    const double sideways_front = v_y + l_f * yaw_rate - delta * v_x;
    const double sideways_rear = v_y - l_r * yaw_rate;
    const double front = -vehicle.cornering_stiffness_front_n_per_rad * sideways_front / std::abs(v_x);
    const double rear = -vehicle.cornering_stiffness_rear_n_per_rad * sideways_rear / std::abs(v_x);
    return {v_x, (front + rear) / vehicle.mass_kg - yaw_rate * v_x, yaw_rate,
            (l_f * front - l_r * rear) / vehicle.inertia_z_kg_m2};
  }

  void step(double delta, double dt) {
    const LateralMotion rates = motion(delta);
    Bicycle middle = *this;
    middle.v_y += 0.5 * dt * rates.acceleration_y_mps2;
    middle.yaw_rate += 0.5 * dt * rates.yaw_acceleration_rad_s2;
    const LateralMotion middle_rates = middle.motion(delta);
    v_y += dt * middle_rates.acceleration_y_mps2;
    yaw_rate += dt * middle_rates.yaw_acceleration_rad_s2;
  }
};

TEST(LateralDynamics, RecoversBetaAndDeltaOfASimulatedBicycle) {
  for (const double v_x : {4.0, 12.0, 30.0}) {
    Bicycle bicycle;
    bicycle.v_x = v_x;
    double largest_beta = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double delta = 0.05 * std::sin(2.0 * M_PI * 0.5 * i * 1e-3);
      const LateralState state = solveLateralDynamics(bicycle.vehicle, bicycle.motion(delta));
      ASSERT_NEAR(state.beta_rad, bicycle.v_y / bicycle.v_x, 1e-12);
      ASSERT_NEAR(state.delta_rad, delta, 1e-12);
      largest_beta = std::max(largest_beta, std::abs(state.beta_rad));
      bicycle.step(delta, 1e-3);
    }
    EXPECT_GT(largest_beta, 0.005);
  }
}

TEST(LateralDynamics, RecoversThemInReverse) {
  Bicycle bicycle;
  bicycle.v_x = -3.0;
  bicycle.v_y = 0.2;
  bicycle.yaw_rate = -0.3;
  const LateralState state = solveLateralDynamics(bicycle.vehicle, bicycle.motion(0.2));
  EXPECT_NEAR(state.beta_rad, 0.2 / -3.0, 1e-12);
  EXPECT_NEAR(state.delta_rad, 0.2, 1e-12);
}

TEST(LateralDynamics, BelowTheMinimumSpeedItIsKinematic) {
  const VehicleParameters vehicle;
  for (const double v_x : {0.5, -0.5}) {
    const LateralState state = solveLateralDynamics(vehicle, {v_x, 0.3, 0.1, 0.5});
    EXPECT_NEAR(std::tan(state.beta_rad), 1.6 * 0.1 / v_x, 1e-12);
    EXPECT_NEAR(std::tan(state.delta_rad), 2.67 * 0.1 / v_x, 1e-12);
  }
}

TEST(LateralDynamics, ContinuousOverTheWholeRangeOfSpeeds) {
  const VehicleParameters vehicle;
  LateralState before = solveLateralDynamics(vehicle, {-3.0, 0.5, 0.2, 0.3});
  for (double v_x = -3.0; v_x <= 3.0; v_x += 1e-5) {
    const LateralState state = solveLateralDynamics(vehicle, {v_x, 0.5, 0.2, 0.3});
    ASSERT_LT(std::abs(state.beta_rad - before.beta_rad), 0.003) << v_x;
    ASSERT_LT(std::abs(state.delta_rad - before.delta_rad), 0.003) << v_x;
    before = state;
  }
}

TEST(LateralDynamics, StandstillAndNoiseStayWithinTheSteeringLimit) {
  const VehicleParameters vehicle;
  EXPECT_EQ(solveLateralDynamics(vehicle, {0.0, 0.0, 1.0, 0.0}).beta_rad, 0.0);
  for (const double v_x : {-0.2, -0.01, 1e-9, 0.01, 0.2}) {
    const LateralState state = solveLateralDynamics(vehicle, {v_x, 2.0, 3.0, 5.0});
    EXPECT_LE(std::abs(state.delta_rad), kMaxSteeringAngle_rad + 1e-12);
    EXPECT_LE(std::abs(state.beta_rad), kMaxSteeringAngle_rad);
  }
}

}  // namespace
}  // namespace fail_aware::lateral_dynamics_test
