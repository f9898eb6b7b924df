// What the README promises the planner and says of the nodelets' parameters is what the shipped configuration holds.
#include <fail_aware_lidar_odometry/TimeToFailure.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>
#include <variant>

#include "../../src/nodelets/fail_aware_monitor_params.hpp"
#include "../../src/nodelets/fusion_ukf_params.hpp"
#include "../package/source_tree.hpp"
#include "fail_aware_lidar_odometry/core/io/profile_files.hpp"
#include "fail_aware_lidar_odometry/core/parameters/parameter_map.hpp"
#include "fail_aware_lidar_odometry/core/sweep/stamp_order.hpp"

namespace fail_aware {
namespace {

std::string readme() { return readText(sourcePath("README.md")); }

/// The section under that heading, up to the next one.
std::string section(const std::string& heading) {
  const std::string text = readme();
  const std::size_t begin = text.find("\n" + heading + "\n");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find("\n##", begin + heading.size()) - begin);
}

/// The number that the expression's first group finds; NaN: it finds none.
double numberIn(const std::string& text, const std::string& expression) {
  std::smatch match;
  if (!std::regex_search(text, match, std::regex(expression))) return std::nan("");
  return std::stod(match[1]);
}

TEST(Readme, ThePlannersContractHasTheShippedThresholds) {
  const MonitorParameters shipped =
      loadPipelineParameters({FAIL_AWARE_SOURCE_CFG, "default", "passat_b6", "hdl64e"}).profile.monitor;
  const std::string contract = section("### The planner's contract");
  EXPECT_EQ(numberIn(contract, R"(alert limit \(([0-9.]+) m horizontally)"), shipped.predictor.alert_limit_m);
  EXPECT_EQ(numberIn(contract, R"(`OK` \| `time_to_failure` > ([0-9.]+) s)"), shipped.thresholds.degraded_s);
  EXPECT_EQ(numberIn(contract, R"(`DEGRADED` \| <= ([0-9.]+) s)"), shipped.thresholds.degraded_s);
  EXPECT_EQ(numberIn(contract, R"(`FAILING` \| `FAILED` in <= ([0-9.]+) s)"), shipped.thresholds.failing_s);
  EXPECT_EQ(numberIn(contract, R"(`horizon` \(([0-9.]+) s\))"), shipped.predictor.horizon_s);
}

TEST(Readme, SilenceIsToldBeforeThePlannersPatienceEnds) {
  const std::string contract = section("### The planner's contract");
  const double patience_s = numberIn(contract, R"(no message in ([0-9.]+) s)");
  EXPECT_EQ(numberIn(readText(sourcePath("msg/TimeToFailure.msg")), R"(No message in ([0-9.]+) s means failed)"),
            patience_s);
  EXPECT_EQ(numberIn(contract, R"(toSec\(\) > ([0-9.]+);)"), patience_s) << "the C++ example";
  EXPECT_EQ(numberIn(contract, R"(heard > ([0-9.]+)\n)"), patience_s) << "the Python example";
  const FailAwareMonitorNodeletParams monitor;
  EXPECT_LT(monitor.silence.stale_sweeps * monitor.silence.max_period_s, patience_s);
}

TEST(Readme, ReasonsAndConfidencesHaveTheShippedNumbers) {
  const PipelineParameters shipped = loadPipelineParameters({FAIL_AWARE_SOURCE_CFG, "default", "passat_b6", "hdl64e"});
  const MonitorParameters& monitor = shipped.profile.monitor;
  const SweepCheckParams& check = shipped.sensor.check;
  const std::string reasons = section("### Reasons");
  EXPECT_EQ(numberIn(reasons, R"(no `filter_state` for ([0-9.]+) sweep periods)"),
            FailAwareMonitorNodeletParams().silence.stale_sweeps);
  EXPECT_EQ(numberIn(reasons, R"(`frozen_sweeps` \(([0-9]+)\))"), check.frozen_sweeps);
  EXPECT_EQ(numberIn(reasons, R"(`disagreement_m` \(([0-9.]+) m\))"), monitor.disagreement_m);
  EXPECT_NEAR(numberIn(reasons, R"(fewer than ([0-9.]+) % of the azimuth)"), 100.0 * check.min_azimuth_coverage, 1e-9);
  EXPECT_NEAR(numberIn(reasons, R"(fewer than ([0-9.]+) % of the points)"), 100.0 * check.min_far_share, 1e-9);
  EXPECT_EQ(numberIn(reasons, R"(of the points beyond ([0-9.]+) m)"), check.visible_range_m);
  EXPECT_EQ(numberIn(reasons, R"(stamps more than ([0-9.]+) s apart)"), check.max_gap_s);
  EXPECT_EQ(numberIn(reasons, R"(a stamp more than ([0-9.]+) s ahead)"), kFarAhead_s);
  EXPECT_EQ(numberIn(reasons, R"(`gap_ratio` \(([0-9.]+)\))"), monitor.gap_ratio);
  EXPECT_EQ(numberIn(reasons, R"(v_k / ([0-9.]+) m/s)"), monitor.indicator.reference_speed_mps);
  EXPECT_EQ(numberIn(reasons, R"(T = ([0-9.]+) s)"), monitor.indicator.reference_period_s);
  EXPECT_EQ(numberIn(reasons, R"(only after ([0-9]+) better sweeps)"), monitor.sweeps_to_recover);
  const std::string trust = section("## How far the time to failure can be trusted");
  EXPECT_NEAR(numberIn(trust, R"(`confidence` \(([0-9.]+) %\))"), 100.0 * (1.0 - monitor.predictor.confidence), 1e-9);
  EXPECT_NEAR(numberIn(trust, R"(`alarm_confidence` \(([0-9.]+) %\))"),
              100.0 * (1.0 - monitor.predictor.alarm_confidence), 1e-9);
  EXPECT_NEAR(numberIn(section("### The planner's contract"), R"(probability of ([0-9.]+) % \(`confidence`\))"),
              100.0 * (1.0 - monitor.predictor.confidence), 1e-9);
}

std::string asText(const ParameterValue& value) {
  std::ostringstream text;
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const int* number = std::get_if<int>(&value)) return std::to_string(*number);
  if (const std::string* words = std::get_if<std::string>(&value)) return *words;
  text << std::get<double>(value);
  return text.str();
}

/// Every row `NODELET/A`, `B` | DEFAULT_A, DEFAULT_B | of the parameters' table.
void expectDefaultsInTable(const std::string& nodelet, const ParameterMap& defaults) {
  const std::string table = section("## Parameters");
  const std::regex row("\\| `" + nodelet + "/([^|]*)\\|([^|]*)\\|"), word("[^`, ]+");
  int found = 0;
  for (std::sregex_iterator at(table.begin(), table.end(), row), end; at != end; ++at) {
    const std::string names = (*at)[1], values = (*at)[2];
    std::sregex_iterator value(values.begin(), values.end(), word);
    for (std::sregex_iterator name(names.begin(), names.end(), word); name != end; ++name, ++value) {
      ASSERT_EQ(defaults.count(name->str()), 1u) << nodelet << " has no parameter " << name->str();
      ASSERT_NE(value, end) << name->str();
      std::string told = value->str();
      const ParameterValue& is = defaults.at(name->str());
      if (std::holds_alternative<double>(is)) told = asText(std::stod(told));
      EXPECT_EQ(told, asText(is)) << nodelet << '/' << name->str();
      ++found;
    }
  }
  EXPECT_GT(found, 3) << "the table is not where it was";
}

TEST(Readme, TheParameterTableHasTheDefaults) {
  expectDefaultsInTable("fusion_ukf", toMap(FusionUkfNodeletParams()));
  expectDefaultsInTable("fail_aware_monitor", toMap(FailAwareMonitorNodeletParams()));
}

}  // namespace
}  // namespace fail_aware
