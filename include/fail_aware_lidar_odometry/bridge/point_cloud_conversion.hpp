// sensor_msgs/PointCloud2 <-> sweeps.
//
// Reads x y z (FLOAT32 or FLOAT64) and, if present, intensity | i, ring | line | channel | layer, and a time, of any
// numeric type, at any offset, aligned or not, in either byte order. Points that are not finite or exactly zero are
// dropped and counted. An invalid ring becomes 65535. row_step is ignored where it has no meaning (one row, or rows
// without padding).
// Time: time | t | timestamp | offset_time | time_stamp | ts, otherwise a field whose name contains "time", "stamp" or
// "nsec". Of several fields the first one counts whose numbers are times of a sweep and differ. Unit and clock:
// core/preprocessing/point_times.hpp.
// Failure: status and a reason; the sweep is then empty. Never reads out of bounds. Cost: one pass over the cloud.
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

struct CorrectedSweep;

enum class CloudStatus {
  kOk,
  kEmpty,          ///< no point, or no usable one
  kNoCoordinates,  ///< x, y or z is missing or is neither FLOAT32 nor FLOAT64
  kBadLayout       ///< point_step, row_step, data or a field's offset contradict each other
};

struct CloudReadResult {
  CloudStatus status = CloudStatus::kOk;
  std::string reason;  ///< human-readable; empty when kOk

  bool ok() const { return status == CloudStatus::kOk; }
};

/// Overwrites `sweep` and reuses its memory; the stamp is always set.
CloudReadResult readCloud(const sensor_msgs::PointCloud2& cloud, Sweep& sweep);

/// x y z intensity time, FLOAT32, point_step 20; if the sweep has rings also ring, UINT16, point_step 24.
/// `intensities`: one per point, or empty (then 0). Times: relative to the stamp. The caller sets the header.
void writeCloud(const CorrectedSweep& sweep, const std::vector<float>& intensities, sensor_msgs::PointCloud2& cloud);

/// x y z, FLOAT32, point_step 12, relative to `T_odom_seen`, so the points stay exact however far this pose is from
/// odom's origin. The caller sets the header.
void writePoints(const std::vector<Eigen::Vector3d>& points_odom, const Pose& T_odom_seen,
                 sensor_msgs::PointCloud2& cloud);

/// Reads a cloud of writeCloud; times that are all zero mean no timing.
CloudReadResult readCorrectedCloud(const sensor_msgs::PointCloud2& cloud, CorrectedSweep& sweep);

}  // namespace fail_aware
