// benchmark_odometry and scripts/benchmark on a made-up KITTI tree. Times are printed, not judged.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../support/synthetic_street.hpp"
#include "../support/tool_run.hpp"
#include "core/io/trajectory_io.hpp"

namespace fail_aware::benchmark_test {
namespace {

namespace fs = std::filesystem;

constexpr int kScansOfASequence = 12;
constexpr const char* kScript = SCRIPTS "/benchmark";

nlohmann::json readJson(const fs::path& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file);
}

class Benchmark : public ::testing::Test {
 protected:
  static ToolRun run(const char* program, const std::string& arguments) {
    return runProgram(program, arguments, root());
  }
  static void expectRefused(const ToolRun& outcome, const std::string& tool) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    expectOneErrorLine(outcome, tool);
  }
  static fs::path root() { return fs::path(::testing::TempDir()) / ("kitti_tree_" + std::to_string(getpid())); }

  // Sequences 04 (in the article) and 55 (not), both as KITTI distributes them; the street has no beam errors.
  static void SetUpTestSuite() {
    const synthetic::Street street;
    const synthetic::Drive drive;
    const synthetic::Lidar lidar;
    fs::create_directories(root() / "poses");
    for (const char* name : {"04", "55"}) {
      const fs::path sequence = root() / "sequences" / name;
      fs::create_directories(sequence / "velodyne");
      fs::create_directories(sequence / "stamps");
      std::ofstream(sequence / "calib.txt") << "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n";
      std::vector<Pose> truth;
      for (int i = 0; i < kScansOfASequence; ++i) {
        const double stamp_s = 0.1 * i;
        const Sweep sweep = street.scan([&](double t) { return drive.T_street_base(t); }, stamp_s,
                                        static_cast<std::uint32_t>(i), lidar);
        std::vector<std::array<float, 4>> points;
        std::vector<float> times_s;
        for (const Eigen::Vector3f& p : sweep.points_lidar) {
          points.push_back({p.x(), p.y(), p.z(), 0.5f});
          times_s.push_back(static_cast<float>((0.5 - std::atan2(p.y(), p.x()) / (2.0 * M_PI)) * lidar.period_s));
        }
        char number[16];
        std::snprintf(number, sizeof(number), "%06d", i);
        std::ofstream(sequence / "velodyne" / (std::string(number) + ".bin"), std::ios::binary)
            .write(reinterpret_cast<const char*>(points.data()), static_cast<std::streamsize>(points.size() * 16));
        std::ofstream(sequence / "stamps" / (std::string(number) + ".f32"), std::ios::binary)
            .write(reinterpret_cast<const char*>(times_s.data()), static_cast<std::streamsize>(times_s.size() * 4));
        truth.push_back((drive.T_street_base(0.0) * lidar.T_base_lidar).inverse() * drive.T_street_base(stamp_s) *
                        lidar.T_base_lidar);
      }
      writeKittiTrajectory((root() / "poses" / (std::string(name) + ".txt")).string(), truth);
    }
  }
  static void TearDownTestSuite() { fs::remove_all(root()); }
};

TEST_F(Benchmark, KittiScoresEverySequenceBesideTheArticle) {
  const fs::path output = root() / "out";
  const ToolRun outcome = run(kScript, "kitti " + root().string() +
                                           " --profile default --variants all,2measurements --set "
                                           "sensor.vertical_angle.angle_deg=0.0 --lengths 3,5 --step 1 --output " +
                                           output.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("| 04 | country | 12 |"), std::string::npos) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("0.98 % 0.0033"), std::string::npos) << "the article's figure";
  EXPECT_NE(outcome.out.find("| mean of 1 |"), std::string::npos) << "55 is not in the article";
  const nlohmann::json results = readJson(output / "results.json");
  for (const char* name : {"04", "55"}) {
    for (const char* variant : {"all", "2measurements"}) {
      EXPECT_LT(results["sequences"][name][variant]["t_err_percent"].get<double>(), 3.0) << name << ' ' << variant;
      EXPECT_EQ(results["sequences"][name][variant]["sweeps"].get<int>(), kScansOfASequence);
    }
  }
}

TEST_F(Benchmark, PageHasBothProfilesAndLeavesTheReadme) {
  const fs::path sequence = root() / "sequences/04", page = root() / "results.md";
  fs::copy_file(root() / "poses/04.txt", sequence / "poses.txt", fs::copy_options::overwrite_existing);
  const std::string readme = contentOf(SCRIPTS "/../README.md");
  const ToolRun outcome = run(kScript, "page " + sequence.string() + " --lengths 3,5 --step 1 --page " + page.string() +
                                           " --output " + (root() / "page").string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const nlohmann::json row = readJson(root() / "page/results.json")["sequences"]["04"];
  for (const char* profile : {"default", "paper"}) {
    char cell[64];
    std::snprintf(cell, sizeof(cell), "| %.2f %% %.4f (", row[profile]["t_err_percent"].get<double>(),
                  row[profile]["r_err_deg_per_m"].get<double>());
    EXPECT_NE(contentOf(page).find(cell), std::string::npos) << cell << contentOf(page);
  }
  EXPECT_NE(contentOf(page).find("scripts/benchmark page --lengths 3,5"), std::string::npos);
  EXPECT_EQ(contentOf(SCRIPTS "/../README.md"), readme) << "the page is somewhere else";
}

TEST_F(Benchmark, KittiGoesOnOverASequenceThatFails) {
  const ToolRun outcome =
      run(kScript, "kitti " + root().string() + " --profile default --variants all --set no.such.key=1 --output " +
                       (root() / "failed").string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("no.such.key"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("failed"), std::string::npos) << outcome.out;
}

TEST_F(Benchmark, BadInputIsRefusedInOneLine) {
  const std::string tree = root().string();
  const std::string output = " --output " + (root() / "refused").string();
  for (const std::string& arguments :
       {"kitti /does/not/exist" + output, "kitti " + tree + " --sequences 77" + output,
        "kitti " + tree + " --variants some" + output, "kitti " + tree + " -j 0", "parts " + tree + output,
        std::string("simulation --seeds x") + output, std::string("no_such_command"), std::string()}) {
    expectRefused(run(kScript, arguments), "benchmark");
  }
}

#ifdef BENCHMARK_ODOMETRY
TEST_F(Benchmark, BenchmarkOdometryPrintsBothAndTheirRatio) {
  const fs::path json = root() / "times.json";
  const ToolRun outcome =
      run(BENCHMARK_ODOMETRY, "--kitti " + (root() / "sequences/04").string() + " --count 6 --json " + json.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("ratio of the means"), std::string::npos);
  const nlohmann::json times = readJson(json);
  EXPECT_EQ(times["sweeps"].get<int>(), 6);
  EXPECT_EQ(times["quarters"].size(), 4u);
  EXPECT_DOUBLE_EQ(times["ratio_of_means"].get<double>(),
                   times["odometry"]["mean_ms"].get<double>() / times["pcl_icp"]["mean_ms"].get<double>());
}

TEST_F(Benchmark, BenchmarkOdometryRefusesBadInputInOneLine) {
  const ToolRun outcome = run(BENCHMARK_ODOMETRY, "--kitti /does/not/exist");
  expectRefused(outcome, "benchmark_odometry");
  const ToolRun unwritable =
      run(BENCHMARK_ODOMETRY, "--kitti " + (root() / "sequences/04").string() + " --count 2 --json " +
                                  (root() / "no/such/times.json").string());
  expectRefused(unwritable, "benchmark_odometry");
  EXPECT_EQ(unwritable.out, "") << "before the first sweep";
}
#endif

}  // namespace
}  // namespace fail_aware::benchmark_test
