// simulate_drive, offline_odometry over what it makes, and scripts/benchmark. SIMULATE_DRIVE,
// OFFLINE_ODOMETRY are their paths, SCRIPTS is the folder of the scripts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "../support/tool_run.hpp"
#include "core/io/kitti_directory.hpp"
#include "core/io/trajectory_io.hpp"
#include "simulation/fault.hpp"

namespace fail_aware::simulate_drive_test {
namespace {

namespace fs = std::filesystem;

class SimulateDrive : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("simulate_drive_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ToolRun simulate(const std::string& name, const std::string& arguments) const {
    return runProgram(SIMULATE_DRIVE, "--output '" + path(name) + "' " + arguments, folder_);
  }
  ToolRun odometry(const std::string& name) const {
    return runProgram(OFFLINE_ODOMETRY, "--kitti '" + path(name) + "' --output '" + path(name + "_out") + "'", folder_);
  }
  std::vector<std::string> lines(const std::string& file) const {
    std::vector<std::string> lines;
    std::ifstream stream(path(file));
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  fs::path folder_;
};

std::vector<std::string> filesBelow(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder).string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_F(SimulateDrive, SameArgumentsSameBytes) {
  const std::string arguments = "--scene town:15,tunnel --duration 0.6 --seed 4 --start-speed 12 --fault noise:0.2:0.2";
  ASSERT_EQ(simulate("a", arguments).exit_code, 0);
  ASSERT_EQ(simulate("b", arguments + " --threads 2").exit_code, 0);
  const std::vector<std::string> files = filesBelow(folder_ / "a");
  ASSERT_EQ(files, filesBelow(folder_ / "b"));
  ASSERT_EQ(files.size(), 3u * 6u + 6u);
  for (const std::string& file : files) {
    EXPECT_EQ(contentOf(folder_ / "a" / file), contentOf(folder_ / "b" / file)) << file;
  }
  const KittiDirectory drive = KittiDirectory::open(path("a"));
  EXPECT_TRUE(drive.hasPointTimes());
  EXPECT_DOUBLE_EQ(drive.stamps()[5], 0.55);
  EXPECT_EQ(readKittiTrajectory(path("a/poses.txt")).size(), 6u);
  EXPECT_EQ(lines("a/faults.csv"), (std::vector<std::string>{"kind,start_s,duration_s,severity", "noise,0.2,0.2,0.2"}));
}

TEST_F(SimulateDrive, TheOdometryFollowsIt) {
  const ToolRun made = simulate("drive", "--scene town --duration 3 --seed 2");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_NE(made.err.find("town, 3 s, 30 sweeps, faults: 0\nsimulate_drive: next: "), std::string::npos) << made.err;
  ASSERT_EQ(odometry("drive").exit_code, 0);
  const auto truth = readKittiTrajectory(path("drive/poses.txt"));
  const auto estimate = readKittiTrajectory(path("drive_out/trajectory_kitti.txt"));
  ASSERT_EQ(truth.size(), 30u);
  ASSERT_EQ(estimate.size(), truth.size());
  EXPECT_GT(truth.back().translation().norm(), 5.0);
  EXPECT_LT((truth.back().translation() - estimate.back().translation()).norm(), 0.15);
}

/// What must stand in the table's reasons or status.
const std::map<std::string, std::string> kTold = {{"blanked_sector", "SWEEP_INCOMPLETE"},
                                                  {"range_cap", "LOW_VISIBILITY"},
                                                  {"frozen_cloud", "FROZEN_CLOUD"},
                                                  {"half_sweep", "SWEEP_INCOMPLETE"},
                                                  {"duplicated", "stamp_not_advancing"},
                                                  {"reordered", "stamp_not_advancing"},
                                                  {"stamp_jump", "TIME_JUMP"},
                                                  {"empty_cloud", "SWEEP_EMPTY"},
                                                  {"nan", "SWEEP_EMPTY"}};

TEST_F(SimulateDrive, EveryFaultLeavesARowForEachScanAndNoNan) {
  std::map<std::string, std::string> drives;
  for (const FaultTraits& traits : faultTraits()) {
    drives[traits.name] = std::string("--fault ") + traits.name + ":0.5:0.3";
  }
  drives["several"] = "--fault half_sweep:0.3 --fault noise:0.4:0.3 --fault reordered:0.5:0.2 --fault tilted_mount:0.6";
  drives["from_the_start"] = "--fault nan:0:0.3 --fault time_sign:0 --fault blanked_sector:0 --fault lost_rings:0";
  for (const auto& [name, faults] : drives) {
    ASSERT_EQ(simulate(name, "--duration 1 --start-speed 8 --no-traffic " + faults).exit_code, 0);
    const ToolRun run = odometry(name);
    ASSERT_EQ(run.exit_code, 0) << name << ": " << run.err;
    const std::size_t scans = lines(name + "/times.txt").size();
    EXPECT_EQ(scans, name == "dropped" ? 7u : name == "duplicated" ? 13u : 10u) << name;
    const std::string table = contentOf(path(name + "_out/per_sweep.csv"));
    const std::size_t refused = countOf(table, ",stamp_not_advancing,");
    const bool goes_back = name == "duplicated" || name == "reordered" || name == "stamp_jump" || name == "several";
    EXPECT_EQ(refused > 0, goes_back) << name;
    const std::size_t not_started = countOf(table, ",not_started,");
    EXPECT_EQ(not_started, name == "from_the_start" ? 4u : 0u)
        << name << ": without points, then a part of a revolution";
    EXPECT_EQ(readKittiTrajectory(path(name + "_out/trajectory_kitti.txt")).size(), scans - refused - not_started)
        << name;  // refuses NaN
    EXPECT_EQ(table.find("nan"), std::string::npos) << name;
    EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), scans + 1) << name;
    const auto told = kTold.find(name);
    if (told != kTold.end()) {
      EXPECT_NE(table.find(told->second), std::string::npos) << name;
    }
    fs::remove_all(path(name));
  }
}

TEST_F(SimulateDrive, BenchmarkHasARowForEachDriveAndTheirMean) {
  setenv("PATH", (fs::path(SIMULATE_DRIVE).parent_path().string() + ":" + getenv("PATH")).c_str(), 1);
  const auto benchmark = [this](const std::string& arguments) {
    return runProgram(SCRIPTS "/benchmark", "simulation --duration 3 --output '" + path("benchmark") + "' " + arguments,
                      folder_);
  };
  const ToolRun run = benchmark("--scenes country --seeds 2");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(countOf(run.out, "\n| "), 4u) << run.out;
  EXPECT_NE(run.out.find("| country, seed 2 | "), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("failed"), std::string::npos) << run.out;
  EXPECT_FALSE(fs::exists(folder_ / "benchmark/drives/country_2")) << "drives are not kept";
  EXPECT_EQ(benchmark("--scenes moon").exit_code, 1);
  EXPECT_EQ(benchmark("--seeds x").exit_code, 2);
}

TEST_F(SimulateDrive, StampJitterTableHasTheHeadOfItsPage) {
  setenv("PATH", (fs::path(SIMULATE_DRIVE).parent_path().string() + ":" + getenv("PATH")).c_str(), 1);
  const ToolRun run =
      runProgram(SCRIPTS "/stamp_jitter_table",
                 "--scenes town --jitter_ms 0 --seeds 11 --duration 5 --before '" OFFLINE_ODOMETRY "' --output '" +
                     path("jitter") + "'",
                 folder_);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string head = run.out.substr(0, run.out.find("| town |"));
  EXPECT_NE(contentOf(SCRIPTS "/../doc/stamps_and_starts.md").find("\n" + head), std::string::npos) << head;
  EXPECT_EQ(countOf(run.out, "| town | 0 |"), 1u) << run.out;
}

TEST_F(SimulateDrive, FaultMatrixTableIsDocumented) {
  const ToolRun run = runProgram(SCRIPTS "/fault_matrix", "--table", folder_);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string page =
      contentOf(fs::path(SCRIPTS "/fault_matrix").parent_path().parent_path() / "doc/reliability.md");
  EXPECT_NE(page.find("\n" + run.out), std::string::npos) << "doc/reliability.md: put there\n" << run.out;
  for (const FaultTraits& traits : faultTraits()) {
    EXPECT_EQ(countOf(run.out, std::string("| `") + traits.name + "` |"), 1u) << traits.name;
  }
}

TEST_F(SimulateDrive, FaultMatrixFailsWhatIsWrong) {
  // The tools as the matrix finds them: what they make, of a small lidar, is kept, and the next time taken from there.
  const fs::path bin = folder_ / "bin", kept = folder_ / "kept";
  fs::create_directories(bin);
  fs::create_directories(kept);
  const auto inPlaceOf = [&](const fs::path& tool, const std::string& more, const std::string& copy,
                             const std::string& then = "") {
    const fs::path script = bin / tool.filename();
    std::ofstream(script) << "#!/bin/sh\ntool='" + tool.string() + "' all='" + kept.string() + "' more='" + more +
                                 "' copy='" + copy + "'\n"
                          << R"(for word; do [ "$last" = --output ] && output=$word; last=$word; done
kept="$all/${output##*/}"
if ! [ -e "$kept" ]; then "$tool" "$@" $more || exit; $copy "$output" "$kept"; exit; fi
$copy "$kept" "$output" && cd "$output" || exit
)" << then;
    fs::permissions(script, fs::perms::owner_all);
  };
  inPlaceOf(SIMULATE_DRIVE, "--head vlp16", "cp -rl");
  inPlaceOf(OFFLINE_ODOMETRY, "", "cp -r");
  setenv("PATH", (bin.string() + ":" + getenv("PATH")).c_str(), 1);
  const auto matrix = [this](const std::string& arguments) {
    return runProgram(SCRIPTS "/fault_matrix", "-j 3 --output '" + path("matrix") + "' " + arguments, folder_);
  };
  const ToolRun run = matrix("--scenes town --faults empty_cloud");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("3 passed, 0 failed"), std::string::npos) << run.out;
  EXPECT_NE(contentOf(folder_ / "matrix/matrix.csv").find("SWEEP_EMPTY"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "matrix/town_empty_cloud_8_1")) << "drives are removed";

  inPlaceOf(OFFLINE_ODOMETRY, "", "cp -r", R"(case "$output" in
  *_0.2_run) echo 1,0,nan >> measurements.csv ;;
  *_1_run) sed -i 's/,FAIL[A-Z]*,/,OK,/' per_sweep.csv
    awk 'NR > 150 { $4 += 2 } { print }' trajectory_kitti.txt > moved && mv moved trajectory_kitti.txt ;;
  *_2_run) sed -i 's/SWEEP_EMPTY/TIME_JUMP/' per_sweep.csv ;;
esac
)");
  const ToolRun spoilt = matrix("--scenes town --faults empty_cloud");
  EXPECT_EQ(spoilt.exit_code, 1) << spoilt.out << spoilt.err;
  EXPECT_NE(spoilt.out.find("0 passed, 3 failed"), std::string::npos) << spoilt.out;
  for (const char* told : {"| not finite: measurements.csv |", "worst state not in FAILED to FAILED",
                           "sweeps OK and off by ", "m at the end", "| not told: SWEEP_EMPTY |"}) {
    EXPECT_NE(spoilt.out.find(told), std::string::npos) << told << " is not in\n" << spoilt.out;
  }
  EXPECT_EQ(matrix("--scenes town --faults nan --seed -1").exit_code, 1) << "no drive is made";
  EXPECT_EQ(matrix("--scenes moon --faults nan").exit_code, 2);
  EXPECT_EQ(matrix("--faults fog").exit_code, 2);
}

TEST_F(SimulateDrive, TheNextStepNamesTheSensorOfAnotherHead) {
  const auto nextOf = [this](const std::string& name, const std::string& arguments) {
    const std::string err = simulate(name, "--duration 0.1 " + arguments).err;
    const std::size_t at = err.find(" --output OUT");
    return at == std::string::npos ? err : err.substr(at);
  };
  EXPECT_EQ(nextOf("hdl64e", ""), " --output OUT\n");
  const std::string place = " --lidar-in-base -0.595,0,1.73,0,0,0\n";
  EXPECT_EQ(nextOf("vlp16", "--head vlp16"), " --output OUT --sensor velodyne" + place);
  EXPECT_EQ(nextOf("os1_64", "--head os1_64"), " --output OUT --sensor ouster" + place);
  EXPECT_EQ(nextOf("pandar64", "--head pandar64"), " --output OUT --sensor hesai" + place);
}

TEST_F(SimulateDrive, WithoutRollingShutterThereAreNoPointTimes) {
  const ToolRun run = simulate("drive", "--duration 0.2 --no-rolling-shutter");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find(" --output OUT --set sensor.timing.source=none\n"), std::string::npos) << run.err;
  EXPECT_FALSE(KittiDirectory::open(path("drive")).hasPointTimes());
}

TEST_F(SimulateDrive, AFolderThatIsNotEmptyIsRefused) {
  ASSERT_EQ(simulate("twice", "--duration 0.1").exit_code, 0);
  EXPECT_EQ(simulate("twice", "--duration 0.1").exit_code, 2);
  fs::create_directories(path("notes"));
  std::ofstream(path("notes/times.txt")) << "of the user\n";
  const ToolRun run = simulate("notes", "--duration 0.1");
  EXPECT_EQ(run.exit_code, 2);
  expectOneErrorLine(run, "simulate_drive", "notes: is not empty; remove it or give another folder");
  EXPECT_EQ(filesBelow(path("notes")), std::vector<std::string>{"times.txt"});
  EXPECT_EQ(lines("notes/times.txt"), std::vector<std::string>{"of the user"});
}

TEST_F(SimulateDrive, BadUseIsOneLineAndExitCode2) {
  for (const char* arguments :
       {"--scene moon", "--duration 0", "--duration nan", "--seed -1", "--fault fog", "--fault noise:1:1 --duration 1",
        "--threads 0", "--fault dropped:0:inf --duration 0.3", "--start-speed 100", "--speed -1", "--no-such"}) {
    const ToolRun run = simulate("bad", arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    fs::remove_all(path("bad"));
  }
  const ToolRun help = runProgram(SIMULATE_DRIVE, "--help", folder_);
  EXPECT_EQ(help.exit_code, 0);
  for (const FaultTraits& traits : faultTraits()) EXPECT_NE(help.out.find(traits.name), std::string::npos);
}

}  // namespace
}  // namespace fail_aware::simulate_drive_test
