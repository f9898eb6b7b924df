#include "driver_clouds.hpp"

#include <boost/make_shared.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace fail_aware {

namespace {

/// s from the middle of the sweep, of each point, by its column (the head turns clockwise from the rear).
std::vector<float> columnTimes(const Sweep& sweep) {
  std::vector<float> times;
  for (const Eigen::Vector3f& p : sweep.points_lidar) {
    const double yaw = std::atan2(p.y(), p.x());
    times.push_back(static_cast<float>(kSweepPeriod_s * (0.5 * (1.0 - yaw / M_PI) - 0.5)));
  }
  return times;
}

sensor_msgs::PointField field(const char* name, std::uint32_t offset, std::uint8_t datatype) {
  sensor_msgs::PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = datatype;
  field.count = 1;
  return field;
}

}  // namespace

sensor_msgs::PointCloud2Ptr velodyneCloud(int i, const std::function<float(float)>& time_of) {
  const Sweep sweep = streetSweep(i);
  const std::vector<float> times = columnTimes(sweep);
  const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  using Field = sensor_msgs::PointField;
  cloud->fields = {field("x", 0, Field::FLOAT32),    field("y", 4, Field::FLOAT32),
                   field("z", 8, Field::FLOAT32),    field("intensity", 12, Field::FLOAT32),
                   field("ring", 16, Field::UINT16), field("time", 18, Field::FLOAT32)};
  cloud->point_step = 22;
  cloud->height = 1;
  cloud->width = static_cast<std::uint32_t>(sweep.size());
  cloud->row_step = cloud->width * cloud->point_step;
  cloud->is_dense = true;
  cloud->data.resize(cloud->row_step);
  for (std::size_t k = 0; k < sweep.size(); ++k) {
    std::uint8_t* point = cloud->data.data() + k * cloud->point_step;
    const float time = time_of(times[k]);
    std::memcpy(point, sweep.points_lidar[k].data(), 12);
    std::memcpy(point + 12, &sweep.intensities[k], 4);
    std::memcpy(point + 16, &sweep.rings[k], 2);
    std::memcpy(point + 18, &time, 4);
  }
  cloud->header.frame_id = "velodyne";
  cloud->header.stamp = stampOfSweep(i);
  return cloud;
}

sensor_msgs::PointCloud2Ptr kittiCloud(int i) {
  const sensor_msgs::PointCloud2Ptr cloud = streetCloud(i);
  cloud->fields.resize(4);
  cloud->fields[3].name = "i";
  const std::vector<std::uint8_t> data = cloud->data;
  const std::size_t step = cloud->point_step;
  cloud->data.resize(16 * cloud->width);
  for (std::uint32_t k = 0; k < cloud->width; ++k) std::memcpy(&cloud->data[16 * k], &data[step * k], 16);
  cloud->point_step = 16;
  cloud->row_step = 16 * cloud->width;
  return cloud;
}

sensor_msgs::PointCloud2Ptr organisedCloud(int i) {
  const Sweep sweep = streetSweep(i);
  std::vector<Eigen::Vector3f> points;
  const Eigen::Vector3f nan = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (const Eigen::Vector3f& p : sweep.points_lidar) {
    points.push_back(p);
    if (points.size() % 10 == 9) points.push_back(nan);
  }
  constexpr std::size_t kWidth = 100, kStep = 16;
  while (points.size() % kWidth != 0) points.push_back(nan);
  const sensor_msgs::PointCloud2Ptr cloud = kittiCloud(i);
  cloud->is_dense = false;
  cloud->width = kWidth;
  cloud->height = static_cast<std::uint32_t>(points.size() / kWidth);
  cloud->row_step = kWidth * kStep + 8;
  cloud->data.assign(static_cast<std::size_t>(cloud->height) * cloud->row_step, 0xff);
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::memcpy(&cloud->data[(k / kWidth) * cloud->row_step + (k % kWidth) * kStep], points[k].data(), 12);
  }
  return cloud;
}

}  // namespace fail_aware
