// Runs the built tool on a made-up drive; OFFLINE_ODOMETRY is its path (compile definition).
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "../../src/tools/run_folder.hpp"
#include "../../src/tools/tool_support.hpp"
#include "../support/synthetic_street.hpp"
#include "../support/tool_run.hpp"
#include "../support/tum_trajectory.hpp"
#include "core/integrity/monitor_replay.hpp"
#include "core/io/input_error.hpp"
#include "core/io/monitor_log.hpp"
#include "core/io/trajectory_io.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"

namespace fail_aware::offline_odometry_test {
namespace {

namespace fs = std::filesystem;

constexpr int kScans = 10;
const synthetic::Drive kDrive;

using Row = std::map<std::string, std::string>;

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Without the verdict.
std::vector<std::string> warningsOf(const std::string& err) {
  std::vector<std::string> lines = linesOf(err);
  lines.erase(std::remove_if(lines.begin(), lines.end(),
                             [](const std::string& line) { return line.find(" warning: ") == std::string::npos; }),
              lines.end());
  return lines;
}

/// Without comments.
std::size_t rowsOf(const fs::path& path) {
  const std::vector<std::string> lines = linesOf(contentOf(path));
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [](const std::string& line) { return line.rfind("#", 0) != 0; }));
}

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<Row> readCsv(const fs::path& path) {
  const std::vector<std::string> lines = linesOf(contentOf(path));
  std::vector<Row> rows;
  if (lines.empty()) return rows;
  const std::vector<std::string> names = cellsOf(lines[0]);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = cellsOf(lines[i]);
    EXPECT_EQ(cells.size(), names.size()) << "row " << i;
    Row row;
    for (std::size_t k = 0; k < std::min(names.size(), cells.size()); ++k) row[names[k]] = cells[k];
    rows.push_back(row);
  }
  return rows;
}

class OfflineOdometry : public ::testing::Test {
 protected:
  static fs::path base() { return fs::path(::testing::TempDir()) / ("offline_odometry_" + std::to_string(getpid())); }

  static void SetUpTestSuite() {
    fs::remove_all(base());
    fs::create_directories(base() / "drive" / "velodyne");
    const synthetic::Street street;
    for (int i = 0; i < kScans; ++i) {
      const Sweep sweep =
          street.scan([](double t) { return kDrive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i));
      std::vector<std::array<float, 4>> points;
      for (const Eigen::Vector3f& p : sweep.points_lidar) points.push_back({p.x(), p.y(), p.z(), 0.5f});
      std::ofstream(scan(base() / "drive", i), std::ios::binary)
          .write(reinterpret_cast<const char*>(points.data()), static_cast<std::streamsize>(points.size() * 16));
    }
  }
  static void TearDownTestSuite() { fs::remove_all(base()); }

  void SetUp() override {
    const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = base() / name;
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  static fs::path scan(const fs::path& drive, int number) {
    char name[16];
    std::snprintf(name, sizeof(name), "%06d.bin", number);
    return drive / "velodyne" / name;
  }

  /// A copy of the drive, to spoil.
  fs::path copyOfDrive() const {
    fs::copy(base() / "drive", folder_ / "drive", fs::copy_options::recursive);
    return folder_ / "drive";
  }

  void runPlain(const std::string& arguments) { result_ = runProgram(OFFLINE_ODOMETRY, arguments, folder_); }

  /// With a smaller search for the first speed than usual: a quicker test.
  void run(const fs::path& drive, const std::string& more = "") {
    runPlain("--kitti '" + drive.string() + "' --output '" + (folder_ / "out").string() +
             "' --set registration.initialization.max_speed_mps=25"
             " --set registration.initialization.max_yaw_rate_rps=0.2 " +
             more);
  }

  fs::path out(const std::string& name) const { return folder_ / "out" / name; }
  nlohmann::json summary() const { return nlohmann::json::parse(contentOf(out("summary.json"))); }

  void expectRows(std::size_t rows, std::size_t without_pose = 0) const {
    EXPECT_EQ(rowsOf(out("trajectory_kitti.txt")), rows - without_pose);
    EXPECT_EQ(rowsOf(out("trajectory_tum.txt")), rows - without_pose);
    EXPECT_EQ(readCsv(out("per_sweep.csv")).size(), rows);
    EXPECT_EQ(summary()["sweeps"], rows);
  }

  void expectOneLine(const std::string& part) const { expectOneErrorLine(result_, "offline_odometry", part); }

  void expectRefused(const std::string& arguments, const std::string& part) {
    runPlain(arguments);
    EXPECT_EQ(result_.exit_code, 2) << arguments;
    EXPECT_EQ(result_.out, "") << arguments;
    expectOneLine(part);
  }

  fs::path folder_;
  ToolRun result_;
};

TEST_F(OfflineOdometry, WritesAllFilesOfADrive) {
  run(base() / "drive");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_TRUE(warningsOf(result_.err).empty()) << result_.err;
  const std::vector<std::string> verdict = linesOf(result_.err);
  ASSERT_EQ(verdict.size(), 2u) << result_.err;
  EXPECT_NE(verdict[0].find(std::to_string(kScans) + " sweeps, 0 without usable points, 0 refused; final state "),
            std::string::npos)
      << verdict[0];
  EXPECT_EQ(verdict[1], "offline_odometry: next: " + callOf("report") + " " + (folder_ / "out").string());
  expectRows(kScans);

  // 12 numbers a row, lidar frame, first pose identity, row by row where the lidar was
  const std::vector<Pose> lidar = readKittiTrajectory(out("trajectory_kitti.txt").string());
  ASSERT_EQ(lidar.size(), static_cast<std::size_t>(kScans));
  EXPECT_TRUE(lidar[0].isApprox(Pose::Identity(), 1e-9));
  const Pose T_base_lidar = synthetic::Lidar().T_base_lidar;
  for (int i = 0; i < kScans; ++i) {
    const Pose truth = T_base_lidar.inverse() * kDrive.T_odom_base(0.1 * i) * T_base_lidar;
    EXPECT_LT((lidar[static_cast<std::size_t>(i)].translation() - truth.translation()).norm(), 0.1) << i;
  }
  std::istringstream last_tum(linesOf(contentOf(out("trajectory_tum.txt"))).back());
  double stamp_s = 0.0, x_m = 0.0;
  last_tum >> stamp_s >> x_m;
  EXPECT_NEAR(stamp_s, 0.9, 1e-6);
  EXPECT_NEAR(x_m, kDrive.T_odom_base(0.9).translation().x(), 0.05) << "base_link";

  const nlohmann::json json = summary();
  EXPECT_EQ(nlohmann::json::parse(result_.out), json);
  EXPECT_EQ(json["dropped"], 0);
  EXPECT_TRUE(json["bad_scans"].empty());
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["profile"], "default");
  EXPECT_EQ(json["by_status"]["corrected"], kScans - 1);
  for (const char* key : {"mean_ms", "median_ms", "p95_ms", "p99_ms", "max_rss_mb"}) {
    ASSERT_TRUE(json[key].is_number()) << key;
    EXPECT_GT(json[key].get<double>(), 0.0) << key;
  }
  EXPECT_LE(json["median_ms"].get<double>(), json["p95_ms"].get<double>());
  EXPECT_LE(json["p95_ms"].get<double>(), json["p99_ms"].get<double>());
  const std::string parameters = contentOf(out("parameters.yaml"));
  EXPECT_NE(parameters.find("max_speed_mps: 25.0"), std::string::npos) << "the parameters used, --set included";
  EXPECT_NE(parameters.find("stamp_reference: \"mid\""), std::string::npos);
}

TEST_F(OfflineOdometry, ParameterFilesOverrideInOrder) {
  const auto file = [&](const char* name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return " --parameters '" + (folder_ / name).string() + "'";
  };
  const std::string first = file("first.yaml", "monitor:\n  drift:\n    scale_bias: 2.0e-4\n    map_length_m: 11.0\n");
  const std::string second =
      file("second.yaml", "monitor:\n  drift:\n    map_length_m: 12.0\n    transient_ratio: 0.25\n");
  run(base() / "drive", "--count 2" + first + second + " --set monitor.drift.transient_ratio=0.125");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  PipelineParameters used;
  loadYaml(out("parameters.yaml").string(), used);
  EXPECT_EQ(used.profile.monitor.drift.scale_bias, 2e-4);
  EXPECT_EQ(used.profile.monitor.drift.map_length_m, 12.0);
  EXPECT_EQ(used.profile.monitor.drift.transient_ratio, 0.125);
}

TEST_F(OfflineOdometry, AStartAfterTheDrivesEndIsSaid) {
  run(base() / "drive", "--count 2 --redundant-at 5");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("the drive ended before --redundant-at"), std::string::npos) << result_.err;
  EXPECT_TRUE(summary()["run"]["t1_stamp_s"].is_null());
  run(base() / "drive", "--count 2");
  EXPECT_EQ(result_.err.find("--redundant-at"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("no motion was observed"), std::string::npos) << result_.err;
}

TEST_F(OfflineOdometry, AMotionThatIsUnknownToTheEndIsTold) {
  const fs::path drive = copyOfDrive();
  for (int number = 2; number < kScans; ++number) fs::resize_file(scan(drive, number), 0);
  run(drive, "--redundant-at 0.45");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("the state is UNKNOWN (MOTION_UNKNOWN) to the end, for 5 sweeps: no motion was observed"),
            std::string::npos)
      << result_.err;
}

TEST_F(OfflineOdometry, APoseThatIsSetBeginsT1AnewAndIsNoDistance) {
  std::ofstream(folder_ / "set.csv")
      << "stamp,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z,sigma_roll,sigma_pitch,sigma_yaw\n"
         "0.5,1000,0,0,0,0,0,1,0.1,0.1,0.1,0.01,0.01,0.01\n";
  run(base() / "drive", "--set-pose '" + (folder_ / "set.csv").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NEAR(readTumTrajectory(out("trajectory_tum.txt").string()).back().T.translation().x(), 1005.6, 1.0);
  EXPECT_NEAR(summary()["distance_m"].get<double>(), 12.6, 1.6) << "all but the step of the sweep at which it was set";
  EXPECT_NEAR(summary()["run"]["t1_stamp_s"].get<double>(), 0.5, 0.11);
}

TEST_F(OfflineOdometry, PerSweepHasItsColumnsAndNumbersOnly) {
  run(base() / "drive", "--redundant-at 0.45");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const std::vector<Row> rows = readCsv(out("per_sweep.csv"));
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(kScans));
  const std::vector<std::string> numbers = {"stamp",
                                            "time_to_failure",
                                            "time_to_failure_indicator",
                                            "time_to_failure_covariance",
                                            "eta",
                                            "eta_rate",
                                            "sigma_yaw",
                                            "sigma_x",
                                            "sigma_y",
                                            "protection_level",
                                            "weight_icp_point_to_point",
                                            "weight_icp_point_to_plane",
                                            "weight_corner_svd",
                                            "nis_icp_point_to_point",
                                            "nis_icp_point_to_plane",
                                            "nis_corner_svd",
                                            "ms_total",
                                            "ms_icp_point_to_point",
                                            "ms_icp_point_to_plane",
                                            "ms_corner_svd",
                                            "cov_xx",
                                            "cov_xy",
                                            "cov_yy",
                                            "cov_zz",
                                            "cov_yaw",
                                            "speed_mps",
                                            "yaw_rate_rps"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row row = rows[i];
    for (const std::string& name : numbers) {
      ASSERT_EQ(row.count(name), 1u) << name;
      char* end = nullptr;
      const double value = std::strtod(row[name].c_str(), &end);
      EXPECT_TRUE(std::isfinite(value) && !row[name].empty() && *end == '\0') << name << " = " << row[name];
    }
    for (const auto& [name, cell] : row) {
      EXPECT_EQ(cell.find("nan"), std::string::npos) << name;
      EXPECT_EQ(cell.find("inf"), std::string::npos) << name;
    }
    EXPECT_NEAR(std::stod(row["stamp"]), 0.1 * static_cast<double>(i), 1e-9);
    EXPECT_EQ(row["status"], i == 0 ? "first" : "corrected");

    // t1 is the first sweep that is 0.45 s or more after the first
    const bool serving = i >= 5;
    const double time_to_failure = std::stod(row["time_to_failure"]);
    EXPECT_EQ(row["state"] == "UNKNOWN", !serving) << i;
    EXPECT_EQ(time_to_failure == -1.0, !serving) << i;
    EXPECT_GE(time_to_failure, serving ? 0.0 : -1.0);
    EXPECT_EQ(std::stod(row["sigma_x"]) > 0.0, i > 5) << i;
    EXPECT_NEAR(std::sqrt(std::stod(row["cov_xx"])), std::stod(row["sigma_x"]), 1e-6) << i;
    EXPECT_NEAR(std::sqrt(std::stod(row["cov_yy"])), std::stod(row["sigma_y"]), 1e-6) << i;
  }
  EXPECT_NEAR(std::stod(rows.back().at("speed_mps")), kDrive.speed_mps, 1.0);
  const nlohmann::json described = summary()["run"];
  EXPECT_NEAR(described["t1_stamp_s"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(described["first"], 0);
  for (const char* key : {"eta_threshold_rad", "horizon_s", "alert_limit_m", "comfortable_deceleration_mps2",
                          "failing_s", "degraded_s"}) {
    EXPECT_GT(described[key].get<double>(), 0.0) << key;
  }
}

TEST_F(OfflineOdometry, GivesTheSameBytesForAnyNumberOfThreads) {
  run(base() / "drive", "--threads 1");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(summary()["threads"], 1);
  const std::string kitti = contentOf(out("trajectory_kitti.txt")), tum = contentOf(out("trajectory_tum.txt"));
  run(base() / "drive", "--threads 2");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(summary()["threads"], 2);
  EXPECT_EQ(contentOf(out("trajectory_kitti.txt")), kitti);
  EXPECT_EQ(contentOf(out("trajectory_tum.txt")), tum);
}

TEST_F(OfflineOdometry, MonitorLogReplaysExactly) {
  run(base() / "drive");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const std::vector<MonitorInput> log = readMonitorLog(out("monitor_log.csv").string());
  ASSERT_EQ(log.size(), static_cast<std::size_t>(kScans));
  for (const std::string start : {"0", "0.3", "0.45", "5"}) {
    run(base() / "drive", "--redundant-at " + start);
    ASSERT_EQ(result_.exit_code, 0) << result_.err;
    const std::vector<Row> rows = readCsv(out("per_sweep.csv"));
    const std::vector<MonitorOutput> outputs = replayMonitor(log, std::stod(start), MonitorParameters());
    ASSERT_EQ(outputs.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Row row = rows[i];
      const MonitorOutput& m = outputs[i];
      EXPECT_EQ(row["state"], toString(m.state)) << start << ", sweep " << i;
      EXPECT_EQ(row["reasons"], reasonText(m.reasons)) << start << ", sweep " << i;
      const auto expectSame = [&](const char* name, double value) {
        EXPECT_NEAR(std::stod(row[name]), value, 1e-8 * (1.0 + std::abs(value))) << name << ", " << start << ", " << i;
      };
      expectSame("time_to_failure", m.time_to_failure.seconds);
      expectSame("time_to_failure_indicator", m.time_to_failure_indicator.seconds);
      expectSame("time_to_failure_covariance", m.time_to_failure_covariance.seconds);
      expectSame("eta", m.eta);
      expectSame("sigma_x", m.sigma_x_m);
      expectSame("sigma_y", m.sigma_y_m);
      expectSame("protection_level", m.protection_level_m);
    }
  }
}

TEST_F(OfflineOdometry, RefusedSweepsAreToldAndHaveNoPose) {
  const fs::path drive = copyOfDrive();
  std::ofstream times(drive / "times.txt");
  for (int i = 0; i < kScans; ++i) times << (i == 4 ? 0.3 : i == 7 ? 0.55 : 0.1 * i) << "\n";
  times.close();
  run(drive);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  expectRows(kScans, 2);
  EXPECT_EQ(summary()["run"]["scans"], kScans);
  EXPECT_EQ(summary()["run"]["without_pose"], nlohmann::json({4, 7}));
  const std::vector<StampedPose> tum = readTumTrajectory(out("trajectory_tum.txt").string());
  const std::vector<Pose> lidar = readKittiTrajectory(out("trajectory_kitti.txt").string());
  std::size_t row = 0;
  for (const int scan : {0, 1, 2, 3, 5, 6, 8, 9}) {
    EXPECT_NEAR(tum.at(row).stamp_s, 0.1 * scan, 1e-9);
    EXPECT_NEAR(tum[row].T.translation().x(), 1.4 * scan, 0.1);
    EXPECT_NEAR(lidar.at(row).translation().x(), 1.4 * scan, 0.15);
    ++row;
  }
  EXPECT_EQ(summary()["by_status"]["stamp_not_advancing"], 2);
  EXPECT_EQ(result_.err.rfind("offline_odometry: warning: the stamps of 2 of 10 sweeps were refused", 0), 0u)
      << result_.err;
  EXPECT_NE(result_.err.find("stamp_not_advancing in per_sweep.csv"), std::string::npos) << result_.err;
  EXPECT_EQ(warningsOf(result_.err).size(), 1u) << result_.err;
}

TEST_F(OfflineOdometry, TheFaultsOfAnEarlierRunAreSetAside) {
  fs::create_directories(folder_ / "out");
  const std::string faults = "kind,start_s,duration_s,severity\n";
  std::ofstream(out("faults.csv")) << faults;
  run(base() / "drive", "--count 2");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_FALSE(fs::exists(out("faults.csv")));
  EXPECT_EQ(contentOf(out("faults_of_earlier_run.csv")), faults);
  EXPECT_NE(result_.err.find("warning: " + out("faults.csv").string() + " is of an earlier run"), std::string::npos)
      << result_.err;
}

TEST_F(OfflineOdometry, InterruptedRunKeepsOlderResults) {
  run(base() / "drive", "--count 3");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  std::map<std::string, std::string> before;
  for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
    before[entry.path().filename().string()] = contentOf(entry.path());
  }
  EXPECT_EQ(before.size(), 7u) << "nothing else is left";
  EXPECT_NO_THROW(readRunSummary(folder_ / "out"));

  // Cut off by a limit on the size of files, in the middle of the sweeps.
  const std::string command = "bash -c 'ulimit -f 16; trap \"\" XFSZ; exec \"" + std::string(OFFLINE_ODOMETRY) +
                              "\" --kitti " + (base() / "drive").string() + " --output " + (folder_ / "out").string() +
                              "'";
  const ToolRun cut = runProgram("env", command, folder_);
  EXPECT_EQ(cut.exit_code, 1) << cut.out << cut.err;
  for (const auto& [name, text] : before) EXPECT_EQ(contentOf(out(name)), text) << name;
  EXPECT_THROW(readRunSummary(folder_ / "out"), InputError);

  run(base() / "drive", "--count 4");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NO_THROW(readRunSummary(folder_ / "out"));
  EXPECT_NE(contentOf(out("summary.json")), before["summary.json"]);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), fs::directory_iterator()), 7)
      << "and it is cleaned up";
}

TEST_F(OfflineOdometry, APlaceholderForTheLidarsPlaceIsTold) {
  const std::string placeholder = "lidar_in_base is the placeholder of the shipped sensor files";
  run(base() / "drive", "--count 2 --sensor velodyne");
  EXPECT_EQ(countOf(result_.err, placeholder), 1u) << result_.err;
  run(base() / "drive", "--count 2 --sensor velodyne --lidar-in-base 0.1,0,1.9,0,0,0");
  EXPECT_EQ(countOf(result_.err, placeholder), 0u) << result_.err;
  run(base() / "drive", "--count 2");
  EXPECT_EQ(countOf(result_.err, placeholder), 0u) << result_.err;
}

TEST_F(OfflineOdometry, TakesTheLidarsPlaceFromTheCommandLine) {
  run(base() / "drive", "--count 2 --lidar-in-base -0.5,0.25,1.5,0.01,-0.02,0.03");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(contentOf(out("parameters.yaml")).find("lidar_in_base: [-0.5, 0.25, 1.5, 0.01, -0.02, 0.03]"),
            std::string::npos);
  run(base() / "drive", "--count 2 --lidar-in-base -0.5 0.25 1.5 0 0 0");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(contentOf(out("parameters.yaml")).find("lidar_in_base: [-0.5, 0.25, 1.5, 0.0, 0.0, 0.0]"),
            std::string::npos);
  fs::remove_all(folder_ / "out");
  const std::string good =
      "--kitti '" + (base() / "drive").string() + "' --output '" + (folder_ / "out").string() + "' ";
  expectRefused(good + "--lidar-in-base 1,2,3", "--lidar-in-base: must be 6");
  expectRefused(good + "--lidar-in-base 1,2,3,0,0,180", "--lidar-in-base");
  expectRefused(good + "--lidar-in-base here", "--lidar-in-base");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(OfflineOdometry, NamesTheFirstFiveBadScans) {
  const fs::path drive = copyOfDrive();
  for (int number = 3; number < 10; ++number) fs::resize_file(scan(drive, number), 0);
  run(drive);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(summary()["bad_scans"].size(), 7u);
  const std::vector<std::string> warnings = warningsOf(result_.err);
  ASSERT_GE(warnings.size(), 6u) << result_.err;
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NE(warnings[i].find("empty file; carried on"), std::string::npos) << warnings[i];
  }
  EXPECT_NE(warnings[5].find("2 more such scans"), std::string::npos) << warnings[5];
}

TEST_F(OfflineOdometry, GoesOnOverScansThatCannotBeUsed) {
  const fs::path drive = copyOfDrive();
  fs::resize_file(scan(drive, 3), fs::file_size(scan(drive, 3)) - 7);
  fs::resize_file(scan(drive, 5), 0);
  std::vector<float> nan(4 * 2000, std::numeric_limits<float>::quiet_NaN());
  std::ofstream(scan(drive, 6), std::ios::binary)
      .write(reinterpret_cast<const char*>(nan.data()), static_cast<std::streamsize>(nan.size() * sizeof(float)));
  fs::remove(scan(drive, 8));
  fs::create_directory(scan(drive, 8));  // cannot be read, root or not
  run(drive);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  expectRows(kScans);

  const nlohmann::json json = summary();
  EXPECT_EQ(json["dropped"], 4);
  EXPECT_EQ(json["by_status"]["predicted"], 4);
  ASSERT_EQ(json["bad_scans"].size(), 4u);
  EXPECT_NE(result_.err.find("10 sweeps, 4 without usable points, 0 refused"), std::string::npos) << result_.err;
  const std::vector<std::string> warnings = warningsOf(result_.err);
  ASSERT_EQ(warnings.size(), 4u) << result_.err;
  const std::vector<Row> rows = readCsv(out("per_sweep.csv"));
  std::size_t k = 0;
  for (const int number : {3, 5, 6, 8}) {
    const std::string file = scan(drive, number).string();
    EXPECT_EQ(json["bad_scans"][k]["file"], file);
    EXPECT_NE(json["bad_scans"][k]["reason"].get<std::string>().find(file), std::string::npos);
    EXPECT_NE(warnings[k].find(file), std::string::npos) << warnings[k];
    Row row = rows[static_cast<std::size_t>(number)];
    EXPECT_EQ(row["status"], "predicted") << number;
    EXPECT_NE(row["reasons"].find("SWEEP_EMPTY"), std::string::npos) << row["reasons"];
    ++k;
  }
  const std::vector<Pose> lidar = readKittiTrajectory(out("trajectory_kitti.txt").string());
  EXPECT_NEAR(lidar.back().translation().x(), 12.6, 0.2);
}

TEST_F(OfflineOdometry, SweepsWithoutTheirRingsAreCounted) {
  const fs::path drive = copyOfDrive();
  fs::create_directory(drive / "rings");
  for (int number = 0; number < kScans; ++number) {
    if (number == 3 || number == 6) continue;
    std::ofstream(drive / "rings" / (scan(drive, number).stem().string() + ".u16"), std::ios::binary)
        << std::string(fs::file_size(scan(drive, number)) / 8, '\0');
  }
  run(drive);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const std::vector<std::string> warnings = warningsOf(result_.err);
  ASSERT_EQ(warnings.size(), 1u) << result_.err;
  EXPECT_NE(warnings[0].find("in 2 of 10 sweeps the file of the points' times or rings is not used, first "),
            std::string::npos);
  EXPECT_NE(warnings[0].find("000003.u16: missing or cannot be read; 0 timed as those before"), std::string::npos);
}

TEST_F(OfflineOdometry, NamesNeedNotBeUtf8) {
  const fs::path drive = folder_ /
                         "stra\xdf"
                         "e";
  fs::create_directories(drive / "velodyne");
  for (int i = 0; i < 2; ++i) fs::copy_file(scan(base() / "drive", i), scan(drive, i));
  std::ofstream(scan(drive, 2)).close();
  run(drive);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(summary()["dropped"], 1);
}

TEST_F(OfflineOdometry, AGapInTheNumbersIsAGapInTime) {
  const fs::path drive = copyOfDrive();
  fs::remove(scan(drive, 4));
  fs::remove(scan(drive, 7));
  run(drive);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_TRUE(warningsOf(result_.err).empty()) << result_.err;
  expectRows(kScans - 2);
  EXPECT_EQ(summary()["dropped"], 0);
  const std::vector<Pose> lidar = readKittiTrajectory(out("trajectory_kitti.txt").string());
  EXPECT_NEAR((lidar[4].translation() - lidar[3].translation()).norm(), 2.8, 0.1) << "0.2 s at 14 m/s";
  EXPECT_NEAR(lidar.back().translation().x(), 12.6, 0.2);
}

TEST_F(OfflineOdometry, RunsPartOfADrive) {
  run(base() / "drive", "--first 3 --count 4");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  expectRows(4);
  EXPECT_TRUE(readKittiTrajectory(out("trajectory_kitti.txt").string())[0].isApprox(Pose::Identity(), 1e-9));
  EXPECT_NEAR(std::stod(readCsv(out("per_sweep.csv"))[0]["stamp"]), 0.3, 1e-9);
  run(base() / "drive", "--first 8 --count 9223372036854775807");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  expectRows(2);
}

TEST_F(OfflineOdometry, RunsThePaperProfile) {
  run(base() / "drive", "--profile paper --count 5");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(summary()["profile"], "paper");
  expectRows(5);
}

TEST_F(OfflineOdometry, FailsWhenNoScanCanBeUsed) {
  const fs::path drive = folder_ / "drive";
  fs::create_directories(drive / "velodyne");
  for (int i = 0; i < 3; ++i) std::ofstream(scan(drive, i)).close();
  run(drive);
  EXPECT_EQ(result_.exit_code, 1);
  EXPECT_NE(result_.err.find("no scan of " + drive.string() + " could be used"), std::string::npos) << result_.err;
  expectRows(3, 3);
}

TEST_F(OfflineOdometry, SaysWhatASweepOfOnePointLacks) {
  const fs::path drive = folder_ / "drive";
  fs::create_directories(drive / "velodyne");
  const float point[] = {5.0f, 1.0f, 0.0f, 0.0f};
  for (int i = 0; i < 3; ++i)
    std::ofstream(scan(drive, i), std::ios::binary).write(reinterpret_cast<const char*>(point), sizeof(point));
  run(drive);
  EXPECT_EQ(result_.exit_code, 1);
  for (const char* key : {"registration.cloud.min_points", "sensor.check.min_azimuth_coverage"})
    EXPECT_NE(result_.err.find(key), std::string::npos) << result_.err;
}

TEST_F(OfflineOdometry, PointsInDoublePrecisionAreTold) {
  const fs::path drive = folder_ / "drive";
  fs::create_directories(drive / "velodyne");
  for (int i = 0; i < 2; ++i) {
    std::vector<double> values;
    for (int k = 0; k < 4000; ++k) values.push_back(k % 4 == 3 ? 0.5 : 5.0 + 0.01 * k);
    std::ofstream(scan(drive, i), std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(double)));
  }
  run(drive);
  EXPECT_EQ(result_.exit_code, 1);
  EXPECT_NE(result_.err.find("a point must be x, y, z, intensity as float32, in m"), std::string::npos) << result_.err;
  EXPECT_EQ(result_.err.find("min_azimuth_coverage"), std::string::npos) << result_.err;
}

TEST_F(OfflineOdometry, UnusableInputIsRefusedInOneLine) {
  const std::string drive = (base() / "drive").string(), output = (folder_ / "out").string();
  const std::string good = "--kitti '" + drive + "' --output '" + output + "' ";
  expectRefused("--output '" + output + "'", "--kitti");
  expectRefused("--kitti '" + drive + "'", "--output");
  expectRefused("--kitti '" + drive + "' --outptu '" + output + "'", "--outptu (see --help)");
#ifndef FAIL_AWARE_WITH_BAGS
  expectRefused("--bag drive.bag --output '" + output + "'", "this build has no ROS and reads no bags; give");
#endif
  expectRefused("--kitti /no/such/drive --output '" + output + "'", "/no/such/drive");
  fs::create_directories(folder_ / "bare" / "velodyne");
  expectRefused("--kitti '" + (folder_ / "bare").string() + "' --output '" + output + "'", "no scans");
  const std::string a_file = scan(base() / "drive", 0).string();
  expectRefused("--kitti '" + a_file + "' --output '" + output + "'", a_file + ": is a file; a folder");

  expectRefused(good + "--set fusion.gate_sigmas=2.5", "fusion.gate_sigmas: unknown parameter");
  expectRefused(good + "--set fusion.gate_sigma=-2.5", "fusion.gate_sigma = -2.5");
  expectRefused(good + "--set registration.icp_point_to_plane.observability.min_information_ratio=2",
                "registration.icp_point_to_plane.observability.min_information_ratio = 2");
  expectRefused(good + "--set fusion.gate_sigma=wide", "fusion.gate_sigma: must be a number");
  expectRefused(good + "--set fusion.gate_sigma", "key=value");
  std::ofstream(folder_ / "wrong.yaml") << "fusion:\n  gate_sigmas: 2.5\n";
  expectRefused(good + "--parameters '" + (folder_ / "wrong.yaml").string() + "'", "wrong.yaml:2: fusion.gate_sigmas");
  expectRefused(good + "--parameters /no/such.yaml", "/no/such.yaml");
  expectRefused(good + "--profile papre", "papre");
  expectRefused(good + "--vehicle golf", "golf");
  expectRefused(good + "--sensor vlp", "vlp");
  expectRefused(good + "--cfg /no/such/cfg", "/no/such/cfg");
  expectRefused(good + "--threads 0", "--threads");
  expectRefused(good + "--threads many", "--threads");
  expectRefused(good + "--first 10", "--first 10");
  expectRefused(good + "--first -5", "--first: '-5' is not a whole number from 0 on");
  expectRefused(good + "--count 0", "--count: '0' is not a whole number from 1 on");
  expectRefused(good + "--redundant-at -1", "--redundant-at: '-1' is not a number from 0 on");
  expectRefused(good + "--redundant-at nan", "--redundant-at");
  expectRefused(good + "--nonsense", "--nonsense");
  EXPECT_FALSE(fs::exists(output)) << "nothing is made before everything is known to be good";
}

TEST_F(OfflineOdometry, StampsThatAreNotInSecondsAreRefused) {
  const fs::path drive = copyOfDrive();
  const std::string arguments = "--kitti '" + drive.string() + "' --output '" + (folder_ / "out").string() + "'";
  const auto writeTimes = [&](const std::string& step) {
    std::ofstream times(drive / "times.txt");
    for (int i = 0; i < kScans; ++i) times << 170 + i << step << "\n";
  };
  writeTimes("00");
  expectRefused(arguments,
                "times.txt: the stamps are 100 apart (median), so they are probably in milliseconds; "
                "seconds are needed: divide them by 1000");
  writeTimes("00000.5");
  expectRefused(arguments, "probably in microseconds; seconds are needed: divide them by 1000000");
  writeTimes("00000000");
  expectRefused(arguments, "probably in nanoseconds; seconds are needed: divide them by 1000000000");
  writeTimes("");
  run(drive);
  EXPECT_EQ(result_.exit_code, 0) << "a step of 1 s is one of seconds: " << result_.err;
}

TEST_F(OfflineOdometry, PointsInMillimetresAreTold) {
  const fs::path drive = copyOfDrive();
  for (int i = 0; i < kScans; ++i) {
    const std::string bytes = contentOf(scan(drive, i));
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    for (float& value : values) value *= 1000.0f;
    std::ofstream(scan(drive, i), std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(bytes.size()));
  }
  run(drive);
  EXPECT_EQ(result_.exit_code, 1);
  EXPECT_NE(result_.err.find("so their coordinates are probably in millimetres; metres are needed"), std::string::npos)
      << result_.err;
  EXPECT_NE(result_.err.find("10 sweeps without usable points"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("no scan of " + drive.string() + " could be used"), std::string::npos) << result_.err;
}

TEST_F(OfflineOdometry, ExternalPosesThatTheFusionRefusesAreTold) {
  const std::string columns = "stamp,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z,sigma_roll,sigma_pitch,sigma_yaw\n";
  std::ofstream gps(folder_ / "gps.csv"), other_frame(folder_ / "other_frame.csv");
  gps << columns;
  other_frame << columns;
  for (int i = 0; i < kScans; ++i) {
    const Eigen::Vector3d at = kDrive.T_odom_base(0.1 * i).translation();
    const auto write = [&](std::ofstream& file, double offset_m) {
      file << 0.1 * i << ',' << at.x() + offset_m << ',' << at.y() << ',' << at.z() << ",0,0,0,1,0.5,0.5,0.5,0,0,0\n";
    };
    write(gps, 0.0);
    write(other_frame, 5000.0);
  }
  gps.close();
  other_frame.close();
  run(base() / "drive", "--external-poses '" + (folder_ / "gps.csv").string() + "' --external-poses '" +
                            (folder_ / "other_frame.csv").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("warning: other_frame: "), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find(" poses were not used; first at stamp "), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("beyond fusion.gate_sigma: check its frame"), std::string::npos) << result_.err;
  EXPECT_EQ(result_.err.find("warning: gps: "), std::string::npos) << result_.err;
}

TEST_F(OfflineOdometry, ExternalPosesOfAnotherTimeAreTold) {
  const std::string columns = "stamp,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z,sigma_roll,sigma_pitch,sigma_yaw\n";
  const fs::path late = folder_ / "late.csv", empty = folder_ / "empty.csv";
  std::ofstream(late) << columns << "70,0,0,0,0,0,0,1,1,1,1,0,0,0\n80,0,0,0,0,0,0,1,1,1,1,0,0,0\n";
  std::ofstream(empty) << columns;
  run(base() / "drive", "--count 3 --external-poses '" + late.string() + "' --external-poses '" + empty.string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find(late.string() + ": none of its poses has the stamp of a sweep; the stamps of the 2 poses "
                                             "are from 70.000000 to 80.000000 s, those of the sweeps are from "),
            std::string::npos)
      << result_.err;
  EXPECT_NE(result_.err.find(empty.string() + ": there is no pose in it"), std::string::npos) << result_.err;
}

TEST_F(OfflineOdometry, UnwritableOutputIsRefusedFirst) {
  const std::string drive = "--kitti '" + (base() / "drive").string() + "' ";
  const fs::path file = folder_ / "file";
  std::ofstream(file).close();
  expectRefused(drive + "--output '" + file.string() + "'", file.string());
  expectRefused(drive + "--output '" + (file / "deeper").string() + "'", file.string());
  for (const char* taken : {"per_sweep.csv", "monitor_log.csv", "measurements.csv", "trajectory_kitti.txt",
                            "trajectory_tum.txt", "summary.json", "parameters.yaml"}) {
    const fs::path output = folder_ / (std::string("out_") + taken);
    fs::create_directories(output / taken);  // a folder where the file belongs
    expectRefused(drive + "--output '" + output.string() + "' --count 2", taken);
  }
}

TEST_F(OfflineOdometry, HelpListsTheOptions) {
  runPlain("--help");
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_EQ(result_.err, "");
  for (const char* option : {"--kitti", "--output", "--profile", "--vehicle", "--sensor", "--cfg", "--parameters",
                             "--set", "--threads", "--first", "--count", "--redundant-at", "--lidar-in-base"}) {
    EXPECT_NE(result_.out.find(option), std::string::npos) << option;
  }
}

}  // namespace
}  // namespace fail_aware::offline_odometry_test
