// PointCloud2 of any layout -> Sweep, CorrectedSweep.
#include <fuzzer/FuzzedDataProvider.h>
#include <sensor_msgs/PointCloud2.h>

#include <cmath>

#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fuzz_support.hpp"

using namespace fail_aware;

namespace {

sensor_msgs::PointCloud2 cloudOf(FuzzedDataProvider& input) {
  const char* const names[] = {"x", "y", "z", "intensity", "i", "ring", "time", "t", "timestamp", ""};
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp =
      ros::Time(input.ConsumeIntegral<std::uint32_t>(), input.ConsumeIntegral<std::uint32_t>() % 1000000000u);
  cloud.is_bigendian = input.ConsumeProbability<float>() > 0.95f;
  // Mostly small numbers, so that many layouts fit; now and then any.
  const auto number = [&] {
    return input.ConsumeProbability<float>() > 0.9f ? input.ConsumeIntegral<std::uint32_t>()
                                                    : input.ConsumeIntegralInRange<std::uint32_t>(0, 40);
  };
  cloud.height = number();
  cloud.width = number();
  cloud.point_step = number();
  cloud.row_step = input.ConsumeBool() ? cloud.width * cloud.point_step : number();
  for (int i = input.ConsumeIntegralInRange<int>(0, 12); i > 0; --i) {
    sensor_msgs::PointField field;
    field.name = input.PickValueInArray(names);
    field.offset = number();
    field.datatype = input.ConsumeIntegralInRange<std::uint8_t>(0, 9);
    field.count = number();
    cloud.fields.push_back(field);
  }
  cloud.data = input.ConsumeRemainingBytes<std::uint8_t>();
  return cloud;
}

template <class Numbers>
bool onePerPointOrNone(const Numbers& numbers, std::size_t points) {
  return numbers.empty() || numbers.size() == points;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
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
