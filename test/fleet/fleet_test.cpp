// fleet/run over six short drives, one of them broken: killed, resumed, changed; and what fleet/ refuses.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "../support/tool_run.hpp"

namespace fail_aware::fleet_test {
namespace {

namespace fs = std::filesystem;

const std::string kFleet = FAIL_AWARE_SOURCE_DIR "/fleet";

class Fleet : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  /// Version 7 or newer; Debian 11 has an older one.
  static bool snakemakeIsThere() {
    return std::system("snakemake --version 2>/dev/null | grep -qE '^([7-9]|[1-9][0-9])[.]'") == 0;
  }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  /// The tools of this build come first.
  std::string environment() const {
    return "XDG_CACHE_HOME='" + (folder_ / "cache").string() + "' PATH='" +
           fs::path(OFFLINE_ODOMETRY).parent_path().string() + "':\"$PATH\"";
  }
  std::string options(const std::string& table = "fleet.csv") const {
    return "--config '" + (folder_ / "config.yaml").string() + "' --table '" + (folder_ / table).string() +
           "' --output '" + (folder_ / "out").string() + "'";
  }
  ToolRun run(const std::string& arguments) const {
    return runProgram(kFleet + "/run", arguments, folder_, environment());
  }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(contentOf(folder_ / name)); }

  /// Of the files that stand for a step.
  std::map<std::string, fs::file_time_type> times(const std::string& below, const std::string& name) const {
    std::map<std::string, fs::file_time_type> found;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "out" / below, error)) {
      if (fs::exists(entry.path() / name)) {
        found[entry.path().filename().string()] = fs::last_write_time(entry.path() / name);
      }
    }
    return found;
  }

  std::vector<std::string> judgedDrives() const {
    std::vector<std::string> names;
    for (const auto& [name, time] : times("results", "result.json")) {
      if (fs::exists(folder_ / "out/runs" / name / "summary.json")) names.push_back(name);
    }
    return names;
  }

  /// A recording as a folder, made here.
  void makeDrive(const std::string& name, const std::string& arguments) const {
    const ToolRun made =
        runProgram(SIMULATE_DRIVE, "--output '" + (folder_ / name).string() + "' " + arguments, folder_);
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }

  /// Until one drive has been run and judged, and others have not.
  void startAndKill(const std::string& arguments) const {
    const fs::path pid_file = folder_ / "pid";
    const std::string command = environment() + " '" + kFleet + "/run' " + arguments + " >'" +
                                (folder_ / "killed").string() + "' 2>&1 & echo $! >'" + pid_file.string() + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const int pid = std::stoi(contentOf(pid_file));
    for (int tenth = 0; judgedDrives().empty(); ++tenth) {
      ASSERT_LT(tenth, 6000) << contentOf(folder_ / "killed");
      ASSERT_EQ(kill(pid, 0), 0) << "it ended by itself: " << contentOf(folder_ / "killed");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    ASSERT_EQ(kill(pid, SIGKILL), 0);
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("fleet_" + std::to_string(getpid()));
};

const std::string kTable =
    "name,recording,truth,simulate,tag_scene,tag_weather\n"
    "town_1,,,--scene town --duration 4 --start-speed 8 --seed 1,town,dry\n"
    "town_2,,,--scene town --duration 4 --start-speed 8 --seed 2 --fault half_sweep:2:1,town,dry\n"
    "country_3,,,--scene country --duration 4 --seed 3,country,wet\n"
    "country_4,,,--scene country --duration 4 --seed 4,country,dry\n"
    "recorded,drive,drive/poses.txt,,town,wet\n"
    "broken,broken_drive,drive/poses.txt,,town,wet\n";
const std::string kConfig =
    "episode_every_s: 1\nresamples: 20\nmonitor_parameters: [monitor.yaml]\n"
    "calibrate: {fit: {scene: town}, judge: {scene: country}}\n";

TEST_F(Fleet, SixDrivesOneOfThemBrokenKilledAndResumed) {
  if (!snakemakeIsThere()) GTEST_SKIP() << "no snakemake of version 7: run scripts/install_dependencies";
  ASSERT_NO_FATAL_FAILURE(makeDrive("drive", "--scene town --duration 4 --start-speed 8 --seed 5"));
  write("broken_drive/velodyne/readme.txt", "no scan here\n");
  write("fleet.csv", kTable);
  write("config.yaml", kConfig);
  write("monitor.yaml", "monitor:\n  thresholds:\n    degraded_s: 10.0\n");

  ASSERT_NO_FATAL_FAILURE(startAndKill(options() + " --cores 2"));
  EXPECT_FALSE(fs::exists(folder_ / "out/aggregate/aggregate.json"));
  const std::vector<std::string> done = judgedDrives();
  ASSERT_LT(done.size(), 5u) << "too late to be in the middle";
  const auto made_before = times("runs", "odometry.json");
  ToolRun outcome = run(options() + " --cores 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const auto odometry = times("runs", "odometry.json");
  EXPECT_EQ(odometry.size(), 6u);
  for (const std::string& name : done) {
    EXPECT_EQ(odometry.at(name), made_before.at(name)) << name << " was run before the kill and is not run again";
  }
  const fs::path drives = folder_ / "out/drives";
  EXPECT_TRUE(!fs::exists(drives) || fs::is_empty(drives)) << "made-up drives are removed";

  nlohmann::json found = json("out/aggregate/aggregate.json");
  EXPECT_EQ(found["judged"], nlohmann::json({"town_1", "town_2", "country_3", "country_4", "recorded"}));
  ASSERT_EQ(found["not_judged"].size(), 1u);
  EXPECT_EQ(found["not_judged"][0]["name"], "broken");
  EXPECT_EQ(found["not_judged"][0]["status"], "unusable");
  EXPECT_EQ(found["pooled"], "") << "evaluate_fail_aware took all episodes together";
  EXPECT_EQ(found["tags"]["weather"]["wet"]["accuracy"]["recordings"], 2);
  EXPECT_EQ(found["worst"].size(), 5u);
  for (const auto& row : found["worst"]) {
    EXPECT_TRUE(fs::exists(folder_ / "out/aggregate" / row["report"].get<std::string>())) << row;
  }
  const nlohmann::json result = json("out/results/town_1/result.json");
  EXPECT_EQ(result["version"].get<std::string>().rfind("1.", 0), 0u) << result["version"];
  EXPECT_EQ(result["parameters_sha256"].get<std::string>().size(), 64u);

  // Judged one by one is as judged all at once, to the last digit.
  std::string all;
  for (const std::string name : found["judged"]) {
    const std::string folder = (folder_ / "out/runs" / name).string();
    all += " --run '" + folder + "' --ground-truth '" + folder + "/truth.txt'";
  }
  const ToolRun at_once =
      runProgram(EVALUATE_FAIL_AWARE,
                 all + " --episode-every 1 --resamples 20 --parameters '" + (folder_ / "monitor.yaml").string() +
                     "' --output '" + (folder_ / "at_once").string() + "'",
                 folder_);
  ASSERT_EQ(at_once.exit_code, 0) << at_once.err;
  for (const char* name : {"fail_aware.json", "predictions.csv", "episodes.csv"}) {
    EXPECT_EQ(contentOf(folder_ / "out/aggregate" / name), contentOf(folder_ / "at_once" / name)) << name;
  }
  EXPECT_EQ(found["all"]["all_starts"]["starts"], json("at_once/fail_aware.json")["pooled"]["episodes"]);

  // Another parameter of the monitor: judged again, not run again.
  const auto results = times("results", "result.json");
  write("monitor.yaml", "monitor:\n  thresholds:\n    degraded_s: 11.0\n");
  outcome = run(options() + " --cores 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(times("runs", "odometry.json"), odometry);
  const auto results_now = times("results", "result.json");
  for (const auto& [name, time] : results) EXPECT_NE(results_now.at(name), time) << name;
  EXPECT_NE(json("out/results/town_1/result.json")["parameters_sha256"], result["parameters_sha256"]);

  // Nothing changed: nothing is made.
  outcome = run(options() + " --cores 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(times("results", "result.json"), results_now);
}

TEST_F(Fleet, WhatCannotBeUsedIsRefusedInOneLine) {
  write("config.yaml", kConfig);
  write("monitor.yaml", "");
  write("fleet.csv", kTable);
  write("twice.csv", "name,simulate\na,--seed 1\na,--seed 2\n");
  write("typo.csv", "name,simulat\na,--seed 1\n");
  write("both.csv", "name,recording,truth,simulate\na,drive,poses.txt,--seed 1\n");
  write("out_of.csv", "name,simulate\n../a,--seed 1\n");
  expectOneErrorLine(run(options()), "fleet/run", "--cores");
  if (!snakemakeIsThere()) GTEST_SKIP() << "no snakemake of version 7: run scripts/install_dependencies";
  expectOneErrorLine(run(options("nowhere.csv") + " --cores 1"), "fleet/run", "nowhere.csv");
  expectOneErrorLine(run(options("twice.csv") + " --cores 1"), "fleet/run", "twice");
  expectOneErrorLine(run(options("typo.csv") + " --cores 1"), "fleet/run", "unknown column 'simulat'");
  expectOneErrorLine(run(options("both.csv") + " --cores 1"), "fleet/run", "either");
  expectOneErrorLine(run(options("out_of.csv") + " --cores 1"), "fleet/run", "name");
  write("config.yaml", "calibrate: {fit: {scene: [town, country]}, judge: {scene: country}}\n");
  const ToolRun refused = run("calibrate " + options() + " --cores 1");
  EXPECT_EQ(refused.exit_code, 2);
  expectOneErrorLine(refused, "fleet/run", "country_3, country_4: to be fitted on and judged on");
  write("config.yaml", "nonsense: 1\n");
  expectOneErrorLine(run(options() + " --cores 1"), "fleet/run", "unknown: nonsense");
}

TEST_F(Fleet, ItsPartsAreRight) {
  const ToolRun outcome =
      runProgram("/usr/bin/python3", "-B '" FAIL_AWARE_SOURCE_DIR "/test/fleet/check_fleet_tools.py'", folder_);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Fleet, AFleetIsMadeUpTheSameWayEachTime) {
  const std::string arguments = "--drives 24 --hours 0.1 --output '";
  for (const char* name : {"one.csv", "two.csv"}) {
    const ToolRun made = runProgram(kFleet + "/make_fleet", arguments + (folder_ / name).string() + "'", folder_);
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  const std::string table = contentOf(folder_ / "one.csv");
  EXPECT_EQ(table, contentOf(folder_ / "two.csv"));
  EXPECT_EQ(countOf(table, "--duration 15.0"), 24u);
  for (const char* part : {"highway", "tunnel", "--fault", "--beam-errors 2", "--head vlp16,velodyne"}) {
    EXPECT_GT(countOf(table, part), 0u) << part;
  }
  expectOneErrorLine(runProgram(kFleet + "/make_fleet", "--drives 0", folder_), "fleet/make_fleet");
}

}  // namespace
}  // namespace fail_aware::fleet_test
