#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "core/types/corrected_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace fail_aware::point_cloud_conversion_test {
namespace {

using sensor_msgs::PointField;

struct FieldSpec {
  const char* name;
  std::uint32_t offset;
  std::uint8_t datatype;
};

sensor_msgs::PointCloud2 makeCloud(const std::vector<FieldSpec>& fields, std::uint32_t point_step,
                                   std::uint32_t count) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = ros::Time(1000000000, 500000000);
  for (const FieldSpec& spec : fields) {
    PointField field;
    field.name = spec.name;
    field.offset = spec.offset;
    field.datatype = spec.datatype;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.height = 1;
  cloud.width = count;
  cloud.point_step = point_step;
  cloud.row_step = point_step * count;
  cloud.data.resize(cloud.row_step);
  return cloud;
}

template <class T>
void put(sensor_msgs::PointCloud2& cloud, std::size_t at, T value) {
  std::memcpy(cloud.data.data() + at, &value, sizeof value);
}

/// As the Noetic velodyne driver packs: `time` is misaligned in every point.
sensor_msgs::PointCloud2 velodyneCloud(const std::vector<Eigen::Vector3f>& points) {
  const auto count = static_cast<std::uint32_t>(points.size());
  auto cloud = makeCloud({{"x", 0, PointField::FLOAT32},
                          {"y", 4, PointField::FLOAT32},
                          {"z", 8, PointField::FLOAT32},
                          {"intensity", 12, PointField::FLOAT32},
                          {"ring", 16, PointField::UINT16},
                          {"time", 18, PointField::FLOAT32}},
                         22, count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) put(cloud, 22 * i + 4 * static_cast<std::size_t>(k), points[i][k]);
    put(cloud, 22 * i + 12, 10.0f + static_cast<float>(i));
    put(cloud, 22 * i + 16, static_cast<std::uint16_t>(63 - i));
    put(cloud, 22 * i + 18, -0.01f * static_cast<float>(i));
  }
  return cloud;
}

const std::vector<Eigen::Vector3f> kPoints = {{1, 2, 3}, {-4, 5, -6}, {7.5f, -8.25f, 9}};

TEST(ReadCloud, VelodynePacking) {
  Sweep sweep;
  ASSERT_TRUE(readCloud(velodyneCloud(kPoints), sweep).ok());
  EXPECT_DOUBLE_EQ(sweep.stamp_s, 1000000000.5);
  EXPECT_EQ(sweep.points_lidar, kPoints);
  EXPECT_EQ(sweep.intensities, (std::vector<float>{10, 11, 12}));
  EXPECT_EQ(sweep.rings, (std::vector<std::uint16_t>{63, 62, 61}));
  EXPECT_EQ(sweep.times_s, (std::vector<float>{-0.0f, -0.01f, -0.02f}));
}

TEST(ReadCloud, DoublesShortNamesAndRowPadding) {
  auto cloud = makeCloud({{"z", 1, PointField::FLOAT64},
                          {"x", 9, PointField::FLOAT64},
                          {"y", 17, PointField::FLOAT64},
                          {"i", 0, PointField::UINT8}},
                         25, 4);
  cloud.height = 2;
  cloud.width = 2;
  cloud.row_step = 60;
  cloud.data.assign(60 + 50, 0);  // the last row without its padding
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t at = 60 * (i / 2) + 25 * (i % 2);
    put(cloud, at, static_cast<std::uint8_t>(200 + i));
    put(cloud, at + 1, 3.0 + static_cast<double>(i));
    put(cloud, at + 9, 1.0 + static_cast<double>(i));
    put(cloud, at + 17, 2.0 + static_cast<double>(i));
  }
  Sweep sweep;
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  ASSERT_EQ(sweep.size(), 4u);
  EXPECT_EQ(sweep.points_lidar[3], Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(sweep.intensities, (std::vector<float>{200, 201, 202, 203}));
  EXPECT_TRUE(sweep.times_s.empty());
  EXPECT_TRUE(sweep.rings.empty());
}

TEST(ReadCloud, LeavesOutWhatIsNoPoint) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Sweep sweep;
  ASSERT_TRUE(readCloud(velodyneCloud({{nan, 1, 1}, {1, 2, 3}, {1, inf, 1}, {0, 0, 0}, {4, 5, 6}}), sweep).ok());
  EXPECT_EQ(sweep.points_lidar, (std::vector<Eigen::Vector3f>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(sweep.points_dropped, 3u);
  EXPECT_EQ(sweep.intensities, (std::vector<float>{11, 14}));
  EXPECT_EQ(sweep.rings.size(), 2u);
  EXPECT_EQ(sweep.times_s.size(), 2u);
  ASSERT_TRUE(readCloud(velodyneCloud({{2e19f, 1, 1}, {1, 2, 3}, {1, 1, -3e38f}}), sweep).ok());
  EXPECT_EQ(sweep.size(), 1u) << "what is that far away cannot be squared";
  const CloudReadResult all = readCloud(velodyneCloud({{nan, 1, 1}}), sweep);
  EXPECT_EQ(all.status, CloudStatus::kEmpty);
  EXPECT_TRUE(sweep.empty());
}

TEST(ReadCloud, AnIntensityThatIsNoNumberBecomesZero) {
  auto cloud = velodyneCloud({{1, 2, 3}, {4, 5, 6}});
  put(cloud, 12, std::numeric_limits<float>::quiet_NaN());
  Sweep sweep;
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  EXPECT_EQ(sweep.intensities, (std::vector<float>{0, 11}));
}

TEST(ReadCloud, RefusesMorePointsThanAnyLidarGives) {
  auto cloud = makeCloud({{"x", 0, PointField::FLOAT32}, {"y", 0, PointField::FLOAT32}, {"z", 0, PointField::FLOAT32}},
                         4, 10000001);
  Sweep sweep;
  const CloudReadResult result = readCloud(cloud, sweep);
  EXPECT_EQ(result.status, CloudStatus::kBadLayout);
  EXPECT_NE(result.reason.find("10000001 points"), std::string::npos) << result.reason;
}

sensor_msgs::PointCloud2 timedCloud(const char* name, std::uint8_t datatype) {
  auto cloud = makeCloud({{"x", 0, PointField::FLOAT32},
                          {"y", 4, PointField::FLOAT32},
                          {"z", 8, PointField::FLOAT32},
                          {name, 12, datatype}},
                         20, 1);
  put(cloud, 0, 1.0f);
  return cloud;
}

TEST(ReadCloud, TimeOfEveryType) {
  Sweep sweep;
  auto absolute = timedCloud("timestamp", PointField::FLOAT64);
  put(absolute, 12, 1000000000.45);
  ASSERT_TRUE(readCloud(absolute, sweep).ok());
  EXPECT_NEAR(sweep.time_field.origin_s + sweep.times_s.at(0), 1000000000.45, 1e-6);
  auto nanoseconds = timedCloud("t", PointField::UINT32);
  put(nanoseconds, 12, std::uint32_t{25000000});
  ASSERT_TRUE(readCloud(nanoseconds, sweep).ok());
  EXPECT_NEAR(sweep.times_s.at(0), 0.025, 1e-9);
}

TEST(ReadCloud, RowStepCountsOnlyWhereRowsArePadded) {
  Sweep sweep;
  for (const std::uint32_t row_step : {0u, 1u, 65u, 66u, 0xffffffffu}) {
    auto cloud = velodyneCloud(kPoints);
    cloud.row_step = row_step;
    ASSERT_TRUE(readCloud(cloud, sweep).ok()) << "one row, row_step " << row_step;
    EXPECT_EQ(sweep.points_lidar, kPoints);
    cloud.height = 3;
    cloud.width = 1;
    ASSERT_TRUE(readCloud(cloud, sweep).ok()) << "three packed rows, row_step " << row_step;
    EXPECT_EQ(sweep.points_lidar, kPoints);
  }
}

TEST(ReadCloud, BigEndian) {
  const auto cloud = velodyneCloud(kPoints);
  auto swapped = cloud;
  swapped.is_bigendian = true;
  const std::vector<std::pair<std::size_t, std::size_t>> numbers = {{0, 4}, {4, 4}, {8, 4}, {12, 4}, {16, 2}, {18, 4}};
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    for (const auto& [offset, size] : numbers) {
      const auto at = swapped.data.begin() + static_cast<std::ptrdiff_t>(22 * i + offset);
      std::reverse(at, at + static_cast<std::ptrdiff_t>(size));
    }
  }
  Sweep sweep, expected;
  ASSERT_TRUE(readCloud(swapped, sweep).ok());
  ASSERT_TRUE(readCloud(cloud, expected).ok());
  EXPECT_EQ(sweep.points_lidar, expected.points_lidar);
  EXPECT_EQ(sweep.intensities, expected.intensities);
  EXPECT_EQ(sweep.rings, expected.rings);
  EXPECT_EQ(sweep.times_s, expected.times_s);
}

TEST(ReadCloud, TakesTheTimeFieldThatTellsTimes) {
  auto cloud = makeCloud({{"x", 0, PointField::FLOAT32},
                          {"y", 4, PointField::FLOAT32},
                          {"z", 8, PointField::FLOAT32},
                          {"time", 12, PointField::FLOAT32},
                          {"Point_Stamp", 16, PointField::UINT32}},
                         20, 50);
  for (std::size_t i = 0; i < 50; ++i) {
    put(cloud, 20 * i, 1.0f + static_cast<float>(i));
    put(cloud, 20 * i + 16, static_cast<std::uint32_t>(2000 * i));  // us
  }
  Sweep sweep;
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  EXPECT_EQ(sweep.time_field.name, "Point_Stamp") << "`time` is left empty";
  EXPECT_STREQ(sweep.time_field.unit, "us");
  EXPECT_NEAR(sweep.times_s.back(), 0.098, 1e-6);
  cloud.fields[4].name = "stump";
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  EXPECT_EQ(sweep.time_field.name, "time");
  EXPECT_EQ(sweep.times_s, std::vector<float>(50, 0.0f));
  EXPECT_EQ(sweep.time_field.refused, "");
  for (std::size_t i = 0; i < 50; ++i) put(cloud, 20 * i + 12, 0.3f * static_cast<float>(i));
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  EXPECT_EQ(sweep.time_field.name, "time");
  EXPECT_NE(sweep.time_field.refused, "");
  EXPECT_TRUE(sweep.times_s.empty());
}

TEST(ReadCloud, RefusesWithAReason) {
  Sweep sweep;
  const auto status = [&](const sensor_msgs::PointCloud2& cloud) {
    const CloudReadResult result = readCloud(cloud, sweep);
    EXPECT_TRUE(sweep.empty());
    EXPECT_EQ(result.ok(), result.reason.empty());
    return result.status;
  };
  EXPECT_EQ(status(velodyneCloud({})), CloudStatus::kEmpty);
  EXPECT_EQ(status(sensor_msgs::PointCloud2()), CloudStatus::kEmpty);
  auto cloud = velodyneCloud(kPoints);
  cloud.height = 3;
  cloud.width = 1;
  cloud.row_step = 21;
  cloud.data.push_back(0);  // neither rows of row_step nor rows without padding
  EXPECT_EQ(status(cloud), CloudStatus::kBadLayout);
  cloud = velodyneCloud(kPoints);
  cloud.data.pop_back();
  EXPECT_EQ(status(cloud), CloudStatus::kBadLayout);
  cloud = velodyneCloud(kPoints);
  cloud.point_step = 0;
  EXPECT_EQ(status(cloud), CloudStatus::kBadLayout);
  cloud = velodyneCloud(kPoints);
  cloud.fields[5].offset = 19;  // one byte beyond the point
  EXPECT_EQ(status(cloud), CloudStatus::kBadLayout);
  cloud.fields[5].offset = 0xffffffffu;
  EXPECT_EQ(status(cloud), CloudStatus::kBadLayout);
  cloud = velodyneCloud(kPoints);
  cloud.width = cloud.height = 0xffffffffu;
  EXPECT_EQ(status(cloud), CloudStatus::kBadLayout);
  cloud = velodyneCloud(kPoints);
  cloud.fields[2].name = "height";
  EXPECT_EQ(status(cloud), CloudStatus::kNoCoordinates);
  cloud = velodyneCloud(kPoints);
  cloud.fields[0].datatype = PointField::INT32;
  EXPECT_EQ(status(cloud), CloudStatus::kNoCoordinates);
}

TEST(CorrectedCloud, ComesBackAsItWas) {
  CorrectedSweep sweep, back;
  sweep.points_lidar = kPoints;
  sweep.times_s = {-0.05f, 0.0f, 0.05f};
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = ros::Time(12, 250000000);
  writeCloud(sweep, {1, 2, 3}, cloud);
  EXPECT_EQ(cloud.point_step, 20u);
  EXPECT_EQ(cloud.data.size(), 60u);
  ASSERT_TRUE(readCorrectedCloud(cloud, back).ok());
  EXPECT_EQ(back.points_lidar, kPoints);
  EXPECT_EQ(back.times_s, sweep.times_s);
  EXPECT_DOUBLE_EQ(back.stamp_s, 12.25);
  Sweep raw;
  ASSERT_TRUE(readCloud(cloud, raw).ok());
  EXPECT_EQ(raw.intensities, (std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(back.rings.empty() && raw.rings.empty());
  sweep.rings = {0, 63, 4095};
  writeCloud(sweep, {1, 2, 3}, cloud);
  EXPECT_EQ(cloud.point_step, 24u);
  EXPECT_EQ(cloud.fields.back().datatype, sensor_msgs::PointField::UINT16);
  ASSERT_TRUE(readCorrectedCloud(cloud, back).ok());
  EXPECT_EQ(back.rings, sweep.rings);
  EXPECT_EQ(back.times_s, sweep.times_s);
  sweep.times_s[1] = std::numeric_limits<float>::quiet_NaN();
  writeCloud(sweep, {}, cloud);
  ASSERT_TRUE(readCorrectedCloud(cloud, back).ok());
  EXPECT_EQ(back.points_lidar, (std::vector<Eigen::Vector3f>{kPoints[0], kPoints[2]})) << "a time that is none";
  EXPECT_EQ(back.times_s, (std::vector<float>{-0.05f, 0.05f}));
  EXPECT_EQ(back.rings, (std::vector<std::uint16_t>{0, 4095}));
  sweep.times_s.clear();
  writeCloud(sweep, {}, cloud);
  ASSERT_TRUE(readCorrectedCloud(cloud, back).ok());
  EXPECT_TRUE(back.times_s.empty());
}

TEST(WritePoints, AreReadBack) {
  sensor_msgs::PointCloud2 cloud;
  writePoints({{1.0, 2.0, 3.0}, {-4.0, 5.0, 6.0}}, Pose::Identity(), cloud);
  EXPECT_EQ(cloud.point_step, 12u);
  Sweep sweep;
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  EXPECT_EQ(sweep.points_lidar, (std::vector<Eigen::Vector3f>{{1, 2, 3}, {-4, 5, 6}}));
  writePoints({}, Pose::Identity(), cloud);
  EXPECT_EQ(cloud.width, 0u);
  EXPECT_TRUE(cloud.data.empty());
}

TEST(WritePoints, ExactAtTheCoordinatesOfAMap) {
  const Pose T_odom_lidar = poseFromVector((Vector6d() << 691234.567, 5334567.891, 519.0, 0.01, -0.02, 2.0).finished());
  const std::vector<Eigen::Vector3d> points_lidar = {{12.345, -6.789, 0.123}, {12.346, -6.789, 0.123}};
  sensor_msgs::PointCloud2 cloud;
  writePoints({T_odom_lidar * points_lidar[0], T_odom_lidar * points_lidar[1]}, T_odom_lidar, cloud);
  Sweep sweep;
  ASSERT_TRUE(readCloud(cloud, sweep).ok());
  ASSERT_EQ(sweep.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT((sweep.points_lidar[i].cast<double>() - points_lidar[i]).norm(), 1e-5) << "m";
  }
}

}  // namespace
}  // namespace fail_aware::point_cloud_conversion_test
