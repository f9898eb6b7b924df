#include "core/estimation/vehicle/vehicle_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::vehicle_model_test {
namespace {

constexpr double kPeriod = 0.1;

// A drive over a road surface: speed and path curvature over time, height over the ground plan.
struct Drive {
  double duration_s = 10.0;
  std::function<double(double)> speed = [](double) { return 10.0; };
  std::function<double(double)> yaw_rate = [](double) { return 0.0; };
  std::function<double(double, double)> height = [](double, double) { return 0.0; };
  double start_yaw = 0.0;
};

// The body stands flat on the road; the rear axle rolls without slip, so that beta is that of the kinematic bicycle.
std::vector<Vector6d> driven(const Drive& drive) {
  const double rear_to_cog = VehicleParameters().cog_to_rear_axle_m;
  std::vector<Vector6d> states;
  double rear_x = 0.0, rear_y = 0.0, yaw = drive.start_yaw;
  const double dt = 1e-3;
  for (int i = 0; i * dt < drive.duration_s; ++i) {
    if (i % 100 == 0) {
      const double x = rear_x + rear_to_cog * std::cos(yaw), y = rear_y + rear_to_cog * std::sin(yaw);
      const double h = 1e-4;
      RoadPlane road;
      road.slope << (drive.height(x + h, y) - drive.height(x - h, y)) / (2 * h),
          (drive.height(x, y + h) - drive.height(x, y - h)) / (2 * h);
      Vector6d state;
      state << x, y, drive.height(x, y), road.rollPitch(yaw), wrapAngle(yaw);
      states.push_back(state);
    }
    const double middle = (i + 0.5) * dt;
    const double middle_yaw = yaw + 0.5 * dt * drive.yaw_rate(middle);
    rear_x += dt * drive.speed(middle) * std::cos(middle_yaw);
    rear_y += dt * drive.speed(middle) * std::sin(middle_yaw);
    yaw += dt * drive.yaw_rate(middle);
  }
  return states;
}

struct Errors {
  double rms_m = 0.0, max_m = 0.0, max_rad = 0.0, rms_rad = 0.0;
};

struct Comparison {
  Errors model, constant_velocity;
};

Comparison compared(const std::vector<Vector6d>& states, const VehicleModel::Params& params = VehicleModel::Params()) {
  const VehicleParameters vehicle;
  const VehicleModel model(vehicle, params);
  MotionHistory history{MotionHistory::Params()};
  RoadPlaneEstimator road{vehicle};
  Comparison out;
  int count = 0;
  const auto add = [&](Errors& errors, const Vector6d& predicted, const Vector6d& truth) {
    const Pose error = poseFromVector(truth).inverse() * poseFromVector(predicted);
    const double metres = error.translation().norm(), radians = logSo3(error.linear()).norm();
    errors.rms_m += metres * metres;
    errors.rms_rad += radians * radians;
    errors.max_m = std::max(errors.max_m, metres);
    errors.max_rad = std::max(errors.max_rad, radians);
  };
  for (std::size_t i = 0; i + 1 < states.size(); ++i) {
    const double stamp = kPeriod * static_cast<double>(i);
    history.push(stamp, poseFromVector(states[i]));
    const MotionDerivatives motion = history.derivatives();
    road.update(stamp, states[i], motion);
    if (i < 8) continue;
    ++count;
    add(out.model, model.predict(states[i], motion, kPeriod, road.plane()), states[i + 1]);
    const Pose last = poseFromVector(states[i]);
    const Pose again = last * (poseFromVector(states[i - 1]).inverse() * last);
    add(out.constant_velocity, vectorFromPose(again), states[i + 1]);
  }
  for (Errors* errors : {&out.model, &out.constant_velocity}) {
    errors->rms_m = std::sqrt(errors->rms_m / count);
    errors->rms_rad = std::sqrt(errors->rms_rad / count);
  }
  return out;
}

constexpr double kTenthDegree = 0.1 * kDegree;

// Rises smoothly from 0 to 1 over [begin, end].
double ramp(double t, double begin, double end) {
  const double s = std::min(1.0, std::max(0.0, (t - begin) / (end - begin)));
  return s * s * (3.0 - 2.0 * s);
}

TEST(VehicleModelMended, StraightAtConstantSpeedIsExact) {
  const Comparison result = compared(driven(Drive()));
  EXPECT_LT(result.model.max_m, 1e-6);
  EXPECT_LT(result.model.max_rad, 1e-9);
}

TEST(VehicleModelMended, ConstantAccelerationIsFollowed) {
  Drive drive;
  drive.speed = [](double t) { return 3.0 + 2.0 * t; };
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.max_m, 1e-4);
  EXPECT_NEAR(result.constant_velocity.max_m, 0.02, 1e-3);
}

TEST(VehicleModelMended, HillsAndDips) {
  Drive drive;
  drive.duration_s = 20.0;
  drive.speed = [](double) { return 15.0; };
  drive.height = [](double x, double) { return 3.0 * std::sin(2.0 * M_PI * x / 200.0); };  // slopes up to 9 %
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.max_m, 0.005);
  EXPECT_LT(result.model.max_rad, kTenthDegree);
}

TEST(VehicleModelMended, TurningOnAConstantSlope) {
  Drive drive;
  drive.speed = [](double) { return 5.0; };
  drive.yaw_rate = [](double) { return 1.0; };
  drive.height = [](double x, double y) { return 0.1 * x - 0.05 * y; };
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.max_m, 0.010);
  EXPECT_LT(result.model.max_rad, kTenthDegree);
}

TEST(VehicleModelMended, SteepBanking) {
  Drive drive;
  drive.duration_s = 15.0;
  drive.speed = [](double) { return 12.0; };
  drive.yaw_rate = [](double t) { return 0.25 * ramp(t, 2.0, 5.0); };
  drive.height = [](double x, double y) { return 0.06 * y + 0.02 * x; };
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.max_m, 0.010);
  EXPECT_LT(result.model.max_rad, kTenthDegree);
}

TEST(VehicleModelMended, HardBrakingToAStopAndStandingThere) {
  // 6 m/s^2, reached and left within 1.5 s, downhill; then standstill
  Drive drive;
  drive.duration_s = 10.0;
  const auto deceleration = [](double t) { return 6.0 * (ramp(t, 2.0, 3.5) - ramp(t, 4.0, 5.5)); };
  const auto speed = [deceleration](double t) {
    double v = 12.0;
    for (double at = 0.0; at < t; at += 1e-2) v -= 1e-2 * deceleration(at);
    return std::max(0.0, v);
  };
  drive.speed = speed;
  drive.height = [](double x, double) { return -0.08 * x; };
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.rms_m, 0.010);
  EXPECT_LT(result.model.rms_m, 0.4 * result.constant_velocity.rms_m);
  EXPECT_LT(result.model.max_m, result.constant_velocity.max_m);
  EXPECT_LT(result.model.max_rad, 1.5 * kTenthDegree);
  EXPECT_LT(result.model.rms_rad, 0.5 * kTenthDegree);
}

TEST(VehicleModelMended, TurnsIntoAndOutOfABend) {
  Drive drive;
  drive.speed = [](double) { return 6.0; };
  drive.yaw_rate = [](double t) { return ramp(t, 2.0, 4.0) - 2.0 * ramp(t, 5.0, 8.0); };
  drive.start_yaw = 3.0;
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.rms_m, 0.010);
  EXPECT_LT(result.model.rms_m, result.constant_velocity.rms_m);
  EXPECT_LT(result.model.rms_rad, 0.5 * result.constant_velocity.rms_rad);
  EXPECT_LT(result.model.max_rad, 2.0 * kTenthDegree);
}

TEST(VehicleModelMended, ReversingAroundACorner) {
  Drive drive;
  drive.speed = [](double t) { return 2.0 - 5.0 * ramp(t, 2.0, 6.0); };
  drive.yaw_rate = [](double t) { return -0.4 * ramp(t, 6.0, 8.0); };
  const Comparison result = compared(driven(drive));
  EXPECT_LT(result.model.max_m, 0.010);
  EXPECT_LT(result.model.rms_m, result.constant_velocity.rms_m);
  EXPECT_LT(result.model.max_rad, kTenthDegree);
}

TEST(VehicleModelMended, ABodyThatIsNoBicycleIsBentByLittle) {
  // the centre of gravity itself moves along its heading in a tight circle: beta = 0
  std::vector<Vector6d> states;
  for (int i = 0; i < 60; ++i) {
    const double yaw = 0.1 * i;
    Vector6d state;
    state << 5.0 * std::sin(yaw), -5.0 * std::cos(yaw), 0.0, 0.0, 0.0, wrapAngle(yaw);
    states.push_back(state);
  }
  EXPECT_LT(compared(states).model.max_m, 0.010);
}

TEST(VehicleModelMended, SuspensionSwingsAboutTheRoad) {
  // true pitch: the suspension's exact answer to braking, on a 6 % climb
  const SuspensionAxis axis = pitchAxis(VehicleParameters());
  std::vector<Vector6d> states;
  SuspensionState pitch;
  double x = 0.0, v = 20.0;
  const double road_pitch = -std::atan(0.06);
  for (int i = 0; i < 100; ++i) {
    Vector6d state;
    state << x, 0.0, 0.06 * x, 0.0, road_pitch + pitch.angle_rad, 0.0;
    states.push_back(state);
    const double a = i >= 30 && i < 55 ? -4.0 : 0.0;
    for (int k = 0; k < 100; ++k) {
      pitch = stepSuspensionExact(axis, pitch, -a, 1e-3);
      x += v * 1e-3 / std::hypot(1.0, 0.06);
      v += a * 1e-3;
    }
  }
  VehicleModel::Params rates, full;
  rates.suspension_gain = 0.0;
  full.suspension_gain = 1.0;
  const double with_default = compared(states).model.rms_rad;
  EXPECT_LT(with_default, compared(states, rates).model.rms_rad);
  EXPECT_LT(compared(states, full).model.rms_rad, compared(states, rates).model.rms_rad);
}

TEST(VehicleModelMended, BrakingEndsAtStandstill) {
  const VehicleModel model{VehicleParameters(), VehicleModel::Params()};
  MotionDerivatives motion;
  motion.valid = true;
  for (const double direction : {1.0, -1.0}) {
    motion.velocity_body_mps.x() = direction * 0.3;
    motion.acceleration_body_mps2.x() = direction * -6.0;
    const Vector6d after = model.predict(Vector6d::Zero(), motion, 0.2, RoadPlane());
    EXPECT_NEAR(after[0], direction * 0.3 * 0.3 / 12.0, 1e-12);
  }
}

TEST(VehicleModelMended, EveryModeStandsStillWithoutMotion) {
  Vector6d state;
  state << 1.0, 2.0, 0.543, 0.0, 0.0, -2.0;
  MotionDerivatives motion;
  for (const bool valid : {false, true}) {
    motion.valid = valid;
    for (const bool literal : {false, true}) {
      for (const bool six_dof : {false, true}) {
        VehicleModel::Params params;
        params.literal = literal;
        params.six_dof = six_dof;
        const VehicleModel model(VehicleParameters(), params);
        EXPECT_LT((model.predict(state, motion, kPeriod, RoadPlane()) - state).norm(), 1e-12);
      }
    }
  }
}

TEST(VehicleModelMended, YawWrapsAndAbsurdInputStaysFinite) {
  const VehicleModel model{VehicleParameters(), VehicleModel::Params()};
  MotionDerivatives motion;
  motion.valid = true;
  motion.velocity_body_mps << 1e-12, 5.0, -3.0;
  motion.acceleration_body_mps2 << 12.0, -12.0, 12.0;
  motion.rpy_rates_rad_s << 5.0, -5.0, 40.0;
  motion.rpy_accelerations_rad_s2.setConstant(10.0);
  RoadPlane road;
  road.valid = true;
  road.slope << 1.0, -1.0;
  Vector6d state = Vector6d::Zero();
  state[5] = 3.1;
  for (const double dt : {1e-6, 0.1, 5.0}) {
    const Vector6d after = model.predict(state, motion, dt, road);
    EXPECT_TRUE(after.allFinite());
    for (int i = 3; i < 6; ++i) EXPECT_LE(std::abs(after[i]), M_PI);
  }
  EXPECT_EQ(model.predict(state, motion, 0.0, road), state);
}

TEST(VehicleModelLiteral, IsTheArticlesEquations) {
  VehicleModel::Params params;
  params.literal = true;
  const VehicleParameters vehicle;
  const VehicleModel model(vehicle, params);
  MotionDerivatives motion;
  motion.valid = true;
  motion.velocity_body_mps << 10.0, 0.2, 0.0;
  motion.acceleration_body_mps2 << 1.0, 0.5, 0.0;
  motion.rpy_rates_rad_s << 0.02, -0.03, 0.2;
  motion.rpy_accelerations_rad_s2 << 0.0, 0.0, 0.1;
  Vector6d state;
  state << 5.0, 6.0, 7.0, 0.01, 0.02, 0.5;
  const Vector6d after = model.predict(state, motion, kPeriod, RoadPlane());

  const double V = std::hypot(10.0, 0.2);
  const double F = 1750.0 * (0.5 + 0.2 * 10.0), M = 2875.0 * 0.1;
  const double F_f = (1.6 * F + M) / 2.67, F_r = (1.07 * F - M) / 2.67;
  const double beta = 1.6 * 0.2 / 10.0 - F_r / 243000.0;
  const double delta = F_f / 230000.0 + beta + 1.07 * 0.2 / 10.0;
  EXPECT_NEAR(after[0], 5.0 + V * std::cos(0.5 + beta) * 0.1, 1e-12);
  EXPECT_NEAR(after[1], 6.0 + V * std::sin(0.5 + beta) * 0.1, 1e-12);
  EXPECT_NEAR(after[5], 0.5 + V * std::cos(beta) / 2.67 * std::tan(delta) * 0.1, 1e-12);

  const SuspensionAxis roll = rollAxis(vehicle), pitch = pitchAxis(vehicle);
  const double roll_acceleration = roll.gain_per_m * 0.5 - roll.stiffness_per_s2 * 0.01 - roll.damping_per_s * 0.02;
  const double pitch_acceleration = pitch.gain_per_m * 1.0 - pitch.stiffness_per_s2 * 0.02 + pitch.damping_per_s * 0.03;
  EXPECT_NEAR(after[3], 0.01 + 0.002 + 0.005 * roll_acceleration, 1e-12);
  EXPECT_NEAR(after[4], 0.02 - 0.003 + 0.005 * pitch_acceleration, 1e-12);
  EXPECT_NEAR(after[2], 0.543 + 0.25 * (std::cos(after[4]) - 1.0) + 0.1 * (std::cos(after[3]) - 1.0), 1e-12);
}

TEST(VehicleModelLiteral, ReversesByTheSignOfV) {
  VehicleModel::Params params;
  params.literal = true;
  const VehicleModel model(VehicleParameters(), params);
  MotionDerivatives motion;
  motion.valid = true;
  motion.velocity_body_mps.x() = -0.8;
  motion.rpy_rates_rad_s.z() = 0.1;
  const Vector6d after = model.predict(Vector6d::Zero(), motion, kPeriod, RoadPlane());
  EXPECT_LT(after[0], -0.07);
  EXPECT_GT(after[5], 0.0);
}

TEST(VehicleModelThreeDof, HeightRollAndPitchStay) {
  for (const bool literal : {false, true}) {
    VehicleModel::Params params;
    params.six_dof = false;
    params.literal = literal;
    const VehicleModel model(VehicleParameters(), params);
    MotionDerivatives motion;
    motion.valid = true;
    motion.velocity_body_mps << 10.0, 0.0, 1.0;
    motion.acceleration_body_mps2 << 2.0, 1.0, 1.0;
    motion.rpy_rates_rad_s << 0.1, 0.2, 0.3;
    Vector6d state;
    state << 1.0, 2.0, 3.0, 0.04, -0.05, 1.0;
    const Vector6d after = model.predict(state, motion, kPeriod, RoadPlane());
    EXPECT_EQ(after.segment<3>(2), state.segment<3>(2));
    EXPECT_NEAR((after - state).head<2>().norm(), 1.0, 0.03);
    EXPECT_NEAR(after[5], 1.03, 0.01);
    const Matrix6d Q = model.processNoise(kPeriod, 0.0);
    EXPECT_EQ(Q.diagonal().segment<3>(2).norm(), 0.0);
    EXPECT_GT(Q(0, 0), 0.0);
  }
}

TEST(VehicleModelNoise, ScalesWithTimeAndTurnsWithBody) {
  VehicleModel::Params params;
  const VehicleModel body(VehicleParameters(), params);
  params.noise_in_body_axes = false;
  const VehicleModel odom(VehicleParameters(), params);
  const Vector6d sigma = (Vector6d() << 0.0485, 0.0435, 0.121, 0.1456, 0.1456, 0.0044).finished();
  const Matrix6d article = sigma.cwiseAbs2().asDiagonal();
  EXPECT_LT((odom.processNoise(0.1, 1.0) - article).norm(), 1e-15);
  EXPECT_LT((odom.processNoise(0.25, 1.0) - 2.5 * article).norm(), 1e-15);
  EXPECT_LT((body.processNoise(0.1, 0.0) - article).norm(), 1e-15);
  const Matrix6d quarter = body.processNoise(0.1, M_PI / 2.0);
  EXPECT_NEAR(quarter(0, 0), article(1, 1), 1e-15);
  EXPECT_NEAR(quarter(1, 1), article(0, 0), 1e-15);
  EXPECT_EQ(odom.processNoise(0.0, 1.0).norm(), 0.0);
}

TEST(VehicleModelParams, AreValidated) {
  const auto rejected = [](const std::function<void(VehicleModel::Params&)>& change) {
    VehicleModel::Params params;
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(VehicleModel::Params()));
  rejected([](VehicleModel::Params& p) { p.sigma_yaw_rad = 0.0; });
  rejected([](VehicleModel::Params& p) { p.sigma_x_m = std::numeric_limits<double>::quiet_NaN(); });
}

}  // namespace
}  // namespace fail_aware::vehicle_model_test
