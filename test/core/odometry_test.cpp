// The public class gives what the pipeline gives, to the last bit.
#include "fail_aware_lidar_odometry/odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "../support/synthetic_street.hpp"
#include "core/io/profile_files.hpp"
#include "core/odometry_pipeline.hpp"
#include "core/parameters/parameter_map.hpp"

namespace fail_aware::odometry_test {
namespace {

std::vector<Sweep> scanStreet(int sweeps) {
  const synthetic::Street street;
  const synthetic::Drive drive;
  std::vector<Sweep> out;
  for (int i = 0; i < sweeps; ++i) {
    out.push_back(
        street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i)));
  }
  return out;
}

Parameters parameters() {
  Parameters chosen;
  chosen.cfg = FAIL_AWARE_SOURCE_CFG;
  return chosen;
}

TEST(Odometry, GivesThePipelinesResults) {
  Parameters chosen = parameters();
  chosen.overrides = {{"registration.use_corner_svd", "false"}};
  PipelineParameters same = loadPipelineParameters({FAIL_AWARE_SOURCE_CFG});
  setParameter(same, "registration.use_corner_svd=false");
  Odometry odometry(chosen, 1);
  OdometryPipeline pipeline(same, 1);
  odometry.startRedundant();
  pipeline.startRedundant();
  for (Sweep& sweep : scanStreet(5)) {
    const Result result = odometry.step(sweep);
    const SweepResult expected = pipeline.step(sweep);
    EXPECT_EQ(result.status, expected.status);
    EXPECT_TRUE(result.hasPose());
    EXPECT_EQ(result.T_odom_base.matrix(), expected.T_odom_base.matrix());
    EXPECT_EQ(result.covariance, expected.odometry_covariance);
    EXPECT_EQ(result.monitor.state, expected.monitor.state);
    EXPECT_EQ(result.monitor.time_to_failure.seconds, expected.monitor.time_to_failure.seconds);
  }
}

TEST(Odometry, ARefusedStampRepeatsTheLastResult) {
  Odometry odometry(parameters(), 1);
  odometry.startRedundant();
  Result last;
  const std::vector<Sweep> sweeps = scanStreet(5);
  for (const Sweep& sweep : sweeps) last = odometry.step(sweep);
  ASSERT_NE(last.monitor.state, FailAwareState::kUnknown);
  const Result refused = odometry.step(sweeps.back());
  EXPECT_EQ(refused.status, SweepStatus::kStampNotAdvancing);
  EXPECT_EQ(refused.T_odom_base.matrix(), last.T_odom_base.matrix());
  EXPECT_EQ(refused.covariance, last.covariance);
  EXPECT_EQ(refused.monitor.state, last.monitor.state);
  EXPECT_EQ(refused.monitor.stamp_s, last.monitor.stamp_s);
}

TEST(Odometry, LeavesOutPointsThatAreNoReturns) {
  const std::vector<Sweep> clean = scanStreet(2);
  Odometry one(parameters(), 1), other(parameters(), 1);
  for (const Sweep& sweep : clean) {
    Sweep dirty = sweep;
    const auto inFront = [](auto& values, auto value) {
      if (!values.empty()) values.insert(values.begin(), value);
    };
    for (const float x : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
      dirty.points_lidar.insert(dirty.points_lidar.begin(), Eigen::Vector3f(x, 0.0f, 0.0f));
      inFront(dirty.intensities, 1.0f);
      inFront(dirty.times_s, 0.01f);
      inFront(dirty.rings, std::uint16_t{3});
    }
    EXPECT_EQ(one.step(std::move(dirty)).T_odom_base.matrix(), other.step(sweep).T_odom_base.matrix());
  }
}

TEST(Odometry, RefusesWhatMakesNoSense) {
  Parameters chosen = parameters();
  chosen.overrides = {{"registration.no_such_key", "1"}};
  EXPECT_THROW(Odometry(chosen, 1), std::invalid_argument);
  chosen.overrides.clear();
  chosen.profile = "no_such_profile";
  EXPECT_THROW(Odometry(chosen, 1), std::runtime_error);
  Odometry odometry(parameters(), 1);
  Sweep sweep;
  sweep.stamp_s = std::nan("");
  EXPECT_THROW(odometry.step(sweep), std::invalid_argument);
  sweep.stamp_s = 0.0;
  sweep.rings = {1};
  EXPECT_THROW(odometry.step(sweep), std::invalid_argument);
  sweep.rings.clear();
  EXPECT_FALSE(odometry.step(sweep).hasPose()) << "no points yet";
}

}  // namespace
}  // namespace fail_aware::odometry_test
