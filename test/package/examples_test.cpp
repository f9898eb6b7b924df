// examples/: what runs without a ROS master. The planners: test/nodelets/planner_example_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "../../src/nodelets/fail_aware_monitor_params.hpp"
#include "../support/tool_run.hpp"
#include "source_tree.hpp"

namespace fail_aware {
namespace {

namespace fs = std::filesystem;

/// A room of 18 m x 55 m, in which the lidar moves by 0.5 m a sweep along x.
void writeScan(const fs::path& path, int sweep) {
  constexpr double kHeight_m = 1.73, kRadPerDeg = 0.017453292519943295;
  const double moved = 0.5 * sweep;
  std::ofstream file(path, std::ios::binary);
  for (int beam = 0; beam < 32; ++beam) {
    const double elevation = (-20.0 + 0.8 * beam) * kRadPerDeg;
    for (int degree = 0; degree < 360; ++degree) {
      const double x = std::cos(degree * kRadPerDeg) * std::cos(elevation);
      const double y = std::sin(degree * kRadPerDeg) * std::cos(elevation), z = std::sin(elevation);
      double range = z < 0.0 ? kHeight_m / -z : 1e3;
      range = std::min(range, (y > 0.0 ? 8.0 : 10.0) / std::max(std::abs(y), 1e-6));
      range = std::min(range, (x > 0.0 ? 30.0 - moved : 25.0 + moved) / std::max(std::abs(x), 1e-6));
      const float point[] = {static_cast<float>(range * x), static_cast<float>(range * y),
                             static_cast<float>(range * z), 0.5f};
      file.write(reinterpret_cast<const char*>(point), sizeof point);
    }
  }
}

TEST(Examples, minimalRunsOverAFolder) {
  const fs::path folder = fs::path(::testing::TempDir()) / ("minimal_example_" + std::to_string(getpid()));
  fs::create_directories(folder / "drive/velodyne");
  for (int i = 0; i < 5; ++i) writeScan(folder / "drive/velodyne" / ("00000" + std::to_string(i) + ".bin"), i);
  const ToolRun run = runProgram(MINIMAL_EXAMPLE, "'" + (folder / "drive").string() + "'", folder);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 5) << run.out;
  std::smatch last;
  ASSERT_TRUE(std::regex_search(run.out, last, std::regex("0\\.400 s  x ([0-9.]+) .*  OK  [0-9.]+ s\n$"))) << run.out;
  EXPECT_NEAR(std::stod(last[1]), 2.0, 0.1);
  EXPECT_EQ(runProgram(MINIMAL_EXAMPLE, "", folder).exit_code, 2);
  EXPECT_EQ(runProgram(MINIMAL_EXAMPLE, "/no/such/folder", folder).exit_code, 1);
  fs::remove_all(folder);
}

double numberIn(const std::string& file, const std::string& expression) {
  const std::string text = readText(sourcePath(file));
  std::smatch match;
  return std::regex_search(text, match, std::regex(expression)) ? std::stod(match[1]) : std::nan("");
}

TEST(Examples, plannersHaveThePatienceOfTheContract) {
  const double patience_s = numberIn("msg/TimeToFailure.msg", "No message in ([0-9.]+) s means failed");
  EXPECT_EQ(numberIn("examples/planner.cpp", "kSilence_s = ([0-9.]+);"), patience_s);
  EXPECT_EQ(numberIn("examples/planner.py", "SILENCE_S = ([0-9.]+)"), patience_s);
  const FailAwareMonitorNodeletParams monitor;
  EXPECT_LT(monitor.silence.stale_sweeps * monitor.silence.max_period_s, patience_s) << "silence is told before that";
}

}  // namespace
}  // namespace fail_aware
