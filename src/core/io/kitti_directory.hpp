// A recorded drive in KITTI's folder layout.
//
//   DIR/velodyne/NNNNNN.bin                       float32 x y z intensity per point, sensor frame, m (required)
//     or DIR/velodyne_points/data/NNNNNNNNNN.bin  (KITTI raw), or DIR/NNNNNN.bin
//   DIR/times.txt                                 stamp of each scan, s, one per line; kept to the microsecond;
//                                                 as recorded: some may repeat or go back
//     or DIR/velodyne_points/timestamps.txt       (KITTI raw) date and time for each number, also of missing files;
//                                                 stamps count from the first scan's
//   DIR/stamps/NNNNNN.f32                         float32 per point: s from the sweep's start
//   DIR/rings/NNNNNN.u16                          uint16 per point: laser number, 0 = lowest beam
//
// DIR/velodyne and DIR/velodyne_points/data stand for DIR.
// One row per scan file, ordered by number; row i of times.txt belongs to file i, even if numbers are missing (dropped
// sweeps). Without both time files the stamp is number * nominal period (row * period if a name is not a number).
// KITTI's times are those at which the lidar faces forward: set the sweep timing's stamp_reference = mid, which shifts
// the point times from the sweep's start into [-T/2, T/2].
//
// open() throws InputError with one line naming file, line or counts. read() reports errors per scan, as data, and may
// run in several threads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/io/sweep_source.hpp"
#include "core/stamp_difference.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

/// A file in the folder of a drive that was not written to its end.
inline constexpr const char* kKittiUnfinished = "unfinished";

class KittiDirectory {
 public:
  /// nominal_period_s: used without times.txt.
  static KittiDirectory open(const std::string& directory, double nominal_period_s = kUsualPeriod_s);

  std::size_t size() const { return scan_paths_.size(); }
  const std::vector<std::string>& scanPaths() const { return scan_paths_; }
  const std::vector<double>& stamps() const { return stamps_s_; }
  bool hasPointTimes() const { return !stamps_folder_.empty(); }

  /// Scan i. Points that are not finite, or exactly (0, 0, 0) (no return), are dropped with their times and rings, and
  /// counted. The sweep always has its stamp, whatever the status; without points its arrays are empty.
  ReadResult read(std::size_t i, Sweep& sweep) const;

 private:
  KittiDirectory() = default;

  std::vector<std::string> scan_paths_;
  std::vector<double> stamps_s_;
  std::string stamps_folder_;  ///< empty: the folder does not exist
  std::string rings_folder_;
};

class KittiSweepSource : public SweepSource {
 public:
  /// Throws as KittiDirectory::open.
  explicit KittiSweepSource(const std::string& directory) : directory_(KittiDirectory::open(directory)) {}

  std::size_t size() const override { return directory_.size(); }
  void skip(std::size_t count) override { next_ += count; }
  ReadResult next(Sweep& sweep) override { return directory_.read(next_++, sweep); }
  std::string name() const override { return directory_.scanPaths().at(next_ - 1); }

 private:
  KittiDirectory directory_;
  std::size_t next_ = 0;
};

}  // namespace fail_aware
