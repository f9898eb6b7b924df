// Runs the built tool; EVALUATE_TRAJECTORY is its path, SCRIPTS the folder of plot_trajectory (compile
// definitions).
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../../src/tools/run_folder.hpp"
#include "../support/tool_run.hpp"

namespace fail_aware::evaluate_trajectory_test {
namespace {

namespace fs = std::filesystem;

class EvaluateTrajectory : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string straight(const std::string& name, int poses, double step_m) const {
    std::ofstream file(folder_ / name);
    file.precision(15);
    for (int i = 0; i < poses; ++i) file << "1 0 0 " << i * step_m << " 0 1 0 0 0 0 1 0\n";
    return (folder_ / name).string();
  }

  void run(const std::string& arguments) { result_ = runProgram(EVALUATE_TRAJECTORY, arguments, folder_); }

  void expectRefused(const std::string& arguments, const std::string& reason) {
    run(arguments);
    EXPECT_EQ(result_.exit_code, 2) << arguments;
    EXPECT_EQ(result_.out, "");
    expectOneErrorLine(result_, "evaluate_trajectory", reason);
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("evaluate_trajectory_" + std::to_string(getpid()));
  ToolRun result_;
};

/// A folder as offline_odometry writes it: of each scan that the run accepted the pose, scans 1 m apart.
void writeRun(const fs::path& folder, std::size_t first, std::size_t scans, const std::vector<std::size_t>& refused,
              std::size_t drive_scans = 61) {
  fs::create_directories(folder);
  std::ofstream trajectory(folder / "trajectory_kitti.txt"), table(folder / "per_sweep.csv");
  table << "stamp,status\n";
  for (std::size_t i = 0; i < scans; ++i) {
    const bool is_refused = std::find(refused.begin(), refused.end(), i) != refused.end();
    table << 0.1 * static_cast<double>(i) << (is_refused ? ",stamp_not_advancing\n" : ",corrected\n");
    if (!is_refused) trajectory << "1 0 0 " << i << " 0 1 0 0 0 0 1 0\n";
  }
  trajectory.close();
  table.close();
  Json summary;
  summary["run"] = {{"first", first},
                    {"scans", scans},
                    {"drive_scans", drive_scans},
                    {"drive_begin_stamp_s", 0.0},
                    {"without_pose", refused}};
  sealRun(folder, {"trajectory_kitti.txt", "per_sweep.csv"}, "r0123456789abcdef", summary);
}

TEST_F(EvaluateTrajectory, ARunIsHeldAgainstTheTruthOfItsScans) {
  const std::string truth = straight("truth", 61, 1.0), estimate = (folder_ / "run/trajectory_kitti.txt").string();
  const std::string files = "--ground-truth " + truth + " --estimate " + estimate + " --alert-limit 0.5";
  const auto expectNoError = [&](std::size_t poses) {
    run(files);
    ASSERT_EQ(result_.exit_code, 0) << result_.err;
    const nlohmann::json json = nlohmann::json::parse(result_.out);
    EXPECT_EQ(json["poses"], poses);
    EXPECT_NEAR(json["ate_max_m"].get<double>(), 0.0, 1e-6);
    EXPECT_EQ(json["episodes"]["failed"], 0);
  };
  writeRun(folder_ / "run", 0, 61, {});
  expectNoError(61);
  writeRun(folder_ / "run", 0, 61, {5, 6, 30});
  expectNoError(58);
  writeRun(folder_ / "run", 4, 50, {1});
  expectNoError(49);
  writeRun(folder_ / "run", 4, 50, {}, 70);
  expectRefused(files, "do not belong together");

  writeRun(folder_ / "other", 0, 61, {7});
  writeRun(folder_ / "run", 0, 61, {5});
  fs::copy_file(folder_ / "other/trajectory_kitti.txt", estimate, fs::copy_options::overwrite_existing);
  expectRefused(files, "trajectory_kitti.txt: not the file that run r0123456789abcdef of summary.json wrote");
}

TEST_F(EvaluateTrajectory, ATruthThatIsNotInMetresIsTold) {
  run("--ground-truth " + straight("truth", 61, 1000.0) + " --estimate " + straight("estimate", 61, 1.0));
  EXPECT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("warning: the true poses reach 60000 m from the first one, the estimated 60 m: "),
            std::string::npos)
      << result_.err;
}

TEST_F(EvaluateTrajectory, ReportsTheMetricOfAOnePercentScaleError) {
  const std::string truth = straight("truth", 301, 1.0 + 1e-9),
                    estimate = straight("estimate", 301, 1.01 * (1.0 + 1e-9));
  run("--ground-truth " + truth + " --estimate " + estimate);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(result_.err.rfind("evaluate_trajectory: off by 1.00 % and 0.0000 deg/m over 300 m; ", 0), 0u)
      << result_.err;
  EXPECT_EQ(std::count(result_.err.begin(), result_.err.end(), '\n'), 2) << "verdict and next";
  const nlohmann::json json = nlohmann::json::parse(result_.out);
  EXPECT_NEAR(json["t_err_percent"].get<double>(), 1.0, 1e-6);
  EXPECT_NEAR(json["r_err_deg_per_m"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(json["segments"], 21 + 11 + 1);
  EXPECT_EQ(json["lengths_m"].size(), 8u);
  EXPECT_EQ(json["step"], 10);
  EXPECT_EQ(json["poses"], 301);
  EXPECT_NEAR(json["path_length_m"].get<double>(), 300.0, 1e-3);
  EXPECT_NEAR(json["ate_max_m"].get<double>(), 3.0, 1e-3);
  EXPECT_NEAR(json["ate_aligned_max_m"].get<double>(), 1.5, 1e-3);
  EXPECT_EQ(json["per_length"][0]["segments"], 21);
  EXPECT_TRUE(json["per_length"][7]["t_err_percent"].is_null());
  EXPECT_EQ(json["episodes"]["total"], 6);
  EXPECT_EQ(json["episodes"]["failed"], 5);  // 1 cm a step: 61 steps; the last begins 50 before the end
  EXPECT_NEAR(json["episodes"]["median_time_to_failure_s"].get<double>(), 6.05, 0.06);
}

TEST_F(EvaluateTrajectory, ShortRunsUseShortLengths) {
  const std::string files = "--ground-truth " + straight("truth", 51, 1.0) + " --estimate " + straight("est", 51, 1.0);
  run(files);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  nlohmann::json json = nlohmann::json::parse(result_.out);
  EXPECT_EQ(json["lengths_m"], (std::vector<double>{5, 10, 20, 40, 80}));
  EXPECT_EQ(json["step"], 1);
  EXPECT_EQ(json["segments"], 45 + 40 + 30 + 10);

  run(files + " --lengths 7,30 --step 5");
  json = nlohmann::json::parse(result_.out);
  EXPECT_EQ(json["lengths_m"], (std::vector<double>{7, 30}));
  EXPECT_EQ(json["step"], 5);

  run(files + " --lengths 100");
  json = nlohmann::json::parse(result_.out);
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_EQ(json["segments"], 0);
  EXPECT_TRUE(json["t_err_percent"].is_null());
}

TEST_F(EvaluateTrajectory, CalibrationAppliesToTheGroundTruth) {
  std::ofstream camera(folder_ / "camera");
  for (int i = 0; i < 31; ++i) camera << "1 0 0 0 0 1 0 0 0 0 1 " << i << '\n';
  camera.close();
  std::ofstream(folder_ / "calib.txt") << "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";
  run("--ground-truth " + (folder_ / "camera").string() + " --calib " + (folder_ / "calib.txt").string() +
      " --estimate " + straight("estimate", 31, 1.0));
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NEAR(nlohmann::json::parse(result_.out)["ate_max_m"].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(result_.err.find("--calib"), std::string::npos) << result_.err;

  run("--ground-truth " + (folder_ / "camera").string() + " --estimate " + straight("estimate", 31, 1.0));
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_NE(result_.err.find("camera moves along its z axis"), std::string::npos) << result_.err;
}

TEST_F(EvaluateTrajectory, UnusableInputIsRefusedInOneLine) {
  const std::string truth = straight("truth", 31, 1.0), shorter = straight("shorter", 30, 1.0);
  const std::string files = "--ground-truth " + truth + " --estimate " + truth;
  expectRefused("", "--ground-truth");
  expectRefused("--ground-truth " + truth + " --estimate " + shorter, "31 poses, estimate has 30");
  expectRefused("--ground-truth /no/such/file --estimate " + truth, "/no/such/file");
  std::ofstream(folder_ / "nan") << "1 0 0 nan 0 1 0 0 0 0 1 0\n";
  expectRefused("--ground-truth " + truth + " --estimate " + (folder_ / "nan").string(), "nan:1: 'nan' is not finite");
  expectRefused(files + " --step 0", "--step: '0' is not a whole number from 1 to 2147483647");
  expectRefused(files + " --step many", "--step");
  expectRefused(files + " --lengths 5,-1", "--lengths: '-1' is not a number above 0");
  expectRefused(files + " --alert-limit nan", "--alert-limit");
  expectRefused(files + " --period 0", "--period");
  expectRefused(files + " --nonsense", "--nonsense");
  expectRefused(files + " --calib " + truth, "Tr:");
  expectRefused(files + " --output " + truth, "truth");
}

TEST_F(EvaluateTrajectory, HelpListsTheOptions) {
  run("--help");
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_EQ(result_.err, "");
  for (const char* option : {"--ground-truth", "--estimate", "--calib", "--output", "--lengths", "--step"}) {
    EXPECT_NE(result_.out.find(option), std::string::npos) << option;
  }
}

TEST_F(EvaluateTrajectory, OutputHoldsTheSameJson) {
  const std::string files = "--ground-truth " + straight("truth", 31, 1.0) + " --estimate " + straight("est", 31, 1.1);
  const fs::path out = folder_ / "deep" / "out";
  run(files + " --output " + out.string());
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("plot_trajectory " + out.string()), std::string::npos) << result_.err;
  EXPECT_EQ(contentOf(out / "evaluation.json"), result_.out);
  const std::string csv = contentOf(out / "trajectory.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 32);
}

TEST_F(EvaluateTrajectory, PlotScriptDrawsTheOutput) {
  const std::string files = "--ground-truth " + straight("truth", 31, 1.0) + " --estimate " + straight("est", 31, 1.1);
  const fs::path out = folder_ / "out";
  run(files + " --output " + out.string());
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const ToolRun plots = runProgram(SCRIPTS "/plot_trajectory", "'" + out.string() + "'", folder_);
  if (plots.exit_code == 3) GTEST_SKIP() << plots.err;
  ASSERT_EQ(plots.exit_code, 0) << plots.err;
  for (const char* name : {"trajectory.png", "error_per_length.png", "position_error.png"}) {
    EXPECT_GT(fs::file_size(out / name), 1000u) << name;
  }
  const ToolRun nothing = runProgram(SCRIPTS "/plot_trajectory", "'" + folder_.string() + "'", folder_);
  EXPECT_EQ(nothing.exit_code, 2);
  expectOneErrorLine(nothing, "plot_trajectory", "evaluate_trajectory --output " + folder_.string());
}

}  // namespace
}  // namespace fail_aware::evaluate_trajectory_test
