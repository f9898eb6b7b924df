// measure_latency and replay_benchmark without a ROS master; with one: test/nodelets/replay_test.cpp.
#include <gtest/gtest.h>

#include "../support/tool_run.hpp"

namespace fail_aware::measure_latency_test {
namespace {

class LiveTools : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("live_tools_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void expectRefused(const std::string& program, const std::string& arguments, const std::string& part) const {
    const ToolRun run = runProgram(program, arguments, folder_);
    EXPECT_EQ(run.exit_code, 2) << arguments << run.err;
    EXPECT_NE(run.err.find("error: "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << "'" << part << "' not in: " << run.err;
  }

  std::filesystem::path folder_;
};

TEST_F(LiveTools, MeasureLatencySaysWhatItNeeds) {
  setenv("ROS_MASTER_URI", "http://localhost:1", 1);
  EXPECT_EQ(runProgram(MEASURE_LATENCY, "--help", folder_).exit_code, 0);
  expectRefused(MEASURE_LATENCY, "", "no ROS master at http://localhost:1");
  expectRefused(MEASURE_LATENCY, "--duration -1", "--duration");
  expectRefused(MEASURE_LATENCY, "--nonsense", "--nonsense");
}

TEST_F(LiveTools, ReplayBenchmarkSaysWhatItNeeds) {
  EXPECT_EQ(runProgram(SCRIPTS "/replay_benchmark", "--help", folder_).exit_code, 0);
  expectRefused(SCRIPTS "/replay_benchmark", "/no/such/drive", "/no/such/drive: no such file or folder");
  expectRefused(SCRIPTS "/replay_benchmark", "'" + folder_.string() + "' --rate 0", "--rate");
}

}  // namespace
}  // namespace fail_aware::measure_latency_test
