// Runs scripts/report on made-up runs.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "../../src/tools/run_folder.hpp"
#include "../support/tool_run.hpp"

namespace fail_aware::report_test {
namespace {

namespace fs = std::filesystem;

constexpr int kSweeps = 60;
const std::vector<std::string> kPictures = {"trajectory", "error",   "indicator", "time_to_failure", "road_ahead",
                                            "timeline",   "weights", "nis",       "stage_times"};

/// A straight drive at 10 m/s whose odometry is 2 % too long: 0.6 m are passed 3 s after t1 = 1 s.
class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / ("report_" + std::to_string(getpid()) + "_" + name);
    fs::create_directories(folder_ / "run");
    write("run/per_sweep.csv", perSweep());
    std::ostringstream tum, truth;
    for (int i = 0; i < kSweeps; ++i) {
      tum << 0.1 * i << ' ' << 1.02 * i << " 0 0 0 0 0 1\n";
      truth << "1 0 0 " << i << " 0 1 0 0 0 0 1 0\n";
    }
    write("run/trajectory_tum.txt", tum.str());
    write("truth.txt", truth.str());
    seal(R"({"dropped": 2, "profile": "default", "run": {"first": 0, "t1_stamp_s": 1.0,
        "eta_threshold_rad": 0.001, "horizon_s": 60.0, "alert_limit_m": 0.6, "comfortable_deceleration_mps2": 2.0,
        "failing_s": 1.0, "degraded_s": 10.0,
        "lidar_in_base": [-0.5, 0, 1.7, 0, 0, 0]}})");
    write("faults.csv", "kind,start_s,duration_s,severity\nfog,2.0,1.5,0.5\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string perSweep() {
    std::ostringstream csv;
    csv << "stamp,status,state,reasons,time_to_failure,time_to_failure_indicator,time_to_failure_covariance,eta,eta_"
           "rate,"
           "sigma_yaw,sigma_x,sigma_y,weight_icp_point_to_point,weight_icp_point_to_plane,weight_corner_svd,nis_icp_"
           "point_to_point,nis_icp_point_to_plane,nis_corner_svd,nis_"
           "fused,"
           "ms_total,ms_correction,ms_icp_point_to_point,ms_icp_point_to_plane,ms_corner_svd,ms_fusion,ms_reference,"
           "icp_point_to_point_status,icp_point_to_plane_status,"
           "corner_svd_status,cov_xx,cov_xy,cov_yy,cov_zz,cov_yaw,min_information_ahead,information_ahead_distance_m\n";
    for (int i = 0; i < kSweeps; ++i) {
      const double since_t1_s = std::max(0.0, 0.1 * i - 1.0), left_s = i < 10 ? -1.0 : std::max(0.0, 3.0 - since_t1_s);
      csv << 0.1 * i << ',' << (i == 0 ? "first" : "corrected") << ','
          << (i < 10   ? "UNKNOWN"
              : i < 40 ? "FAILING"
                       : "FAILED")
          << ',' << (i > 30 ? "MISSING_CORNERS|ETA_THRESHOLD" : "") << ',' << left_s << ',' << left_s << ',' << left_s
          << ',' << 3e-4 * since_t1_s << ",3e-4," << 1e-4 * (1.0 + 0.1 * std::sin(i)) << ",0,0,0.9,0.8,"
          << (i % 3 ? 0.0 : 0.5) << ",5,6," << (i % 3 ? -1 : 4) << ",5,20,2,10,5,2,1,1,ok,ok,"
          << (i % 3 ? "too_few_corners" : "ok") << ',' << 1e-3 * since_t1_s << ",0," << 2e-3 * since_t1_s
          << ",1e-4,1e-6," << (i < 20 ? "1,0" : "0.001,40") << '\n';
    }
    return csv.str();
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  /// summary.json for the files as they are.
  void seal(const std::string& summary = R"({"run": {}})") const {
    std::vector<std::string> files;
    for (const char* name : {"per_sweep.csv", "trajectory_tum.txt"}) {
      if (fs::exists(folder_ / "run" / name)) files.emplace_back(name);
    }
    Json json = Json::parse(summary);
    sealRun(folder_ / "run", files, "r0123456789abcdef", json);
  }
  void writeSealed(const std::string& name, const std::string& text) const {
    write(name, text);
    seal();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void run(const std::string& arguments) { result_ = runProgram(SCRIPTS "/report", arguments, folder_); }

  std::string runForPage(const std::string& more) {
    run(path("run") + " --output " + path("page.html") + " " + more);
    EXPECT_EQ(result_.exit_code, 0) << result_.err;
    EXPECT_EQ(result_.err, "");
    EXPECT_EQ(result_.out, path("page.html") + "\n");
    return contentOf(folder_ / "page.html");
  }

  static std::string sectionOf(const std::string& page, const std::string& id) {
    const std::size_t begin = page.find("<section id=\"" + id + "\">");
    return begin == std::string::npos ? "" : page.substr(begin, page.find("</section>", begin) - begin);
  }

  /// All pictures but these, which say why they are not there.
  static void expectPictures(const std::string& page, const std::vector<std::string>& without, const std::string& why) {
    for (const std::string& id : kPictures) {
      const std::string section = sectionOf(page, id);
      const bool wanted = std::find(without.begin(), without.end(), id) == without.end();
      // a PNG of some size, in base64
      EXPECT_EQ(countOf(section, "src=\"data:image/png;base64,iVBORw0KGgo"), wanted ? 1u : 0u) << id;
      if (wanted) {
        EXPECT_GT(section.size(), 10000u) << id;
      } else {
        EXPECT_NE(section.find(why), std::string::npos) << section;
      }
    }
  }

  void expectRefused(const std::string& arguments, const std::string& part) {
    run(arguments);
    EXPECT_EQ(result_.exit_code, 2) << arguments << "\n" << result_.err;
    EXPECT_EQ(result_.err.rfind("report: error: ", 0), 0u) << result_.err;
    EXPECT_EQ(countOf(result_.err, "\n"), 1u) << result_.err;
    EXPECT_NE(result_.err.find(part), std::string::npos) << "'" << part << "' not in: " << result_.err;
  }

  fs::path folder_;
  ToolRun result_;
};

TEST_F(Report, HoldsAllPicturesAndTheTable) {
  const std::string page = runForPage("--ground-truth " + path("truth.txt") + " --faults " + path("faults.csv"));
  expectPictures(page, {}, "");
  EXPECT_EQ(page.find("No picture"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "self-contained";
  for (const char* cell : {"<td>5.9 s</td>", "<td>60, 2 dropped, 0 with a prediction only</td>", "<td>FAILED</td>",
                           "<td>1.0 s on</td>", "<td>3.1 s after t1</td>", "<td>3.1 s ahead</td>",
                           "0.98 m horizontal, +0.00 m vertical, +0.00 deg heading, over 49 m"}) {
    EXPECT_NE(page.find(cell), std::string::npos) << cell;
  }
}

TEST_F(Report, ComesOutWithoutTruth) {
  const std::string page = runForPage("");
  expectPictures(page, {"error"}, "no ground truth was given");
}

TEST_F(Report, ComesOutWithoutATrajectory) {
  fs::remove(folder_ / "run/trajectory_tum.txt");
  seal();
  const std::string page = runForPage("--ground-truth " + path("truth.txt"));
  expectPictures(page, {"trajectory", "error"}, "no trajectory");
}

TEST_F(Report, ComesOutOfASmallTable) {
  write("run/per_sweep.csv", "stamp,status\n0,first\n0.1,corrected\n0.2,corrected\n");
  fs::remove(folder_ / "run/trajectory_tum.txt");
  seal();
  expectPictures(runForPage(""), kPictures, "No picture");
}

TEST_F(Report, TruthMayBeLongerThanTheRunAndInTumRows) {
  std::ostringstream tum;  // 20 Hz, between the sweeps too
  for (int i = -10; i < 2 * kSweeps + 10; ++i) tum << 0.05 * i << ' ' << 0.5 * i << " 0 0 0 0 0 1\n";
  write("truth.tum", tum.str());
  const std::string page = runForPage("--ground-truth " + path("truth.tum"));
  expectPictures(page, {}, "");
  EXPECT_NE(page.find("0.98 m horizontal"), std::string::npos);
}

TEST_F(Report, WarnsOfATruthInTheCameraFrame) {
  std::ostringstream camera;  // x right, y down, z ahead
  for (int i = 0; i < kSweeps; ++i) camera << "1 0 0 0 0 1 0 0 0 0 1 " << i << "\n";
  write("camera.txt", camera.str());
  write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  const std::string arguments =
      path("run") + " --output " + path("page.html") + " --ground-truth " + path("camera.txt");
  run(arguments);
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_EQ(result_.err.rfind("report: warning: " + path("camera.txt") + " moves along its z axis", 0), 0u)
      << result_.err;
  EXPECT_EQ(countOf(result_.err, "\n"), 1u) << result_.err;
  const std::string page = runForPage("--ground-truth " + path("camera.txt") + " --calib " + path("calib.txt"));
  EXPECT_NE(page.find("0.98 m horizontal"), std::string::npos) << "as with the same truth in the lidar's frame";
}

TEST_F(Report, RefusesFilesOfTwoRunsAndAnUnfinishedOne) {
  write("run/trajectory_tum.txt", contentOf(folder_ / "run/trajectory_tum.txt") + "6.0 61.2 0 0 0 0 0 1\n");
  expectRefused(path("run"), "trajectory_tum.txt is not the file that run r0123456789abcdef of summary.json wrote");
  fs::remove(folder_ / "run/trajectory_tum.txt");
  expectRefused(path("run"), "trajectory_tum.txt is missing");
  seal();
  fs::create_directory(folder_ / "run/unfinished_r0123456789abcdef");
  expectRefused(path("run"), "did not finish");
  fs::remove(folder_ / "run/unfinished_r0123456789abcdef");
  write("run/summary.json", R"({"run": {"first": 0}})");
  expectRefused(path("run"), "run offline_odometry again");
  fs::remove(folder_ / "run/summary.json");
  expectRefused(path("run"), "not the folder of a finished run");
}

/// The sweep at 2.0 s comes again after the one at 2.1 s: it has no pose.
TEST_F(Report, ARefusedSweepDoesNotShiftTheTruth) {
  std::string table = perSweep();
  const std::size_t line = table.find("\n2,") + 1, next = table.find("\n2.2,");
  std::string refused = table.substr(line, table.find('\n', line) - line);
  refused.replace(refused.find("corrected"), 9, "stamp_not_advancing");
  table.insert(next, "\n" + refused);
  write("run/per_sweep.csv", table);
  std::istringstream rows(contentOf(folder_ / "truth.txt"));
  std::ostringstream truth;
  int i = 0;
  for (std::string row; std::getline(rows, row); ++i) {
    truth << row << "\n";
    if (i == 21) truth << "1 0 0 20 0 1 0 0 0 0 1 0\n";
  }
  write("truth.txt", truth.str());
  seal(R"({"run": {"first": 0, "t1_stamp_s": 1.0, "alert_limit_m": 0.6}})");
  EXPECT_NE(runForPage("--ground-truth " + path("truth.txt")).find("0.98 m horizontal"), std::string::npos);
}

TEST_F(Report, TextFilesOfWindowsAreRead) {
  const auto asOnWindows = [&](const std::string& name) {
    std::string text = "\xEF\xBB\xBF";
    for (const char c : contentOf(folder_ / name)) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    write(name, text);
  };
  asOnWindows("truth.txt");
  asOnWindows("faults.csv");
  const std::string page = runForPage("--ground-truth " + path("truth.txt") + " --faults " + path("faults.csv"));
  EXPECT_NE(page.find("0.98 m horizontal"), std::string::npos);
}

/// One row of 12 numbers.
std::vector<double> kittiRow(std::istream& file) {
  std::vector<double> row(12);
  for (double& number : row) file >> number;
  return row;
}

TEST_F(Report, MatchTruthMovesPosesToTheLidarAtItsStamps) {
  std::ostringstream ins;  // base_link looks along y and drives there, 1 m/s; poses lie between the sweeps
  for (int i = -1; i < 2 * kSweeps; ++i)
    ins << 0.05 * i + 0.02 << " 3 " << 0.05 * i + 0.02 << " 0 0 0 0.70710678118654752 0.70710678118654752\n";
  write("ins.txt", ins.str());
  const ToolRun done =
      runProgram(SCRIPTS "/match_truth",
                 path("run") + " --poses " + path("ins.txt") + " --output " + path("matched.txt"), folder_);
  ASSERT_EQ(done.exit_code, 0) << done.err;
  std::ifstream matched(path("matched.txt"));
  for (int i = 0; i < kSweeps; ++i) {
    const std::vector<double> row = kittiRow(matched);
    ASSERT_TRUE(matched) << i;
    EXPECT_NEAR(row[3], 3.0, 1e-6);
    EXPECT_NEAR(row[7], 0.1 * i - 0.5, 1e-6) << "lidar_in_base is 0.5 m behind and 1.7 m up";
    EXPECT_NEAR(row[11], 1.7, 1e-6);
    EXPECT_NEAR(row[4], 1.0, 1e-6);
  }
}

TEST_F(Report, MatchTruthRefusesQuaternionsThatBeginWithW) {
  const auto match = [this](double yaw_rad, bool w_first) {
    const double c = std::cos(0.5 * yaw_rad), s = std::sin(0.5 * yaw_rad);
    std::ostringstream ins;  // 10 m/s, as the run
    for (int i = 0; i < kSweeps; ++i) {
      ins << 0.1 * i << ' ' << i * std::cos(yaw_rad) << ' ' << i * std::sin(yaw_rad) << " 0 ";
      if (w_first) ins << c << " 0 0 " << s << '\n';
      if (!w_first) ins << "0 0 " << s << ' ' << c << '\n';
    }
    write("ins.txt", ins.str());
    return runProgram(SCRIPTS "/match_truth",
                      path("run") + " --poses " + path("ins.txt") + " --output " + path("matched.txt"), folder_);
  };
  for (const double yaw_rad : {0.1, 1.5, 3.1, -2.0}) {
    const ToolRun done = match(yaw_rad, true);
    EXPECT_EQ(done.exit_code, 2) << yaw_rad;
    expectOneErrorLine(done, "match_truth", "ins.txt: its quaternions are probably in the order w x y z");
    EXPECT_EQ(match(yaw_rad, false).exit_code, 0) << yaw_rad;
  }
}

TEST_F(Report, MatchTruthNamesSweepsWithoutAPose) {
  write("ins.txt", "0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n");
  const ToolRun done =
      runProgram(SCRIPTS "/match_truth",
                 path("run") + " --poses " + path("ins.txt") + " --output " + path("matched.txt"), folder_);
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_NE(done.err.find("no pose for 58 of 60 sweeps, the first at 0.200 s"), std::string::npos) << done.err;
  EXPECT_FALSE(fs::exists(path("matched.txt")));
}

TEST_F(Report, RefusesWhatItCannotUse) {
  const std::string run_folder = path("run"), truth = " --ground-truth ";
  expectRefused(path("absent"), "there is no");
  expectRefused(folder_.string(), "cannot read");
  if (std::system("/usr/bin/python3 -c 'import rosbag' 2>/dev/null") == 0) {  // a machine without ROS has none
    expectRefused(path("truth.txt"), "not a readable bag");
  }
  write("drive.db3", "SQLite format 3");
  expectRefused(path("drive.db3"), "is a ROS 2 bag (sqlite3)");
  expectRefused(run_folder + truth + path("absent"), "cannot read");
  write("short.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  expectRefused(run_folder + truth + path("short.txt"),
                "has 1 poses: the ground truth needs one for each of the run's 60 scans");
  write("words.txt", "one two three\n");
  expectRefused(run_folder + truth + path("words.txt"), "line 1 is not a row of numbers");
  write("nan.txt", "0 nan 0 0 0 0 0 1\n");
  expectRefused(run_folder + truth + path("nan.txt"), "not finite");
  write("other_day.txt", "1000 0 0 0 0 0 0 1\n1001 0 0 0 0 0 0 1\n");
  expectRefused(run_folder + truth + path("other_day.txt"), "no time in common");
  write("faults.csv", "when,what\n1,fog\n");
  expectRefused(run_folder + " --faults " + path("faults.csv"), "no column kind");
  expectRefused(run_folder + " --output " + path("absent/page.html"), "cannot write");
  write("run/summary.json", "{");
  expectRefused(run_folder, "is not JSON");
  writeSealed("run/trajectory_tum.txt", "0 0 0 0 0 0 0 1\n");
  expectRefused(run_folder, "has 1 rows");
  writeSealed("run/per_sweep.csv", "stamp,eta\n0,1,2\n");
  expectRefused(run_folder, "line 2 has 3 cells");
  writeSealed("run/per_sweep.csv", "stamp,eta\n0,high\n");
  expectRefused(run_folder, "column eta");
  writeSealed("run/per_sweep.csv", "stamp\n");
  expectRefused(run_folder, "no sweep");
  writeSealed("run/per_sweep.csv", "");
  expectRefused(run_folder, "no sweep");
}

TEST_F(Report, ExplainsItself) {
  run("--help");
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_NE(result_.out.find("--ground-truth"), std::string::npos);
  run("");
  EXPECT_EQ(result_.exit_code, 2);
}

}  // namespace
}  // namespace fail_aware::report_test
