#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "cloud_layout.hpp"

namespace fail_aware {

namespace {

using sensor_msgs::PointField;

std::size_t sizeOf(std::uint8_t datatype) {
  switch (datatype) {
    case PointField::INT8:
    case PointField::UINT8: return 1;
    case PointField::INT16:
    case PointField::UINT16: return 2;
    case PointField::INT32:
    case PointField::UINT32:
    case PointField::FLOAT32: return 4;
    case PointField::FLOAT64: return 8;
  }
  return 0;
}

template <class T>
double load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

/// A field that lies within the point.
struct Field {
  const char* name = nullptr;
  std::size_t offset = 0;
  std::uint8_t datatype = 0;

  explicit operator bool() const { return name != nullptr; }
  bool isFloat() const { return datatype == PointField::FLOAT32 || datatype == PointField::FLOAT64; }

  double at(const std::uint8_t* point) const {
    const std::uint8_t* value = point + offset;
    switch (datatype) {
      case PointField::INT8: return load<std::int8_t>(value);
      case PointField::UINT8: return load<std::uint8_t>(value);
      case PointField::INT16: return load<std::int16_t>(value);
      case PointField::UINT16: return load<std::uint16_t>(value);
      case PointField::INT32: return load<std::int32_t>(value);
      case PointField::UINT32: return load<std::uint32_t>(value);
      case PointField::FLOAT32: return load<float>(value);
      default: return load<double>(value);
    }
  }
};

/// A hundred times a large sweep; what is written of them stays below 2^32 bytes.
constexpr std::size_t kMaxPoints = 10000000;

float finiteOrZero(double value) {
  const auto number = static_cast<float>(value);
  return std::isfinite(number) ? number : 0.0f;
}

class Layout {
 public:
  explicit Layout(const sensor_msgs::PointCloud2& cloud) : cloud_(cloud) {
    if (cloud.is_bigendian) {
      refuse(CloudStatus::kBigEndian, "big-endian clouds are not read");
      return;
    }
    count_ = static_cast<std::size_t>(cloud.width) * cloud.height;
    if (count_ == 0) {
      refuse(CloudStatus::kEmpty, "no points");
      return;
    }
    if (count_ > kMaxPoints) {
      refuse(CloudStatus::kBadLayout, std::to_string(count_) + " points, more than " + std::to_string(kMaxPoints));
      return;
    }
    const std::uint64_t row = static_cast<std::uint64_t>(cloud.width) * cloud.point_step;
    if (cloud.point_step == 0 || cloud.row_step < row) {
      refuse(CloudStatus::kBadLayout, "row_step " + std::to_string(cloud.row_step) + " is less than width " +
                                          std::to_string(cloud.width) + " * point_step " +
                                          std::to_string(cloud.point_step));
      return;
    }
    // the last row needs no padding
    const std::uint64_t needed = static_cast<std::uint64_t>(cloud.row_step) * (cloud.height - 1) + row;
    if (cloud.data.size() < needed) {
      refuse(CloudStatus::kBadLayout,
             "data has " + std::to_string(cloud.data.size()) + " bytes, its layout needs " + std::to_string(needed));
      return;
    }
    x = coordinate("x");
    y = coordinate("y");
    z = coordinate("z");
    intensity = find({"intensity", "i"});
    ring = find({"ring"});
    time = find({"time", "t", "timestamp"});
  }

  const CloudReadResult& result() const { return result_; }
  std::size_t count() const { return count_; }

  template <class Visitor>
  void forEachPoint(const Visitor& visitor) const {
    for (std::uint32_t r = 0; r < cloud_.height; ++r) {
      const std::uint8_t* point = cloud_.data.data() + static_cast<std::size_t>(r) * cloud_.row_step;
      for (std::uint32_t c = 0; c < cloud_.width; ++c, point += cloud_.point_step) visitor(point);
    }
  }

  std::uint16_t ringAt(const std::uint8_t* point) const {
    const double number = ring.at(point);
    const bool valid = number >= 0.0 && number <= std::numeric_limits<std::uint16_t>::max();
    return valid ? static_cast<std::uint16_t>(number) : std::numeric_limits<std::uint16_t>::max();  // no beam
  }

  Field x, y, z, intensity, ring, time;

 private:
  void refuse(CloudStatus status, const std::string& reason) {
    if (!result_.ok()) return;
    result_ = {status, reason};
  }

  Field find(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      for (const PointField& field : cloud_.fields) {
        if (field.name != name) continue;
        const std::size_t size = sizeOf(field.datatype);
        if (size == 0 || field.offset > cloud_.point_step || size > cloud_.point_step - field.offset) {
          refuse(CloudStatus::kBadLayout, "field " + field.name + " (offset " + std::to_string(field.offset) +
                                              ", datatype " + std::to_string(field.datatype) +
                                              ") is not within point_step " + std::to_string(cloud_.point_step));
          return {};
        }
        return {name, field.offset, field.datatype};
      }
    }
    return {};
  }

  Field coordinate(const char* name) {
    const Field field = find({name});
    if (!field) refuse(CloudStatus::kNoCoordinates, std::string("no field ") + name);
    if (field && !field.isFloat()) {
      refuse(CloudStatus::kNoCoordinates, std::string("field ") + name + " must be FLOAT32 or FLOAT64");
    }
    return field;
  }

  const sensor_msgs::PointCloud2& cloud_;
  CloudReadResult result_;
  std::size_t count_ = 0;
};

void clear(Sweep& sweep) {
  sweep.points_lidar.clear();
  sweep.intensities.clear();
  sweep.times_s.clear();
  sweep.rings.clear();
  sweep.points_dropped = 0;
}

}  // namespace

CloudReadResult readCloud(const sensor_msgs::PointCloud2& cloud, Sweep& sweep) {
  clear(sweep);
  sweep.stamp_s = cloud.header.stamp.toSec();
  const Layout layout(cloud);
  if (!layout.result().ok()) return layout.result();
  const std::size_t count = layout.count();
  sweep.points_lidar.reserve(count);
  if (layout.intensity) sweep.intensities.reserve(count);
  if (layout.ring) sweep.rings.reserve(count);
  if (layout.time) sweep.times_s.reserve(count);
  const double time_unit_s = layout.time.isFloat() ? 1.0 : 1e-9;
  constexpr double kAbsolute_s = 1e6;  // a sweep's own times are far below, a clock's far above
  layout.forEachPoint([&](const std::uint8_t* point) {
    const Eigen::Vector3f p(static_cast<float>(layout.x.at(point)), static_cast<float>(layout.y.at(point)),
                            static_cast<float>(layout.z.at(point)));
    if (!isUsablePoint(p)) {
      ++sweep.points_dropped;
      return;
    }
    sweep.points_lidar.push_back(p);
    if (layout.intensity) sweep.intensities.push_back(finiteOrZero(layout.intensity.at(point)));
    if (layout.ring) sweep.rings.push_back(layout.ringAt(point));
    if (layout.time) {
      double time_s = time_unit_s * layout.time.at(point);
      if (layout.time.datatype == PointField::FLOAT64 && std::abs(time_s) > kAbsolute_s) time_s -= sweep.stamp_s;
      sweep.times_s.push_back(static_cast<float>(time_s));
    }
  });
  if (sweep.empty()) return {CloudStatus::kEmpty, "no point is finite and not zero"};
  return {};
}

void writeCloud(const CorrectedSweep& sweep, const std::vector<float>& intensities, sensor_msgs::PointCloud2& cloud) {
  const std::size_t count = sweep.points_lidar.size();
  const bool has_ring = sweep.rings.size() == count;
  layOut({"x", "y", "z", "intensity", "time"}, has_ring, count, cloud);
  const bool has_intensity = intensities.size() == count, has_time = sweep.times_s.size() == count;
  std::uint8_t* out = cloud.data.data();
  for (std::size_t i = 0; i < count; ++i, out += cloud.point_step) {
    const Eigen::Vector3f& p = sweep.points_lidar[i];
    const float values[] = {p.x(), p.y(), p.z(), has_intensity ? intensities[i] : 0.0f,
                            has_time ? sweep.times_s[i] : 0.0f};
    std::memcpy(out, values, sizeof values);
    if (has_ring) std::memcpy(out + sizeof values, &sweep.rings[i], sizeof(std::uint16_t));
  }
}

void writePoints(const std::vector<Eigen::Vector3d>& points_odom, const Pose& T_odom_seen,
                 sensor_msgs::PointCloud2& cloud) {
  layOut({"x", "y", "z"}, false, points_odom.size(), cloud);
  const Pose T_seen_odom = T_odom_seen.inverse();
  std::uint8_t* out = cloud.data.data();
  for (const Eigen::Vector3d& point : points_odom) {
    const Eigen::Vector3f p = (T_seen_odom * point).cast<float>();
    std::memcpy(out, p.data(), cloud.point_step);
    out += cloud.point_step;
  }
}

CloudReadResult readCorrectedCloud(const sensor_msgs::PointCloud2& cloud, CorrectedSweep& sweep) {
  sweep.stamp_s = cloud.header.stamp.toSec();
  sweep.points_lidar.clear();
  sweep.times_s.clear();
  sweep.rings.clear();
  const Layout layout(cloud);
  if (!layout.result().ok()) return layout.result();
  sweep.points_lidar.reserve(layout.count());
  if (layout.ring) sweep.rings.reserve(layout.count());
  if (layout.time) sweep.times_s.reserve(layout.count());
  bool timed = false;
  layout.forEachPoint([&](const std::uint8_t* point) {
    const Eigen::Vector3f p(static_cast<float>(layout.x.at(point)), static_cast<float>(layout.y.at(point)),
                            static_cast<float>(layout.z.at(point)));
    const float time_s = layout.time ? static_cast<float>(layout.time.at(point)) : 0.0f;
    if (!p.allFinite() || !std::isfinite(time_s)) return;
    sweep.points_lidar.push_back(p);
    if (layout.ring) sweep.rings.push_back(layout.ringAt(point));
    if (!layout.time) return;
    timed = timed || time_s != 0.0f;
    sweep.times_s.push_back(time_s);
  });
  if (!timed) sweep.times_s.clear();
  return {};
}

}  // namespace fail_aware
