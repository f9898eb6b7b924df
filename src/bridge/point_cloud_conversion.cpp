#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "core/types/corrected_sweep.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <optional>

#include "cloud_field.hpp"
#include "cloud_layout.hpp"
#include "core/preprocessing/point_times.hpp"
#include "core/types/sweep_points.hpp"

namespace fail_aware {

namespace {

using sensor_msgs::PointField;

constexpr std::initializer_list<const char*> kRingNames = {"ring", "line", "channel", "layer"};

/// Drivers' names for a point's time, the most usual first.
constexpr const char* kTimeNames[] = {"time", "t", "timestamp", "offset_time", "time_stamp", "ts"};

/// For a field with another name: whether it is likely a point's time.
bool soundsLikeTime(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* part : {"time", "stamp", "nsec"}) {
    if (name.find(part) != std::string::npos) return true;
  }
  return false;
}

/// A hundred times a large sweep; the clouds written from it stay below 2^32 bytes.
constexpr std::size_t kMaxPoints = 10000000;

float finiteOrZero(double value) {
  const auto number = static_cast<float>(value);
  return std::isfinite(number) ? number : 0.0f;
}

class Layout {
 public:
  explicit Layout(const sensor_msgs::PointCloud2& cloud) : cloud_(cloud) {
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
    const bool packed = cloud.height == 1 || cloud.data.size() == row * cloud.height;
    row_step_ = packed ? row : cloud.row_step;  // row_step has no meaning if packed, and some drivers leave it 0
    if (cloud.point_step == 0 || row_step_ < row) {
      refuse(CloudStatus::kBadLayout, "row_step " + std::to_string(cloud.row_step) + " is less than width " +
                                          std::to_string(cloud.width) + " * point_step " +
                                          std::to_string(cloud.point_step));
      return;
    }
    // the last row needs no padding
    const std::uint64_t needed = row_step_ * (cloud.height - 1) + row;
    if (cloud.data.size() < needed) {
      refuse(CloudStatus::kBadLayout,
             "data has " + std::to_string(cloud.data.size()) + " bytes, its layout needs " + std::to_string(needed));
      return;
    }
    x = coordinate("x");
    y = coordinate("y");
    z = coordinate("z");
    intensity = find({"intensity", "i"});
    ring = find(kRingNames);
    findTimes();
  }

  const CloudReadResult& result() const { return result_; }
  std::size_t count() const { return count_; }

  template <class Visitor>
  void forEachPoint(const Visitor& visitor) const {
    for (std::uint32_t r = 0; r < cloud_.height; ++r) {
      const std::uint8_t* point = cloud_.data.data() + r * row_step_;
      for (std::uint32_t c = 0; c < cloud_.width; ++c, point += cloud_.point_step) visitor(point);
    }
  }

  std::uint16_t ringAt(const std::uint8_t* point) const {
    const double number = ring.at(point);
    const bool valid = number >= 0.0 && number <= std::numeric_limits<std::uint16_t>::max();
    return valid ? static_cast<std::uint16_t>(number) : std::numeric_limits<std::uint16_t>::max();  // not a beam
  }

  CloudField x, y, z, intensity, ring;
  std::vector<CloudField> times;  ///< candidates for the points' time, the likeliest first; at most kMostTimes

 private:
  void refuse(CloudStatus status, const std::string& reason) {
    if (!result_.ok()) return;
    result_ = {status, reason};
  }

  CloudField find(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      for (const PointField& field : cloud_.fields) {
        if (field.name == name) return located(field);
      }
    }
    return {};
  }

  /// Empty, with the cloud refused, if the field does not lie within the point.
  CloudField located(const PointField& field) {
    const std::size_t size = sizeOf(field.datatype);
    if (size == 0 || field.offset > cloud_.point_step || size > cloud_.point_step - field.offset) {
      refuse(CloudStatus::kBadLayout, "field " + field.name + " (offset " + std::to_string(field.offset) +
                                          ", datatype " + std::to_string(field.datatype) +
                                          ") is not within point_step " + std::to_string(cloud_.point_step));
      return {};
    }
    return {field.name, field.offset, field.datatype, cloud_.is_bigendian != 0};
  }

  void findTimes() {
    constexpr std::size_t kMostTimes = 3;
    const auto add = [&](const PointField& field) {
      if (times.size() >= kMostTimes) return;
      if (const CloudField found = located(field)) times.push_back(found);
    };
    const auto isUsual = [](const std::string& name) {
      return std::find(std::begin(kTimeNames), std::end(kTimeNames), name) != std::end(kTimeNames);
    };
    for (const char* name : kTimeNames) {
      for (const PointField& field : cloud_.fields) {
        if (field.name == name) add(field);
      }
    }
    for (const PointField& field : cloud_.fields) {
      if (!isUsual(field.name) && soundsLikeTime(field.name)) add(field);
    }
  }

  CloudField coordinate(const char* name) {
    const CloudField field = find({name});
    if (!field) refuse(CloudStatus::kNoCoordinates, std::string("no field ") + name);
    if (field && !field.isFloat()) {
      refuse(CloudStatus::kNoCoordinates, std::string("field ") + name + " must be FLOAT32 or FLOAT64");
    }
    return field;
  }

  const sensor_msgs::PointCloud2& cloud_;
  CloudReadResult result_;
  std::size_t count_ = 0;
  std::uint64_t row_step_ = 0;
};

TimeNumber numberOf(const CloudField& field) {
  if (field.datatype == PointField::FLOAT32) return TimeNumber::kFloat32;
  return field.datatype == PointField::FLOAT64 ? TimeNumber::kFloat64 : TimeNumber::kInteger;
}

/// Reads the first field whose numbers are times and differ. Otherwise the first refused field gives the reason;
/// without one, the first field is read.
void readTimes(const std::vector<CloudField>& fields, const std::vector<std::vector<double>>& numbers, Sweep& sweep) {
  std::optional<std::size_t> refused;
  const auto read = [&](std::size_t i) {
    return readPointTimes(numbers[i], numberOf(fields[i]), fields[i].name, sweep);
  };
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (read(i)) return;
    if (!refused && !sweep.time_field.refused.empty()) refused = i;
  }
  if (!fields.empty()) read(refused.value_or(0));
}

}  // namespace

CloudReadResult readCloud(const sensor_msgs::PointCloud2& cloud, Sweep& sweep) {
  clearPoints(sweep);
  sweep.stamp_s = cloud.header.stamp.toSec();
  const Layout layout(cloud);
  if (!layout.result().ok()) return layout.result();
  const std::size_t count = layout.count();
  sweep.points_lidar.reserve(count);
  if (layout.intensity) sweep.intensities.reserve(count);
  if (layout.ring) sweep.rings.reserve(count);
  std::vector<std::vector<double>> times(layout.times.size());
  for (std::vector<double>& numbers : times) numbers.reserve(count);
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
    for (std::size_t i = 0; i < times.size(); ++i) times[i].push_back(layout.times[i].at(point));
  });
  if (sweep.empty()) return {CloudStatus::kEmpty, "no point is finite and not zero"};
  readTimes(layout.times, times, sweep);
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
  sweep.clear();
  const Layout layout(cloud);
  if (!layout.result().ok()) return layout.result();
  const CloudField time = layout.times.empty() ? CloudField() : layout.times.front();
  sweep.points_lidar.reserve(layout.count());
  if (layout.ring) sweep.rings.reserve(layout.count());
  if (time) sweep.times_s.reserve(layout.count());
  bool timed = false;
  layout.forEachPoint([&](const std::uint8_t* point) {
    const Eigen::Vector3f p(static_cast<float>(layout.x.at(point)), static_cast<float>(layout.y.at(point)),
                            static_cast<float>(layout.z.at(point)));
    const float time_s = time ? static_cast<float>(time.at(point)) : 0.0f;
    if (!p.allFinite() || !std::isfinite(time_s)) return;
    sweep.points_lidar.push_back(p);
    if (layout.ring) sweep.rings.push_back(layout.ringAt(point));
    if (!time) return;
    timed = timed || time_s != 0.0f;
    sweep.times_s.push_back(time_s);
  });
  if (!timed) sweep.times_s.clear();
  return {};
}

}  // namespace fail_aware
