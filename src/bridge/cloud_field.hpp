// A field of a PointCloud2's points: any datatype, any offset, either byte order.
#pragma once

#include <sensor_msgs/PointField.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>

namespace fail_aware {

/// Bytes of a datatype; 0: there is no such datatype.
inline std::size_t sizeOf(std::uint8_t datatype) {
  switch (datatype) {
    case sensor_msgs::PointField::INT8:
    case sensor_msgs::PointField::UINT8: return 1;
    case sensor_msgs::PointField::INT16:
    case sensor_msgs::PointField::UINT16: return 2;
    case sensor_msgs::PointField::INT32:
    case sensor_msgs::PointField::UINT32:
    case sensor_msgs::PointField::FLOAT32: return 4;
    case sensor_msgs::PointField::FLOAT64: return 8;
  }
  return 0;
}

template <class T>
double loadNumber(const std::uint8_t* at, bool big_endian) {
  T value;
  if (big_endian) {
    std::uint8_t bytes[sizeof(T)];
    std::reverse_copy(at, at + sizeof(T), bytes);
    std::memcpy(&value, bytes, sizeof value);
  } else {
    std::memcpy(&value, at, sizeof value);
  }
  return static_cast<double>(value);
}

/// A field that lies within the point.
struct CloudField {
  std::string name;
  std::size_t offset = 0;
  std::uint8_t datatype = 0;
  bool big_endian = false;

  explicit operator bool() const { return !name.empty(); }
  bool isFloat() const {
    return datatype == sensor_msgs::PointField::FLOAT32 || datatype == sensor_msgs::PointField::FLOAT64;
  }

  double at(const std::uint8_t* point) const {
    const std::uint8_t* value = point + offset;
    switch (datatype) {
      case sensor_msgs::PointField::INT8: return loadNumber<std::int8_t>(value, big_endian);
      case sensor_msgs::PointField::UINT8: return loadNumber<std::uint8_t>(value, big_endian);
      case sensor_msgs::PointField::INT16: return loadNumber<std::int16_t>(value, big_endian);
      case sensor_msgs::PointField::UINT16: return loadNumber<std::uint16_t>(value, big_endian);
      case sensor_msgs::PointField::INT32: return loadNumber<std::int32_t>(value, big_endian);
      case sensor_msgs::PointField::UINT32: return loadNumber<std::uint32_t>(value, big_endian);
      case sensor_msgs::PointField::FLOAT32: return loadNumber<float>(value, big_endian);
      default: return loadNumber<double>(value, big_endian);
    }
  }
};

}  // namespace fail_aware
