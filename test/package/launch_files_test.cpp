// Every launch file parses, with the arguments that change its shape, and starts what it should.
#include <gtest/gtest.h>

#include <regex>
#include <variant>

#include "../../src/nodelets/fail_aware_monitor_params.hpp"
#include "../../src/nodelets/fusion_ukf_params.hpp"
#include "../support/tool_run.hpp"
#include "core/parameters/parameter_map.hpp"
#include "source_tree.hpp"

namespace fail_aware::launch_files_test {
namespace {

TEST(LaunchFiles, ParseWithAllTheirShapes) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("launch_files_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const ToolRun run = runProgram(sourcePath("test/package/check_launch_files.py"),
                                 "'" + std::string(FAIL_AWARE_SOURCE_DIR) + "'", folder);
  std::filesystem::remove_all(folder);
  if (run.exit_code == 3) GTEST_SKIP() << run.out;
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("ok: kitti_replay.launch"), std::string::npos) << run.out;
}

/// roslaunch --ros-args shows what they say.
TEST(LaunchFiles, ArgumentsSayWhatTheyAre) {
  static const std::regex argument("<arg name=\"([a-z_]+)\" default=\"[^\"]*\"( doc=\"[^\"]+\")?");
  for (const char* file : {"odometry.launch", "velodyne_hdl64e.launch", "kitti_replay.launch", "demo.launch"}) {
    const std::string text = readText(sourcePath(std::string("launch/") + file));
    int arguments = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), argument), end; at != end; ++at, ++arguments) {
      EXPECT_TRUE((*at)[2].matched) << file << ": " << (*at)[1] << " has no doc";
    }
    EXPECT_GT(arguments, 8) << file;
  }
}

/// What a launch file hands to a nodelet by its parameter's name has the parameter's default, too.
TEST(LaunchFiles, ArgumentsHaveTheNodeletsDefaults) {
  ParameterMap defaults = toMap(FusionUkfNodeletParams());
  for (const auto& [name, value] : toMap(FailAwareMonitorNodeletParams())) defaults[name] = value;
  static const std::regex argument("<arg name=\"([a-z_]+)\" default=\"([^\"]*)\"");
  for (const char* file : {"odometry.launch", "velodyne_hdl64e.launch", "kitti_replay.launch", "demo.launch"}) {
    const std::string text = readText(sourcePath(std::string("launch/") + file));
    int compared = 0;
    for (std::sregex_iterator at(text.begin(), text.end(), argument), end; at != end; ++at) {
      const std::string name = (*at)[1], told = (*at)[2];
      if (defaults.count(name) == 0) continue;
      const ParameterValue& value = defaults.at(name);
      ++compared;
      if (const bool* flag = std::get_if<bool>(&value)) {
        EXPECT_EQ(told, *flag ? "true" : "false") << file << ' ' << name;
      } else if (const std::string* words = std::get_if<std::string>(&value)) {
        EXPECT_EQ(told, *words) << file << ' ' << name;
      } else {
        const int* whole = std::get_if<int>(&value);
        EXPECT_EQ(std::stod(told), whole ? *whole : std::get<double>(value)) << file << ' ' << name;
      }
    }
    EXPECT_GT(compared, 0) << file;
  }
}

}  // namespace
}  // namespace fail_aware::launch_files_test
