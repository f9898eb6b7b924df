// PointCloud2 of any layout -> Sweep, CorrectedSweep.
#include <sensor_msgs/PointCloud2.h>

#include <cmath>

#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fuzz_input.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

namespace {

sensor_msgs::PointCloud2 cloudOf(FuzzInput& input) {
  const char* const names[] = {"x", "y", "z", "intensity", "i", "ring", "time", "t", "timestamp", ""};
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp.sec = input.any<std::uint32_t>();
  cloud.header.stamp.nsec = input.below(1000000000);
  cloud.is_bigendian = input.oneIn(20);
  // Mostly small numbers, so that many layouts fit; now and then any.
  const auto number = [&] { return input.oneIn(10) ? input.any<std::uint32_t>() : input.below(41); };
  cloud.height = number();
  cloud.width = number();
  cloud.point_step = number();
  cloud.row_step = input.flag() ? cloud.width * cloud.point_step : number();
  for (std::uint32_t i = input.below(13); i > 0; --i) {
    sensor_msgs::PointField field;
    field.name = input.pick(names);
    field.offset = number();
    field.datatype = static_cast<std::uint8_t>(input.below(10));
    field.count = number();
    cloud.fields.push_back(field);
  }
  const std::string bytes = input.rest();
  cloud.data.assign(bytes.begin(), bytes.end());
  return cloud;
}

template <class Numbers>
bool onePerPointOrNone(const Numbers& numbers, std::size_t points) {
  return numbers.empty() || numbers.size() == points;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const sensor_msgs::PointCloud2 cloud = cloudOf(input);
  Sweep sweep;
  const CloudReadResult result = readCloud(cloud, sweep);
  promise(result.ok() == !sweep.empty(), "points if and only if the status is kOk");
  for (const auto& point : sweep.points_lidar) promise(point.allFinite(), "points are finite");
  promise(onePerPointOrNone(sweep.times_s, sweep.size()) && onePerPointOrNone(sweep.rings, sweep.size()) &&
              onePerPointOrNone(sweep.intensities, sweep.size()),
          "one of each for a point, or none");
  promise(result.ok() == result.reason.empty(), "a reason if and only if refused");
  CorrectedSweep corrected;
  const bool ok = readCorrectedCloud(cloud, corrected).ok();
  promise(ok || corrected.points_lidar.empty(), "no points if refused");
  for (const auto& point : corrected.points_lidar) promise(point.allFinite(), "points are finite");
  promise(onePerPointOrNone(corrected.times_s, corrected.points_lidar.size()) &&
              onePerPointOrNone(corrected.rings, corrected.points_lidar.size()),
          "a time and a ring for each point, or none");
  for (const float time_s : corrected.times_s) promise(std::isfinite(time_s), "times are finite");
  return 0;
}
