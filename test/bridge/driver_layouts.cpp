// One header of each driver that doc/drivers.md lists, filled with a revolution: what is read from it, and when its
// points were measured. Layouts: from the drivers' sources.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "core/preprocessing/timing.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"

namespace fail_aware::driver_layouts {
namespace {

using sensor_msgs::PointField;

constexpr std::uint32_t kDriverBeams = 16, kDriverColumns = 360;
constexpr double kPeriod_s = 0.1;
constexpr std::uint32_t kStamp_s = 1700000000;

struct FieldSpec {
  const char* name;
  std::uint32_t offset;
  std::uint8_t datatype;
};

enum class Rows { kOne, kOneWithoutRowStep, kByBeam, kByColumn };

struct Driver {
  const char* name;
  std::vector<FieldSpec> fields;
  std::uint32_t point_step;
  Rows rows;
  const char* ring;          ///< null: none
  const char* time;          ///< null: none
  double first;              ///< the field at the sweep's start, in its unit
  double unit_s;             ///< of the field; 0: left empty
  TimingSource source;       ///< of "auto"
  StampReference reference;  ///< likewise
};

void PrintTo(const Driver& driver, std::ostream* out) { *out << driver.name; }

constexpr auto F32 = PointField::FLOAT32;
constexpr auto F64 = PointField::FLOAT64;
constexpr auto U8 = PointField::UINT8;
constexpr auto I8 = PointField::INT8;
constexpr auto U16 = PointField::UINT16;
constexpr auto U32 = PointField::UINT32;
constexpr auto kField = TimingSource::kField;
constexpr auto kAzimuth = TimingSource::kAzimuth;
constexpr auto kAtStart = StampReference::kStart;
constexpr auto kEnd = StampReference::kEnd;

const std::vector<FieldSpec> kVelodyne = {{"x", 0, F32},          {"y", 4, F32},     {"z", 8, F32},
                                          {"intensity", 12, F32}, {"ring", 16, U16}, {"time", 18, F32}};
const std::vector<FieldSpec> kXyzirt = {{"x", 0, F32},          {"y", 4, F32},     {"z", 8, F32},
                                        {"intensity", 12, F32}, {"ring", 16, U16}, {"timestamp", 18, F64}};

const Driver kDrivers[] = {
    {"velodyne_1_5",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"intensity", 16, F32}, {"ring", 20, U16}},
     32,
     Rows::kOne,
     "ring",
     nullptr,
     0.0,
     0.0,
     kAzimuth,
     kEnd},
    {"velodyne_1_6_dense", kVelodyne, 22, Rows::kOneWithoutRowStep, "ring", "time", -0.1, 1.0, kField, kEnd},
    {"velodyne_1_7_dense", kVelodyne, 22, Rows::kOne, "ring", "time", -0.1, 1.0, kField, kEnd},
    {"velodyne_1_7_first_packet", kVelodyne, 22, Rows::kOne, "ring", "time", 0.0, 1.0, kField, kAtStart},
    {"velodyne_1_7_organized", kVelodyne, 22, Rows::kByColumn, "ring", "time", -0.1, 1.0, kField, kEnd},
    {"velodyne_1_7_hdl64e", kVelodyne, 22, Rows::kOne, "ring", "time", 0.0, 0.0, kAzimuth, kEnd},
    {"ouster_2019",
     {{"x", 0, F32},
      {"y", 4, F32},
      {"z", 8, F32},
      {"t", 16, F32},
      {"reflectivity", 20, U16},
      {"intensity", 22, U16},
      {"ring", 24, U8}},
     32,
     Rows::kByBeam,
     "ring",
     "t",
     0.0,
     1e-9,
     kField,
     kAtStart},
    {"ouster_2",
     {{"x", 0, F32},
      {"y", 4, F32},
      {"z", 8, F32},
      {"intensity", 16, F32},
      {"t", 20, U32},
      {"reflectivity", 24, U16},
      {"ring", 26, U8},
      {"ambient", 28, U16},
      {"range", 32, U32}},
     48,
     Rows::kByBeam,
     "ring",
     "t",
     0.0,
     1e-9,
     kField,
     kAtStart},
    {"ouster_3",
     {{"x", 0, F32},
      {"y", 4, F32},
      {"z", 8, F32},
      {"intensity", 16, F32},
      {"t", 20, U32},
      {"reflectivity", 24, U16},
      {"ring", 26, U16},
      {"ambient", 28, U16},
      {"range", 32, U32}},
     48,
     Rows::kByBeam,
     "ring",
     "t",
     0.0,
     1e-9,
     kField,
     kAtStart},
    {"hesai_general",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"intensity", 16, F32}, {"timestamp", 24, F64}, {"ring", 32, U16}},
     48,
     Rows::kOne,
     "ring",
     "timestamp",
     kStamp_s,
     1.0,
     kField,
     kAtStart},
    {"hesai_2_0", kXyzirt, 26, Rows::kOne, "ring", "timestamp", kStamp_s, 1.0, kField, kAtStart},
    {"hesai_2_0_own_clock", kXyzirt, 26, Rows::kOne, "ring", "timestamp", 4711.25, 1.0, kField, kAtStart},
    {"rslidar_last_point", kXyzirt, 26, Rows::kByBeam, "ring", "timestamp", kStamp_s - 0.1, 1.0, kField, kEnd},
    {"rslidar_first_point", kXyzirt, 26, Rows::kByColumn, "ring", "timestamp", kStamp_s, 1.0, kField, kAtStart},
    {"livox_2",
     {{"x", 0, F32},
      {"y", 4, F32},
      {"z", 8, F32},
      {"intensity", 12, F32},
      {"tag", 16, U8},
      {"line", 17, U8},
      {"timestamp", 18, F64}},
     26,
     Rows::kOne,
     "line",
     "timestamp",
     1e9 * kStamp_s,
     1e-9,
     kField,
     kAtStart},
    {"livox_custom_converted",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"offset_time", 12, U32}, {"line", 16, U8}},
     17,
     Rows::kOne,
     "line",
     "offset_time",
     0.0,
     1e-9,
     kField,
     kAtStart},
    {"sick_scan_xd_t",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"i", 12, F32}, {"t", 16, U32}, {"layer", 20, I8}},
     21,
     Rows::kOne,
     "layer",
     "t",
     0.0,
     1e-9,
     kField,
     kAtStart},
    {"sick_scan_xd_ts",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"i", 12, F32}, {"ts", 16, F32}, {"ring", 20, I8}},
     21,
     Rows::kOne,
     "ring",
     "ts",
     0.0,
     1.0,
     kField,
     kAtStart},
    {"sick_ldmrs",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"echowidth", 16, U16}, {"layer", 18, U8}, {"echo", 19, U8}},
     32,
     Rows::kOne,
     "layer",
     nullptr,
     0.0,
     0.0,
     kAzimuth,
     kEnd},
    {"autoware_nebula",
     {{"x", 0, F32},
      {"y", 4, F32},
      {"z", 8, F32},
      {"intensity", 12, U8},
      {"return_type", 13, U8},
      {"channel", 14, U16},
      {"azimuth", 16, F32},
      {"elevation", 20, F32},
      {"distance", 24, F32},
      {"time_stamp", 28, U32}},
     32,
     Rows::kOne,
     "channel",
     "time_stamp",
     0.0,
     1e-9,
     kField,
     kAtStart},
    {"kitti",
     {{"x", 0, F32}, {"y", 4, F32}, {"z", 8, F32}, {"i", 12, F32}},
     16,
     Rows::kOne,
     nullptr,
     nullptr,
     0.0,
     0.0,
     kAzimuth,
     kEnd},
};

void put(std::uint8_t* at, std::uint8_t datatype, double value) {
  const auto as = [&](auto number) { std::memcpy(at, &number, sizeof number); };
  switch (datatype) {
    case F32: return as(static_cast<float>(value));
    case F64: return as(value);
    case U8: return as(static_cast<std::uint8_t>(value));
    case I8: return as(static_cast<std::int8_t>(value));
    case U16: return as(static_cast<std::uint16_t>(value));
    default: return as(static_cast<std::uint32_t>(std::llround(value)));
  }
}

double timeOf(std::uint32_t column) { return kPeriod_s * (column + 0.5) / kDriverColumns; }

/// Beam 3 sees nothing in each tenth column: NaN, or zeros where the driver writes zeros.
bool isSeen(std::uint32_t column, std::uint32_t beam) { return beam != 3 || column % 10 != 0; }

sensor_msgs::PointCloud2 cloudOf(const Driver& driver) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = ros::Time(kStamp_s, 0);
  for (const FieldSpec& spec : driver.fields) {
    PointField field;
    field.name = spec.name;
    field.offset = spec.offset;
    field.datatype = spec.datatype;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = driver.point_step;
  const bool by_beam = driver.rows == Rows::kByBeam, by_column = driver.rows == Rows::kByColumn;
  cloud.height = by_beam ? kDriverBeams : by_column ? kDriverColumns : 1;
  cloud.width = kDriverBeams * kDriverColumns / cloud.height;
  cloud.row_step = driver.rows == Rows::kOneWithoutRowStep ? 0 : cloud.width * cloud.point_step;
  cloud.data.resize(std::size_t{kDriverBeams} * kDriverColumns * cloud.point_step);
  for (std::uint32_t column = 0; column < kDriverColumns; ++column) {
    for (std::uint32_t beam = 0; beam < kDriverBeams; ++beam) {
      const std::uint32_t index = by_beam ? beam * kDriverColumns + column : column * kDriverBeams + beam;
      std::uint8_t* point = cloud.data.data() + std::size_t{index} * cloud.point_step;
      const double yaw = M_PI * (1.0 - 2.0 * timeOf(column) / kPeriod_s), range_m = 10.0 + beam;
      const double none = by_beam ? 0.0 : std::numeric_limits<double>::quiet_NaN();
      const double coordinates[] = {range_m * std::cos(yaw), range_m * std::sin(yaw), 0.2 * beam - 1.0};
      for (const FieldSpec& spec : driver.fields) {
        const std::string name = spec.name;
        double value = 7.0;
        for (int k = 0; k < 3; ++k) {
          if (name == std::string(1, "xyz"[k])) value = isSeen(column, beam) ? coordinates[k] : none;
        }
        if (driver.ring != nullptr && name == driver.ring) value = beam;
        if (name == "time") value = 0.0;
        if (driver.time != nullptr && name == driver.time && driver.unit_s > 0.0) {
          value = driver.first + timeOf(column) / driver.unit_s;
        }
        put(point + spec.offset, spec.datatype, value);
      }
    }
  }
  return cloud;
}

class DriverLayout : public testing::TestWithParam<Driver> {};

TEST_P(DriverLayout, IsReadAndTimed) {
  const Driver& driver = GetParam();
  Sweep sweep;
  const CloudReadResult read = readCloud(cloudOf(driver), sweep);
  ASSERT_TRUE(read.ok()) << read.reason;
  EXPECT_EQ(sweep.size(), kDriverBeams * kDriverColumns - kDriverColumns / 10);
  EXPECT_EQ(sweep.points_dropped, kDriverColumns / 10);
  EXPECT_EQ(sweep.rings.empty(), driver.ring == nullptr);
  EXPECT_EQ(sweep.time_field.name, driver.time == nullptr ? "" : driver.time);
  EXPECT_EQ(sweep.time_field.refused, "");

  SweepTimingParams params;
  std::vector<float> times_s;
  const TimingResult timing = SweepTiming(params).assign(sweep, 0.0, times_s);
  EXPECT_EQ(timing.source, driver.source);
  EXPECT_EQ(timing.reference, driver.reference);
  EXPECT_FALSE(timing.guessed());
  EXPECT_EQ(timing.outliers, 0u);
  ASSERT_EQ(times_s.size(), sweep.size());
  const double start_s = driver.reference == kEnd ? -kPeriod_s : 0.0;
  // of an own clock the first point's time is 0; of 64 bits of ns 256 ns are one step
  const double tolerance_s = kPeriod_s / kDriverColumns;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const Eigen::Vector3f& p = sweep.points_lidar[i];
    const double turned = 0.5 * (1.0 - std::atan2(p.y(), p.x()) / M_PI);
    ASSERT_NEAR(times_s[i], start_s + kPeriod_s * turned, tolerance_s) << i;
    if (driver.ring == nullptr) continue;
    ASSERT_EQ(sweep.rings[i], std::lround(std::hypot(p.x(), p.y()) - 10.0f)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Drivers, DriverLayout, testing::ValuesIn(kDrivers),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace fail_aware::driver_layouts
