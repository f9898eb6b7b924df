// Defaults in the .cfg files, in code and in cfg/profiles/default.yaml agree; a request never gives an invalid set.
#include "../../src/nodelets/tuning.hpp"

#include "fail_aware_lidar_odometry/CornerSvdConfig.h"
#include "fail_aware_lidar_odometry/FailAwareMonitorConfig.h"
#include "fail_aware_lidar_odometry/FusionUkfConfig.h"
#include "fail_aware_lidar_odometry/IcpPointToPlaneConfig.h"
#include "fail_aware_lidar_odometry/IcpPointToPointConfig.h"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "../../src/nodelets/reconfiguration.hpp"
#include "core/integrity/silence.hpp"
#include "core/io/profile_files.hpp"
#include "core/parameters/validate.hpp"
#include "core/stamp_difference.hpp"

namespace fail_aware::tuning_test {
namespace {

namespace config = ::fail_aware_lidar_odometry;

ProfileParameters defaultYaml() {
  return loadPipelineParameters({FAIL_AWARE_SOURCE_CFG, "default", "passat_b6", "hdl64e"}).profile;
}

TEST(Tuning, ASourceThatHangsIsNotTakenForSilence) {
  EXPECT_LT(FusionUkfNodeletParams().deadline_s + kUsualPeriod_s, staleAfter_s(SilenceParams(), kUsualPeriod_s));
}

template <class Config, class Tuning>
void expectSameDefaults(const Tuning& in_code, const Tuning& in_yaml) {
  EXPECT_EQ(valuesOf(Config::__getDefault__()), toMap(in_code));
  EXPECT_EQ(toMap(in_yaml), toMap(in_code));
}

TEST(Tuning, DeadlinesThatRosCannotHoldAreRefused) {
  for (double FusionUkfNodeletParams::*deadline :
       {&FusionUkfNodeletParams::deadline_s, &FusionUkfNodeletParams::late_deadline_s,
        &FusionUkfNodeletParams::first_deadline_s}) {
    FusionUkfNodeletParams params;
    params.*deadline = 600.0;
    EXPECT_NO_THROW(validate(params));
    params.*deadline = 1e10;
    EXPECT_THROW(validate(params), ParameterError);
  }
}

TEST(Tuning, DefaultsOfCfgCodeAndYamlAgree) {
  const ProfileParameters yaml = defaultYaml();
  expectSameDefaults<config::FusionUkfConfig>(
      FusionUkfTuning(), FusionUkfTuning{FusionUkfNodeletParams(), yaml.registration, yaml.fusion});
  expectSameDefaults<config::FailAwareMonitorConfig>(FailAwareMonitorTuning(), FailAwareMonitorTuning{yaml.monitor});
  expectSameDefaults<config::IcpPointToPointConfig>(IcpPointToPointTuning(),
                                                    IcpPointToPointTuning{yaml.registration.icp_point_to_point});
  expectSameDefaults<config::IcpPointToPlaneConfig>(IcpPointToPlaneTuning(),
                                                    IcpPointToPlaneTuning{yaml.registration.icp_point_to_plane});
  expectSameDefaults<config::CornerSvdConfig>(CornerSvdTuning(), CornerSvdTuning{yaml.registration.corner_alignment});
}

/// Each bound by itself, the others at their defaults: valid, or refused by a rule between two parameters.
template <class Config, class Tuning>
void expectUsableBounds(const std::vector<std::string>& tied) {
  for (const Config& bounds : {Config::__getMin__(), Config::__getMax__()}) {
    for (const auto& [name, value] : valuesOf(bounds)) {
      if (std::find(tied.begin(), tied.end(), name) != tied.end()) continue;
      Tuning tuning;
      fromMap(tuning, ParameterMap{{name, value}}, MissingKeys::kKeep);
      EXPECT_NO_THROW(validate(tuning)) << name;
    }
  }
}

TEST(Tuning, BoundsAreWithinTheRules) {
  expectUsableBounds<config::FusionUkfConfig, FusionUkfTuning>({});
  expectUsableBounds<config::FailAwareMonitorConfig, FailAwareMonitorTuning>(
      {"confidence", "alarm_confidence", "failing_s", "degraded_s"});
  expectUsableBounds<config::IcpPointToPointConfig, IcpPointToPointTuning>({});
  expectUsableBounds<config::IcpPointToPlaneConfig, IcpPointToPlaneTuning>({});
  expectUsableBounds<config::CornerSvdConfig, CornerSvdTuning>({});
}

TEST(Tuning, ARequestChangesWhatItNames) {
  FailAwareMonitorTuning current;
  current.monitor.thresholds.failing_s = 4.0;  // from yaml
  auto request = configOf<config::FailAwareMonitorConfig>(current);
  EXPECT_EQ(request.failing_s, 4.0);
  request.alert_limit_m = 0.3;
  const FailAwareMonitorTuning tuned = tunedBy(request, current);
  EXPECT_EQ(tuned.monitor.predictor.alert_limit_m, 0.3);
  EXPECT_EQ(tuned.monitor.thresholds.failing_s, 4.0);
}

TEST(Tuning, AnInvalidSetIsRefusedWithTheRule) {
  const FailAwareMonitorTuning current;
  auto request = configOf<config::FailAwareMonitorConfig>(current);
  request.failing_s = 20.0;  // more than degraded_s
  try {
    tunedBy(request, current);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("degraded_s"), std::string::npos) << error.what();
  }
  auto blind = configOf<config::FusionUkfConfig>(FusionUkfTuning());
  blind.use_icp_point_to_point = blind.use_icp_point_to_plane = false;
  EXPECT_THROW(tunedBy(blind, FusionUkfTuning()), ParameterError);
}

/// Chains of requests with values of any size, NaN among them: refused, or a set that keeps every rule.
template <class Config, class Tuning>
void expectEveryRequestRefusedOrValid() {
  std::mt19937 random(7);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const double odd[] = {0.0, -1.0, 1e-300, 1e300, std::nan(""), HUGE_VAL, -HUGE_VAL};
  Tuning current;
  int taken = 0, refused = 0;
  for (int i = 0; i < 3000; ++i) {
    dynamic_reconfigure::Config message;
    configOf<Config>(current).__toMessage__(message);
    for (auto& value : message.bools) {
      if (draw(0, 1) < 0.1) value.value = value.value == 0;
    }
    for (auto& value : message.ints) {
      if (draw(0, 1) < 0.1) value.value = static_cast<int>(draw(-100.0, 1000.0));
    }
    for (auto& value : message.doubles) {
      if (draw(0, 1) < 0.1) value.value *= draw(0.3, 3.0);
      if (draw(0, 1) < 0.02) value.value = odd[random() % 7];
    }
    Config request = configOf<Config>(current);
    request.__fromMessage__(message);
    if (i % 2 == 0) request.__clamp__();  // as the server does
    try {
      current = tunedBy(request, current);
      ++taken;
    } catch (const ParameterError&) {
      ++refused;
    }
    ASSERT_NO_THROW(validate(current));
    for (const auto& [name, value] : toMap(current)) {
      const double* number = std::get_if<double>(&value);
      ASSERT_TRUE(number == nullptr || std::isfinite(*number)) << name;
    }
  }
  EXPECT_GT(taken, 100);
  EXPECT_GT(refused, 20);
}

TEST(Tuning, EveryRequestIsRefusedOrValid) {
  expectEveryRequestRefusedOrValid<config::FusionUkfConfig, FusionUkfTuning>();
  expectEveryRequestRefusedOrValid<config::FailAwareMonitorConfig, FailAwareMonitorTuning>();
  expectEveryRequestRefusedOrValid<config::IcpPointToPointConfig, IcpPointToPointTuning>();
  expectEveryRequestRefusedOrValid<config::IcpPointToPlaneConfig, IcpPointToPlaneTuning>();
  expectEveryRequestRefusedOrValid<config::CornerSvdConfig, CornerSvdTuning>();
}

TEST(Tuning, AValueOfTheYamlBeyondTheBoundsStaysUntilItIsChanged) {
  FusionUkfTuning current;
  current.fusion.gate_sigma = 500.0;  // valid, though no slider goes there
  auto request = configOf<config::FusionUkfConfig>(current);
  request.queue_size = 5;
  request.__clamp__();  // as the server does
  FusionUkfTuning tuned = tunedBy(request, current);
  EXPECT_EQ(tuned.fusion.gate_sigma, 500.0);
  EXPECT_EQ(tuned.node.queue_size, 5);
  request.gate_sigma = 4.0;
  tuned = tunedBy(request, tuned);
  EXPECT_EQ(tuned.fusion.gate_sigma, 4.0);
}

}  // namespace
}  // namespace fail_aware::tuning_test
