// A recorded drive, sweep by sweep in the order of recording, independent of the storage format.
//
// next() reports errors per sweep, as data. Not thread-safe.
#pragma once

#include <cstddef>
#include <string>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

enum class ReadStatus {
  kOk,
  kSideFileUnusable,  ///< points are good; point times or rings are missing or of another number, and are left out
  kOtherFrame,        ///< of another lidar than the first sweep: no sweep of this drive
  kNoPoints           ///< unreadable, or no point is usable
};

struct ReadResult {
  ReadStatus status = ReadStatus::kOk;
  std::string message;  ///< one line naming the sweep; empty when kOk

  bool hasPoints() const { return status == ReadStatus::kOk || status == ReadStatus::kSideFileUnusable; }
};

class SweepSource {
 public:
  virtual ~SweepSource() = default;

  /// Number of sweeps of the whole drive.
  virtual std::size_t size() const = 0;
  /// Skips `count` sweeps. Must not go beyond the end.
  virtual void skip(std::size_t count) = 0;
  /// The sweep always has its stamp, whatever the status; without points its arrays are empty. Not beyond the end.
  virtual ReadResult next(Sweep& sweep) = 0;
  /// Name of the last sweep read, for messages: its file, or its position in the file.
  virtual std::string name() const = 0;
};

}  // namespace fail_aware
