// sensor_msgs/PointCloud2 <-> sweeps.
//
// Read: x y z (FLOAT32 or FLOAT64), and where they are there intensity | i, ring | line | channel | layer, and a time,
// of any numeric type at any offset, aligned or not, of either byte order. Points that are not finite or exactly zero
// are left out and counted. A ring that is none: 65535. row_step is not looked at where it has no meaning (one row, or
// rows without padding).
// Time: time | t | timestamp | offset_time | time_stamp | ts, else a field whose name holds "time", "stamp" or "nsec".
// Of several, the first whose numbers are times of a sweep and differ. Unit and clock: core/preprocessing/point_times.hpp.
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
  kEmpty,          ///< no point, or none that could be used
  kNoCoordinates,  ///< x, y or z is missing or is no FLOAT32, FLOAT64
  kBadLayout       ///< point_step, row_step, data or a field's place contradict each other
};

struct CloudReadResult {
  CloudStatus status = CloudStatus::kOk;
  std::string reason;  ///< for people; empty when kOk

  bool ok() const { return status == CloudStatus::kOk; }
};

/// `sweep` is overwritten, its arrays' memory reused; the stamp is set in any case.
CloudReadResult readCloud(const sensor_msgs::PointCloud2& cloud, Sweep& sweep);

/// x y z intensity time, FLOAT32, point_step 20; where the sweep has rings also ring, UINT16, point_step 24.
/// `intensities`: one a point, or empty (then 0). Times: relative to the stamp. Header left to the caller.
void writeCloud(const CorrectedSweep& sweep, const std::vector<float>& intensities, sensor_msgs::PointCloud2& cloud);

/// x y z, FLOAT32, point_step 12, as seen from where `T_odom_seen` is: exact however far from odom's origin that lies.
/// Header left to the caller.
void writePoints(const std::vector<Eigen::Vector3d>& points_odom, const Pose& T_odom_seen,
                 sensor_msgs::PointCloud2& cloud);

/// Back from writeCloud's cloud; times that are all zero mean no timing.
CloudReadResult readCorrectedCloud(const sensor_msgs::PointCloud2& cloud, CorrectedSweep& sweep);

}  // namespace fail_aware
