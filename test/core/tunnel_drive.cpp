// Whole drives where the lidar does not see its own motion: a smooth tunnel behind a car that keeps its distance.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../support/independent_drift.hpp"
#include "../support/synthetic_tunnel.hpp"
#include "core/estimation/increment_covariance.hpp"
#include "core/estimation/odometry_covariance.hpp"
#include "core/odometry_pipeline.hpp"

namespace fail_aware::tunnel_drive {
namespace {

using synthetic::Tunnel;

constexpr double kPeriod_s = 0.1;

PipelineParameters tunnelParameters() {
  PipelineParameters params;
  params.sensor.timing.stamp_reference = "mid";
  params.sensor.lidar_in_base = {-0.595, 0.0, 1.73, 0.0, 0.0, 0.0};  // synthetic::Lidar's
  params.vehicle.cog_in_base = {0.265, 0.0, 0.543};
  params.profile.registration.initialization.max_speed_mps = 20.0;  // a smaller search is a quicker test
  params.profile.registration.initialization.max_yaw_rate_rps = 0.1;
  return params;
}

struct Sample {
  SweepResult result;
  double driven_m, estimated_m;
  double sigma_m;  ///< of the accumulated odometry, along the drive
};

std::vector<Sample> drive(const Tunnel& tunnel, double start_x_m, double speed_mps, int sweeps) {
  OdometryPipeline pipeline(tunnelParameters(), 1);
  pipeline.startRedundant();
  OdometryCovariance accumulated(independentDrift());
  Pose T_odom_cog_previous = Pose::Identity();
  std::vector<Sample> samples;
  for (int i = 0; i < sweeps; ++i) {
    Sweep sweep = tunnel.scan(start_x_m, speed_mps, i * kPeriod_s, static_cast<std::uint32_t>(i));
    const SweepResult result = pipeline.step(sweep);
    if (i > 0) {
      accumulated.propagate(T_odom_cog_previous, result.state.T_odom_cog, incrementOf(result.state));
    }
    T_odom_cog_previous = result.state.T_odom_cog;
    samples.push_back({result, speed_mps * i * kPeriod_s, result.T_odom_base.translation().x(),
                       std::sqrt(accumulated.covariance()(0, 0))});
  }
  return samples;
}

double speedOf(const Sample& sample) { return sample.result.state.T_previous_now.translation().x() / kPeriod_s; }

TEST(Tunnel, EnteredAtAKnownSpeedItIsCoastedThrough) {
  const Tunnel tunnel;  // an even road: nothing tells the speed inside
  const int sweeps = 110;
  const std::vector<Sample> samples = drive(tunnel, -40.0, 12.0, sweeps);
  for (std::size_t i = 12; i < samples.size(); ++i) {
    ASSERT_NEAR(samples[i].estimated_m - samples[i - 10].estimated_m, 12.0, 0.5) << i << ": in a second";
  }
  const Sample& last = samples.back();
  const double error_m = std::abs(last.estimated_m - last.driven_m);
  EXPECT_LT(error_m, 0.05 * last.driven_m);
  EXPECT_LT(error_m, 2.0 * last.sigma_m);
  EXPECT_GT(last.sigma_m, 1.0) << "it says that it does not know the place along the tunnel";
  EXPECT_LT(std::sqrt(last.result.state.fusion.R(1, 1)), 0.1) << "but across";
  EXPECT_GT(last.result.of(kIcpPointToPlane).measurement.degenerate_directions, 0);
  EXPECT_GT(last.result.of(kIcpPointToPoint).measurement.degenerate_directions, 0);
  EXPECT_LT(last.result.T_odom_base.translation().tail<2>().norm(), 0.5);
}

TEST(Tunnel, TheUncertaintyAlongItGrowsFasterThanARandomWalk) {
  const std::vector<Sample> samples = drive(Tunnel(), -40.0, 12.0, 120);
  // inside, with nothing but wall in reach, from sweep 80 on
  const double first = samples[80].sigma_m, second = samples[100].sigma_m, third = samples[119].sigma_m;
  EXPECT_GT(third - second, 1.1 * (second - first));
}

TEST(Tunnel, BegunInsideAnUnknownSpeedIsNoConfidentStandstill) {
  const std::vector<Sample> samples = drive(Tunnel(), 120.0, 12.0, 30);
  int without_measurement = 0;
  for (std::size_t i = 3; i < samples.size(); ++i) {
    const Sample& s = samples[i];
    ASSERT_LT(std::abs(s.estimated_m - s.driven_m), 2.0 * s.sigma_m) << i;
    ASSERT_EQ(s.result.monitor.state, FailAwareState::kUnknown) << i << ": t1 waits for a motion that is observed";
    ASSERT_NE(s.result.monitor.reasons & static_cast<std::uint32_t>(kReasonMotionUnknown), 0u) << i;
    if (!s.result.state.measurement_applied) {  // the map begins anew
      EXPECT_LT(++without_measurement, 4);
      continue;
    }
    ASSERT_NE(s.result.monitor.reasons & static_cast<std::uint32_t>(kReasonWeakDirection), 0u) << i;
  }
}

TEST(Tunnel, BegunInsideTheReliefOfTheRoadTellsTheSpeed) {
  Tunnel tunnel;
  tunnel.profile_m = 0.006;
  const std::vector<Sample> samples = drive(tunnel, 120.0, 12.0, 50);
  for (std::size_t i = 20; i < samples.size(); ++i) ASSERT_NEAR(speedOf(samples[i]), 12.0, 0.8) << i;
  const double driven_m = samples.back().driven_m - samples[20].driven_m;
  EXPECT_NEAR(samples.back().estimated_m - samples[20].estimated_m, driven_m, 0.04 * driven_m);
}

TEST(Tunnel, AfterAResetTheSameSweepsGiveTheSameBits) {
  Tunnel tunnel;
  tunnel.profile_m = 0.02;  // the odometry takes the speed from the road
  OdometryPipeline fresh(tunnelParameters(), 1), reset(tunnelParameters(), 1);
  for (int i = 0; i < 3; ++i) {
    Sweep sweep = tunnel.scan(20.0, 12.0, i * kPeriod_s, static_cast<std::uint32_t>(i));
    reset.step(sweep);
  }
  reset.reset();
  for (int i = 0; i < 25; ++i) {
    Sweep one = tunnel.scan(20.0, 12.0, i * kPeriod_s, static_cast<std::uint32_t>(i)), other = one;
    ASSERT_EQ(fresh.step(one).T_odom_base.matrix(), reset.step(other).T_odom_base.matrix()) << i;
  }
}

}  // namespace
}  // namespace fail_aware::tunnel_drive
