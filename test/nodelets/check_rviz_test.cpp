// scripts/check_rviz over a made-up drive: rviz on a virtual display shows the shipped configuration with every status
// OK, and one that is wrong is told from it. Skipped where rviz, xvfb or imagemagick are missing.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "../support/synthetic_street.hpp"

namespace fail_aware::check_rviz_test {
namespace {

namespace fs = std::filesystem;

class CheckRviz : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"rviz", "xvfb-run", "import", "convert"}) {
      if (std::system((std::string("command -v ") + program + " > /dev/null").c_str()) != 0) {
        GTEST_SKIP() << "no " << program;
      }
    }
    std::string folder = (fs::temp_directory_path() / "check_rviz_XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
    fs::create_directories(folder_ / "velodyne");
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  void writeDrive(int sweeps) {
    const synthetic::Street street;
    const synthetic::Drive drive;
    for (int i = 0; i < sweeps; ++i) {
      const Sweep sweep =
          street.scan([&](double t) { return drive.T_street_base(t); }, 0.1 * i, static_cast<std::uint32_t>(i));
      char name[16];
      std::snprintf(name, sizeof name, "%06d.bin", i);
      std::ofstream file(folder_ / "velodyne" / name, std::ios::binary);
      for (const Eigen::Vector3f& p : sweep.points_lidar) {
        const float values[] = {p.x(), p.y(), p.z(), 0.5f};
        file.write(reinterpret_cast<const char*>(values), sizeof values);
      }
    }
  }

  int check(const std::string& arguments) {
    const std::string output = (folder_ / "output.txt").string();
    const int status =
        std::system((std::string(FAIL_AWARE_SOURCE_DIR) + "/scripts/check_rviz --kitti " + folder_.string() +
                     " --output " + (folder_ / "rviz.png").string() + " " + arguments + " > " + output + " 2>&1")
                        .c_str());
    std::stringstream text;
    text << std::ifstream(output).rdbuf();
    said_ = text.str();
    return WEXITSTATUS(status);
  }

  fs::path folder_;
  std::string said_;
};

TEST_F(CheckRviz, TheShippedConfigurationIsAllOk) {
  writeDrive(120);
  EXPECT_EQ(check("--count 30"), 0) << said_;
  EXPECT_TRUE(fs::exists(folder_ / "rviz.png"));
}

TEST_F(CheckRviz, AFrameThatNobodyPublishesIsSeen) {
  writeDrive(20);
  std::ifstream shipped(std::string(FAIL_AWARE_SOURCE_DIR) + "/rviz/odometry.rviz");
  std::ofstream wrong(folder_ / "wrong.rviz");
  for (std::string line; std::getline(shipped, line);) {
    wrong << (line == "    Fixed Frame: odom" ? "    Fixed Frame: nowhere" : line) << '\n';
  }
  wrong.close();
  EXPECT_EQ(check("--count 20 --config " + (folder_ / "wrong.rviz").string()), 1) << said_;
  EXPECT_NE(said_.find("to be seen"), std::string::npos) << said_;
}

TEST_F(CheckRviz, BadUsage) {
  EXPECT_EQ(check(""), 2);
  EXPECT_NE(said_.find("there are 0"), std::string::npos) << said_;
  EXPECT_EQ(check("--nonsense"), 2);
}

}  // namespace
}  // namespace fail_aware::check_rviz_test
