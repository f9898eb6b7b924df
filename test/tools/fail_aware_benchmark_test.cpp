// scripts/fail_aware_benchmark on a short simulated drive with faults.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../support/tool_run.hpp"

namespace fail_aware::fail_aware_benchmark_test {
namespace {

namespace fs = std::filesystem;

class FailAwareBenchmark : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  ToolRun run(const std::string& arguments) const {
    return runProgram(SCRIPTS "/fail_aware_benchmark", arguments, folder_);
  }
  std::string quoted(const char* name) const { return "'" + (folder_ / name).string() + "'"; }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("fail_aware_benchmark_" + std::to_string(getpid()));
};

TEST_F(FailAwareBenchmark, RunsAndJudgesADriveWithFaults) {
  std::ofstream(folder_ / "drives") << "# name group arguments\n"
                                       "street fault --scene town --duration 5 --start-speed 8 --fault half_sweep:2:1 "
                                       "--fault frozen_cloud:4:0.8\n";
  const std::string options = "--drives " + quoted("drives") + " --seeds 3 --resamples 20 --output " + quoted("out");
  const ToolRun outcome = run(options);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("| concordance, combination"), std::string::npos) << outcome.out;
  for (const char* row : {"| planner: in time, % of ", "| planner by state alone", "| best in hindsight, ",
                          "| street: in time", "|   NEES/dof of the accumulated position | "}) {
    EXPECT_NE(outcome.out.find(row), std::string::npos) << row << '\n' << outcome.out;
  }
  EXPECT_NE(outcome.out.find("| detection of frozen_cloud, sweeps, slowest of 1 |"), std::string::npos) << outcome.out;
  EXPECT_TRUE(fs::exists(folder_ / "out/runs/street_3/monitor_log.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/pooled/fail_aware.json"));
  EXPECT_FALSE(fs::exists(folder_ / "out/nominal")) << "there is no such drive";
  EXPECT_FALSE(fs::exists(folder_ / "out/drives/street_3")) << "removed once it has been run";

  std::istringstream table(contentOf(folder_ / "out/detection.csv"));
  std::string line;
  std::getline(table, line);
  std::map<std::string, int> delays;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string name, kind, start, delay;
    std::getline(std::getline(std::getline(std::getline(row, name, ','), kind, ','), start, ','), delay, ',');
    delays[kind] = delay.empty() ? 1000 : std::stoi(delay);
  }
  ASSERT_EQ(delays.size(), 2u);
  EXPECT_LE(delays["half_sweep"], 3);
  EXPECT_LE(delays["frozen_cloud"], 5);

  const auto before = fs::last_write_time(folder_ / "out/runs/street_3/monitor_log.csv");
  EXPECT_EQ(run(options).exit_code, 0);
  EXPECT_EQ(fs::last_write_time(folder_ / "out/runs/street_3/monitor_log.csv"), before) << "made once";
}

TEST_F(FailAwareBenchmark, ARunThatFailsIsNamed) {
  std::ofstream(folder_ / "drives") << "moon hard --scene moon --duration 3\n";
  const ToolRun outcome = run("--drives " + quoted("drives") + " --output " + quoted("out"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("moon_2: simulate_drive: "), std::string::npos) << outcome.err;
}

TEST_F(FailAwareBenchmark, BadInputIsRefusedInOneLine) {
  std::ofstream(folder_ / "drives") << "street anything --scene town\n";
  for (const std::string& arguments : {std::string("--no-drives"), "--nominal " + quoted("nowhere"),
                                       std::string("--drives /does/not/exist"), "--drives " + quoted("drives")}) {
    const ToolRun outcome = run(arguments + " --output " + quoted("out"));
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    expectOneErrorLine(outcome, "fail_aware_benchmark");
  }
}

}  // namespace
}  // namespace fail_aware::fail_aware_benchmark_test
