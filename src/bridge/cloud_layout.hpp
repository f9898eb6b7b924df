// The layout of the clouds that this package writes.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <initializer_list>

namespace fail_aware {

inline void addField(const char* name, std::uint8_t datatype, sensor_msgs::PointCloud2& cloud) {
  sensor_msgs::PointField field;
  field.name = name;
  field.offset = cloud.point_step;
  field.datatype = datatype;
  field.count = 1;
  cloud.fields.push_back(field);
  cloud.point_step += static_cast<std::uint32_t>(sizeof(float));  // for every datatype, so the next field is aligned
}

/// One row of `count` points with these consecutive FLOAT32 fields, then optionally `ring`, UINT16. Data: all zero.
inline void layOut(std::initializer_list<const char*> names, bool with_ring, std::size_t count,
                   sensor_msgs::PointCloud2& cloud) {
  cloud.fields.clear();
  cloud.point_step = 0;
  for (const char* name : names) addField(name, sensor_msgs::PointField::FLOAT32, cloud);
  if (with_ring) addField("ring", sensor_msgs::PointField::UINT16, cloud);
  cloud.is_bigendian = false;
  cloud.is_dense = true;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(count);
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.assign(cloud.row_step, 0);
}

}  // namespace fail_aware
