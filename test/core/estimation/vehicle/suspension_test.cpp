#include "core/estimation/vehicle/suspension.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::suspension_test {
namespace {

// Runge-Kutta of fourth order in small steps: knows nothing of the closed form.
SuspensionState integrated(const SuspensionAxis& axis, SuspensionState s, double acceleration, double dt) {
  const int steps = 4000;
  const double h = dt / steps;
  const auto slope = [&](const SuspensionState& at) {
    return SuspensionState{at.rate_rad_s, axis.gain_per_m * acceleration - axis.stiffness_per_s2 * at.angle_rad -
                                              axis.damping_per_s * at.rate_rad_s};
  };
  const auto moved = [](const SuspensionState& at, const SuspensionState& k, double step) {
    return SuspensionState{at.angle_rad + step * k.angle_rad, at.rate_rad_s + step * k.rate_rad_s};
  };
  for (int i = 0; i < steps; ++i) {
    const SuspensionState k1 = slope(s), k2 = slope(moved(s, k1, h / 2)), k3 = slope(moved(s, k2, h / 2)),
                          k4 = slope(moved(s, k3, h));
    s.angle_rad += h / 6 * (k1.angle_rad + 2 * k2.angle_rad + 2 * k3.angle_rad + k4.angle_rad);
    s.rate_rad_s += h / 6 * (k1.rate_rad_s + 2 * k2.rate_rad_s + 2 * k3.rate_rad_s + k4.rate_rad_s);
  }
  return s;
}

TEST(Suspension, AxesOfTheArticlesPassat) {
  const VehicleParameters passat;
  const SuspensionAxis pitch = pitchAxis(passat);
  const double pitch_inertia = 2398.0 + 1750.0 * 0.0625;
  EXPECT_NEAR(pitch.gain_per_m, 437.5 / pitch_inertia, 1e-12);
  EXPECT_NEAR(pitch.stiffness_per_s2, (54623.46 + 4291.875) / pitch_inertia, 1e-5);
  EXPECT_NEAR(pitch.damping_per_s, 7056.025 / pitch_inertia, 1e-9);
  const SuspensionAxis roll = rollAxis(passat);
  EXPECT_NEAR(roll.gain_per_m, 175.0 / 557.5, 1e-12);
  EXPECT_NEAR(roll.stiffness_per_s2, (67162.5 + 1716.75) / 557.5, 1e-9);
  EXPECT_NEAR(roll.damping_per_s, 18000.0 / 557.5, 1e-9);
}

TEST(Suspension, LiteralStepIsTheArticlesFormula) {
  const SuspensionAxis axis{3.0, 20.0, 0.2};
  const SuspensionState after = stepSuspensionLiteral(axis, {0.05, -0.1}, 2.0, 0.1);
  const double angular = -(-0.2 * 2.0 + 20.0 * 0.05 + 3.0 * -0.1);
  EXPECT_DOUBLE_EQ(after.angle_rad, 0.05 - 0.01 + 0.5 * angular * 0.01);
}

TEST(Suspension, ExactStepMatchesFineIntegrationForEveryDamping) {
  const double stiffness = 25.0, critical = 10.0;
  for (const double damping : {0.0, 1.0, 0.5 * critical, critical * (1 - 1e-9), critical, critical * (1 + 1e-9),
                               critical * (1 + 1e-4), 2.0 * critical, 8.0 * critical}) {
    const SuspensionAxis axis{damping, stiffness, 0.3};
    for (const double dt : {0.01, 0.1, 0.5, 2.0}) {
      const SuspensionState exact = stepSuspensionExact(axis, {0.03, -0.2}, -4.0, dt);
      const SuspensionState fine = integrated(axis, {0.03, -0.2}, -4.0, dt);
      EXPECT_NEAR(exact.angle_rad, fine.angle_rad, 1e-9) << damping << " " << dt;
      EXPECT_NEAR(exact.rate_rad_s, fine.rate_rad_s, 1e-8) << damping << " " << dt;
    }
  }
}

TEST(Suspension, UndampedSwingIsACosine) {
  const SuspensionState after = stepSuspensionExact({0.0, 16.0, 0.0}, {0.1, 0.0}, 0.0, 0.3);
  EXPECT_NEAR(after.angle_rad, 0.1 * std::cos(1.2), 1e-15);
  EXPECT_NEAR(after.rate_rad_s, -0.4 * std::sin(1.2), 1e-15);
}

TEST(Suspension, TwoHalfStepsAreOneStep) {
  const SuspensionAxis axis = rollAxis(VehicleParameters());
  const SuspensionState once = stepSuspensionExact(axis, {0.02, 0.3}, 3.0, 0.1);
  const SuspensionState twice = stepSuspensionExact(axis, stepSuspensionExact(axis, {0.02, 0.3}, 3.0, 0.05), 3.0, 0.05);
  EXPECT_NEAR(once.angle_rad, twice.angle_rad, 1e-15);
  EXPECT_NEAR(once.rate_rad_s, twice.rate_rad_s, 1e-14);
}

TEST(Suspension, SettlesAtTheRestingAngleHoweverStiffOrLong) {
  for (const double damping : {3.0, 1e3, 1e7}) {
    const SuspensionAxis axis{damping, 30.0 * damping, 0.2};
    const SuspensionState after = stepSuspensionExact(axis, {0.5, -1.0}, 6.0, 1e4);
    EXPECT_NEAR(after.angle_rad, restingAngle(axis, 6.0), 1e-9);
    EXPECT_NEAR(after.rate_rad_s, 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace fail_aware::suspension_test
