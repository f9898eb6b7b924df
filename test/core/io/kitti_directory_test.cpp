#include "core/io/kitti_directory.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "core/estimation/sweep_clock.hpp"
#include "core/io/input_error.hpp"
#include "core/preprocessing/timing.hpp"

namespace fail_aware::kitti_directory_test {
namespace {

namespace fs = std::filesystem;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

class KittiDirectoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    const auto ticks = std::chrono::steady_clock::now().time_since_epoch().count();
    root_ = fs::temp_directory_path() / (std::string("kitti_directory_") + info->name() + "_" + std::to_string(ticks));
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  template <class T>
  void write(const std::string& name, const std::vector<T>& values) {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream file(root_ / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  }
  void writeText(const std::string& name, const std::string& text) { write<char>(name, {text.begin(), text.end()}); }
  void writeScans(int count) {
    for (int i = 0; i < count; ++i) {
      write<float>("velodyne/00000" + std::to_string(i) + ".bin", {static_cast<float>(i) + 1.0f, 2, 3, 0.5f});
    }
  }
  std::string openError() {
    try {
      KittiDirectory::open(root_.string());
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static void expectHas(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' not in: " << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }

  fs::path root_;
};

TEST_F(KittiDirectoryTest, ReadsScansInOrderWithTimesAndIntensities) {
  writeScans(3);
  writeText("times.txt",
            "\xEF\xBB\xBF"
            "0.0\r\n1.0360e-01\r\n0.2072\n\r\n");
  const KittiDirectory kitti = KittiDirectory::open(root_.string());
  ASSERT_EQ(kitti.size(), 3u);
  EXPECT_FALSE(kitti.hasPointTimes());
  Sweep sweep;
  const ReadResult result = kitti.read(1, sweep);
  EXPECT_EQ(result.status, ReadStatus::kOk) << result.message;
  EXPECT_DOUBLE_EQ(sweep.stamp_s, 0.1036);
  ASSERT_EQ(sweep.size(), 1u);
  EXPECT_EQ(sweep.points_lidar[0], Eigen::Vector3f(2, 2, 3));
  EXPECT_FLOAT_EQ(sweep.intensities[0], 0.5f);
  EXPECT_TRUE(sweep.times_s.empty());
}

TEST_F(KittiDirectoryTest, StampsFollowTheNumbersWithoutTimesFile) {
  for (const char* number : {"000002", "000003", "000007", "000010"}) {
    write<float>("velodyne/" + std::string(number) + ".bin", {1, 2, 3, 0});
  }
  const KittiDirectory kitti = KittiDirectory::open(root_.string(), 0.2);
  ASSERT_EQ(kitti.size(), 4u);
  EXPECT_DOUBLE_EQ(kitti.stamps()[0], 0.4);
  EXPECT_DOUBLE_EQ(kitti.stamps()[2], 1.4);
  EXPECT_DOUBLE_EQ(kitti.stamps()[3], 2.0);
}

TEST_F(KittiDirectoryTest, TimesRowsFollowTheFiles) {
  write<float>("velodyne/000000.bin", {1, 2, 3, 0});
  write<float>("velodyne/000005.bin", {1, 2, 3, 0});
  writeText("times.txt", "10.0\n10.5\n");
  EXPECT_DOUBLE_EQ(KittiDirectory::open(root_.string()).stamps()[1], 10.5);
}

TEST_F(KittiDirectoryTest, NumbersAreComparedAsNumbers) {
  for (const char* name : {"velodyne/10.bin", "velodyne/9.bin"}) write<float>(name, {1, 2, 3, 0});
  const KittiDirectory kitti = KittiDirectory::open(root_.string());
  EXPECT_EQ(fs::path(kitti.scanPaths()[0]).filename(), "9.bin");
  write<float>("velodyne/0010.bin", {1, 2, 3, 0});
  expectHas(openError(), "same number");
}

TEST_F(KittiDirectoryTest, FindsRawLayoutAndBareFolder) {
  write<float>("velodyne_points/data/0000000004.bin", {1, 2, 3, 0});
  EXPECT_DOUBLE_EQ(KittiDirectory::open(root_.string()).stamps()[0], 0.4);
  EXPECT_EQ(KittiDirectory::open((root_ / "velodyne_points" / "data").string()).size(), 1u);
  write<float>("bare/scan_b.bin", {1, 2, 3, 0});
  write<float>("bare/scan_a.bin", {1, 2, 3, 0});
  const KittiDirectory bare = KittiDirectory::open((root_ / "bare").string());
  EXPECT_EQ(fs::path(bare.scanPaths()[0]).filename(), "scan_a.bin");
  EXPECT_DOUBLE_EQ(bare.stamps()[1], 0.1);
}

TEST_F(KittiDirectoryTest, TheScansFolderStandsForTheDrive) {
  writeScans(2);
  writeText("times.txt", "7.0\n7.2\n");
  for (const fs::path& scans : {root_ / "velodyne", root_ / "velodyne" / "", root_ / "velodyne" / "."}) {
    EXPECT_DOUBLE_EQ(KittiDirectory::open(scans.string()).stamps()[0], 7.0) << scans;
  }
  write<float>("raw/velodyne_points/data/0000000001.bin", {1, 2, 3, 0});
  writeText("raw/velodyne_points/timestamps.txt", "2011-09-26 00:00:00.0\n");
  for (const char* scans : {"raw/velodyne_points/data", "raw/velodyne_points/data/."}) {
    try {
      KittiDirectory::open((root_ / scans).string());
      ADD_FAILURE() << scans << ": timestamps.txt was not read";
    } catch (const InputError& error) {
      expectHas(error.what(), "1 lines, none for scan 1");
    }
  }
}

TEST_F(KittiDirectoryTest, RawTimestampsFollowTheNumbers) {
  for (const char* number : {"0000000001", "0000000003"}) {
    write<float>("velodyne_points/data/" + std::string(number) + ".bin", {1, 2, 3, 0.5f});
  }
  const std::string lines =
      "2011-09-26 23:59:59.900000000\n2011-09-27 00:00:00.003389445\r\n2011-09-27 00:00:00.1\n"
      "2011-09-27 00:00:00.210000999\n";
  writeText("velodyne_points/timestamps.txt", lines);
  const std::vector<double> expected = {0.0, 0.206612};
  const std::vector<double> stamps = KittiDirectory::open(root_.string()).stamps();
  ASSERT_EQ(stamps.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(stamps[i], expected[i], 1e-9);
  writeText("times.txt", "1.0\n2.0\n");
  EXPECT_EQ(KittiDirectory::open(root_.string()).stamps()[1], 2.0) << "times.txt counts where there is one";
  fs::remove(root_ / "times.txt");

  writeText("velodyne_points/timestamps.txt", "2011-09-26 23:59:59.9\n2011-09-27 00:00:00.0\n");
  expectHas(openError(), "2 lines, none for scan 3");
  for (const char* bad : {"", "0.1", "2011-09-27", "2011-09-27 00:00:", "2011-09-27 00:00:nan", "2011-09-27 00:00:-1",
                          "2011-09-27 00:00:61", "2011-13-27 00:00:00", "2011-09-27 00:00:00 x"}) {
    writeText("velodyne_points/timestamps.txt", lines + bad + "\n2011-09-27 00:00:01\n");
    write<float>("velodyne_points/data/0000000004.bin", {1, 2, 3, 0.5f});
    expectHas(openError(), "timestamps.txt, line 5: '" + std::string(bad) + "' is not a date and time");
  }
}

TEST_F(KittiDirectoryTest, RawTimestampsNeedNumbersAsNames) {
  write<float>("velodyne_points/data/0000000001.bin", {1, 2, 3, 0.5f});
  write<float>("velodyne_points/data/0000000002.bin", {1, 2, 3, 0.5f});
  write<float>("velodyne_points/data/._0000000002.bin", {1, 2, 3, 0.5f});  // a copy from a Mac
  writeText("velodyne_points/timestamps.txt", "2011-09-26 00:00:00.0\n2011-09-26 00:00:00.2\n2011-09-26 00:00:00.4\n");
  const std::vector<double> stamps = KittiDirectory::open(root_.string()).stamps();
  ASSERT_EQ(stamps.size(), 2u);
  EXPECT_NEAR(stamps[1], 0.2, 1e-9);
  write<float>("velodyne_points/data/copy.bin", {1, 2, 3, 0.5f});
  expectHas(openError(), "must have numbers as names");
}

TEST_F(KittiDirectoryTest, OpenNamesWhatIsWrong) {
  try {
    KittiDirectory::open((root_ / "absent").string());
    FAIL() << "a missing directory was opened";
  } catch (const InputError& error) {
    expectHas(error.what(), "absent: no such directory");
  }
  expectHas(openError(), "no scans");
  writeScans(3);
  writeText("times.txt", "0.0\n0.1\n");
  expectHas(openError(), "times.txt: 2 lines for 3 scans");
  writeText("times.txt", "0.0\n0.1\n0.2\n0.3\n");
  expectHas(openError(), "4 lines for 3 scans");
  writeText("times.txt", "");
  expectHas(openError(), "0 lines for 3 scans");
  for (const char* bad : {"abc", "0.2s", "nan", "inf", "", "0.1 0.2"}) {
    writeText("times.txt", std::string("0.0\n") + bad + "\n0.3\n");
    expectHas(openError(), "line 2: '" + std::string(bad) + "' is not a number of seconds");
  }
  writeText("times.txt", "0.2\n0.1\n0.0\n");
  expectHas(openError(), "line 2: '0.1' is before the line above it");
  writeText("times.txt", "0.0\n0.3\n-0.1\n");  // stamps that go back are data
  EXPECT_DOUBLE_EQ(KittiDirectory::open(root_.string()).stamps()[2], -0.1);
  EXPECT_THROW(KittiDirectory::open((root_ / "times.txt").string()), InputError);
  fs::remove(root_ / "velodyne/000001.bin");
  expectHas(openError(), "3 lines for 2 scans; no scan has the number 1");
}

TEST_F(KittiDirectoryTest, DropsPointsWithTheirStampsAndRings) {
  write<float>("velodyne/000000.bin", {1, 1,    1, 0.1f, kNan, 1, 1, 0, 0, 0,    0,      0, 2, 2,
                                       2, kNan, 1, kInf, 1,    0, 3, 3, 3, 0.3f, 1.1e6f, 0, 0, 0});
  write<float>("stamps/000000.f32", {0.00f, 0.01f, 0.02f, 0.03f, 0.04f, 0.05f, 0.06f});
  write<std::uint16_t>("rings/000000.u16", {0, 1, 2, 3, 4, 63, 5});
  Sweep sweep;
  sweep.points_lidar.resize(100);
  const ReadResult result = KittiDirectory::open(root_.string()).read(0, sweep);
  EXPECT_EQ(result.status, ReadStatus::kOk) << result.message;
  ASSERT_EQ(sweep.size(), 3u);
  EXPECT_EQ(sweep.points_dropped, 4u) << "not finite twice, no return, farther than any lidar sees";
  EXPECT_EQ(sweep.points_lidar[1], Eigen::Vector3f(2, 2, 2));
  EXPECT_EQ(sweep.times_s, (std::vector<float>{0.00f, 0.03f, 0.05f}));
  EXPECT_EQ(sweep.rings, (std::vector<std::uint16_t>{0, 3, 63}));
  EXPECT_EQ(sweep.intensities, (std::vector<float>{0.1f, 0.0f, 0.3f}));
}

TEST_F(KittiDirectoryTest, ReportsEachKindOfBadScanAndNamesTheFile) {
  write<float>("velodyne/000000.bin", {1, 2, 3});
  write<float>("velodyne/000001.bin", {});
  write<float>("velodyne/000002.bin", {kNan, 1, 1, 0, 0, 0, 0, 0});
  write<float>("velodyne/000003.bin", {1, 2, 3, 4});
  fs::create_directories(root_ / "velodyne" / "000004.bin");
  const KittiDirectory kitti = KittiDirectory::open(root_.string());
  ASSERT_EQ(kitti.size(), 5u);
  fs::remove(root_ / "velodyne" / "000003.bin");
  const char* expected[] = {"not a multiple of 16", "empty file", "none of 2 points", "cannot be read",
                            "cannot be read"};
  for (std::size_t i = 0; i < kitti.size(); ++i) {
    Sweep sweep;
    sweep.points_lidar.resize(7);
    sweep.rings.resize(7);
    const ReadResult result = kitti.read(i, sweep);
    EXPECT_EQ(result.status, ReadStatus::kNoPoints) << i;
    expectHas(result.message, expected[i]);
    EXPECT_FALSE(result.hasPoints());
    expectHas(result.message, "00000" + std::to_string(i) + ".bin");
    EXPECT_TRUE(sweep.empty() && sweep.rings.empty() && sweep.intensities.empty());
    EXPECT_DOUBLE_EQ(sweep.stamp_s, 0.1 * static_cast<double>(i));
    EXPECT_EQ(sweep.points_dropped, i == 2 ? 2u : 0u);
  }
  Sweep sweep;
  EXPECT_EQ(kitti.read(5, sweep).status, ReadStatus::kNoPoints);
}

TEST_F(KittiDirectoryTest, SideFilesOfAnotherCountAreLeftOut) {
  writeScans(3);
  write<float>("stamps/000000.f32", {0.01f, 0.02f});
  write<float>("stamps/000001.f32", {0.01f});
  write<float>("stamps/000002.f32", {0.01f});
  write<std::uint16_t>("rings/000000.u16", {3});
  write<std::uint16_t>("rings/000001.u16", {3});
  const KittiDirectory kitti = KittiDirectory::open(root_.string());
  Sweep sweep;
  ReadResult result = kitti.read(0, sweep);
  EXPECT_EQ(result.status, ReadStatus::kSideFileUnusable);
  expectHas(result.message, "000000.f32");
  EXPECT_TRUE(result.hasPoints() && sweep.size() == 1 && sweep.times_s.empty() && sweep.rings.size() == 1);
  EXPECT_EQ(kitti.read(1, sweep).status, ReadStatus::kOk);
  result = kitti.read(2, sweep);
  EXPECT_EQ(result.status, ReadStatus::kSideFileUnusable);
  expectHas(result.message, "000002.u16: missing");
  EXPECT_TRUE(sweep.rings.empty() && sweep.times_s.size() == 1);
}

TEST_F(KittiDirectoryTest, PointTimesCountFromMidSweep) {
  std::string times;
  for (int i = 0; i < 6; ++i) {
    const std::string name = "00000" + std::to_string(i);
    write<float>("velodyne/" + name + ".bin", {-5, 0.1f, 0, 0, 5, 0, 0, 0, -5, -0.1f, 0, 0});
    write<float>("stamps/" + name + ".f32", {0.0f, 0.0518f, 0.1036f});
    times += std::to_string(0.1036 * i) + "\n";
  }
  writeText("times.txt", times);
  const KittiDirectory kitti = KittiDirectory::open(root_.string());
  SweepTimingParams params;
  params.stamp_reference = "mid";
  SweepTiming timing(params);
  SweepClock clock;
  Sweep sweep;
  std::vector<float> times_s;
  for (std::size_t i = 0; i < kitti.size(); ++i) {
    ASSERT_EQ(kitti.read(i, sweep).status, ReadStatus::kOk);
    const TimingResult result = timing.assign(sweep, clock.next(sweep.stamp_s).period_s, times_s);
    ASSERT_EQ(result.source, TimingSource::kField);
    EXPECT_EQ(result.reference, StampReference::kMid);
    const double half = i < 3 ? 0.05 : 0.0518;  // nominal until three differences are known
    EXPECT_NEAR(result.period_s, 2.0 * half, 1e-6);
    EXPECT_NEAR(times_s[0], -half, 1e-6);
    EXPECT_NEAR(times_s[1], 0.0518 - half, 1e-6);
    EXPECT_NEAR(times_s[2], 0.1036 - half, 1e-6);
  }
}

}  // namespace
}  // namespace fail_aware::kitti_directory_test
