// Every floating-point number of a message of any type: its own serializer goes through all its fields.
#pragma once

#include <ros/serialization.h>
#include <sensor_msgs/PointCloud2.h>

#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace fail_aware {

/// Stands for ROS's output stream.
class NumberCheck {
 public:
  std::size_t numbers = 0;
  std::string not_finite;  ///< which; empty: none

  // What the messages' generated serializers call.
  template <class T>
  void next(const T& value) {
    if constexpr (ros::message_traits::IsMessage<T>::value) {
      ros::serialization::serialize(*this, value);
    } else if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) not_finite += ' ' + std::to_string(numbers) + ": " + std::to_string(value);
      ++numbers;
    }
  }
  template <class T, std::size_t N>
  void next(const boost::array<T, N>& values) {
    for (const T& value : values) next(value);
  }
  template <class T>
  void next(const std::vector<T>& values) {
    for (const T& value : values) next(value);
  }
};

/// Which of a message's floating-point numbers, counted from 0 in the order of its fields, are not finite; empty: none.
template <class Message>
std::string numbersNotFinite(const Message& message) {
  NumberCheck check;
  ros::serialization::serialize(check, message);
  return check.not_finite;
}

/// Of the points, too: every field of FLOAT32.
inline std::string numbersNotFinite(const sensor_msgs::PointCloud2& cloud) {
  for (std::size_t point = 0; point + cloud.point_step <= cloud.data.size(); point += cloud.point_step) {
    for (const sensor_msgs::PointField& field : cloud.fields) {
      if (field.datatype != sensor_msgs::PointField::FLOAT32) continue;
      float value;
      std::memcpy(&value, cloud.data.data() + point + field.offset, sizeof value);
      if (!std::isfinite(value)) return ' ' + field.name + " of point " + std::to_string(point / cloud.point_step);
    }
  }
  return "";
}

}  // namespace fail_aware
