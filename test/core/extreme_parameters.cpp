// The smallest and the largest power of ten, or zero, that validate() takes for every number, one at a time, over a
// short drive with an empty sweep and a gap in a street: it ends, and what comes out is finite.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "../support/street_parameters.hpp"
#include "../support/synthetic_street.hpp"
#include "core/odometry_pipeline.hpp"
#include "core/parameters/parameter_map.hpp"
#include "core/parameters/validate.hpp"
#include "parameters/error_of.hpp"

namespace fail_aware::extreme_parameters {
namespace {

std::vector<Sweep> shortDrive() {
  const synthetic::Street street;
  const synthetic::Drive drive;
  synthetic::Lidar lidar;
  lidar.beams = 32;
  lidar.columns = 90;
  std::vector<Sweep> sweeps;
  for (const int i : {0, 1, 2, 3, 4, 5, 12, 13}) {
    sweeps.push_back(
        street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i), lidar));
  }
  sweeps[4] = Sweep();
  sweeps[4].stamp_s = 0.4;
  return sweeps;
}

/// What is wrong with the drive; empty: nothing.
std::string faultOfDrive(const PipelineParameters& params, const std::vector<Sweep>& sweeps) {
  try {
    OdometryPipeline pipeline(params, 1);
    pipeline.startRedundant();
    for (Sweep sweep : sweeps) {
      const SweepResult r = pipeline.step(sweep);
      const bool finite = r.T_odom_base.matrix().allFinite() && r.state.covariance.allFinite() &&
                          r.state.increment_covariance.allFinite() && std::isfinite(r.monitor.eta) &&
                          std::isfinite(r.monitor.protection_level_m) &&
                          std::isfinite(r.monitor.time_to_failure.seconds);
      if (!finite) return "not finite at " + std::to_string(sweep.stamp_s) + " s";
    }
  } catch (const std::exception& error) {
    return std::string("threw: ") + error.what();
  }
  return "";
}

struct Extreme {
  std::string what;
  PipelineParameters params;
  std::string fault;
};

/// All drives, as many at a time as there are cores.
void drive(std::vector<Extreme>& extremes) {
  const std::vector<Sweep> sweeps = shortDrive();
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads(std::max(1u, std::thread::hardware_concurrency()));
  for (std::thread& thread : threads) {
    thread = std::thread([&] {
      for (std::size_t i = next++; i < extremes.size(); i = next++) {
        extremes[i].fault = faultOfDrive(extremes[i].params, sweeps);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(ExtremeParameters, TheDriveMeasuresBeforeAndAfterItsGap) {
  OdometryPipeline pipeline(synthetic::streetParameters(), 1);
  std::vector<SweepStatus> statuses;
  std::vector<std::array<bool, 2>> measured;  // by points, by planes; corners: too few points for any
  for (Sweep sweep : shortDrive()) {
    const SweepResult r = pipeline.step(sweep);
    statuses.push_back(r.status);
    measured.push_back({r.of(kIcpPointToPoint).measurement.ok(), r.of(kIcpPointToPlane).measurement.ok()});
  }
  using S = SweepStatus;
  EXPECT_EQ(statuses, (std::vector<S>{S::kFirst, S::kCorrected, S::kCorrected, S::kCorrected, S::kPredicted,
                                      S::kCorrected, S::kCorrected, S::kCorrected}));
  EXPECT_EQ(measured[3], (std::array<bool, 2>{true, true})) << "points, planes";
  EXPECT_EQ(measured[7], (std::array<bool, 2>{true, true})) << "points, planes";
}

TEST(ExtremeParameters, EveryDriveEndsAndIsFinite) {
  PipelineParameters params = synthetic::streetParameters();
  std::vector<Extreme> extremes;
  detail::visitLeaves(params, "", [&](const std::string& key, auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, int>) {
      const Field valid = field;
      std::vector<Field> taken;
      const auto offer = [&](double value) {
        field = static_cast<Field>(value);
        if (errorOf([&] { validate(params); }) == kNoError) taken.push_back(field);
      };
      for (int exponent = -12; exponent <= 9; ++exponent) {
        for (const double sign : {-1.0, 1.0}) offer(sign * std::pow(10.0, exponent));
      }
      offer(0.0);
      if (!taken.empty()) {
        const auto [low, high] = std::minmax_element(taken.begin(), taken.end());
        for (const Field extreme : {*low, *high}) {
          field = extreme;
          extremes.push_back({key + " = " + std::to_string(extreme), params, ""});
        }
      }
      field = valid;
    }
  });
  EXPECT_GT(extremes.size(), 200u);
  drive(extremes);
  for (const Extreme& extreme : extremes) EXPECT_EQ(extreme.fault, "") << extreme.what;
}

}  // namespace
}  // namespace fail_aware::extreme_parameters
