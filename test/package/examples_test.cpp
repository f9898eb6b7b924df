// examples/: the planners' constants. They run in test/nodelets/planner_example_test.cpp, the others in test/installed.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <string>

#include "../../src/nodelets/fail_aware_monitor_params.hpp"
#include "source_tree.hpp"

namespace fail_aware::examples_test {
namespace {

double numberIn(const std::string& file, const std::string& expression) {
  const std::string text = readText(sourcePath(file));
  std::smatch match;
  return std::regex_search(text, match, std::regex(expression)) ? std::stod(match[1]) : std::nan("");
}

TEST(Examples, PlannersHaveThePatienceOfTheContract) {
  const double patience_s = numberIn("msg/TimeToFailure.msg", "No message in ([0-9.]+) s means failed");
  EXPECT_EQ(numberIn("examples/planner.cpp", "kSilence_s = ([0-9.]+);"), patience_s);
  EXPECT_EQ(numberIn("examples/planner.py", "SILENCE_S = ([0-9.]+)"), patience_s);
  const FailAwareMonitorNodeletParams monitor;
  EXPECT_LT(monitor.silence.stale_sweeps * monitor.silence.max_period_s, patience_s) << "silence is told before that";
}

}  // namespace
}  // namespace fail_aware::examples_test
