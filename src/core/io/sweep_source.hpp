// A recorded drive, sweep by sweep in the order of recording, whatever it is stored in.
//
// next() reports per sweep, as data. Not for several threads.
#pragma once

#include <cstddef>
#include <string>

#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

enum class ReadStatus {
  kOk,
  kSideFileUnusable,  ///< points are good, but stamps or rings are missing or of another count, and left out
  kUnreadable,
  kTruncated,     ///< the size is not a multiple of a point's
  kEmpty,         ///< zero bytes
  kNoFinitePoint  ///< every point was dropped
};

const char* toString(ReadStatus status);

struct ReadResult {
  ReadStatus status = ReadStatus::kOk;
  std::string message;  ///< one line naming the sweep; empty when kOk

  bool hasPoints() const { return status == ReadStatus::kOk || status == ReadStatus::kSideFileUnusable; }
};

class SweepSource {
 public:
  virtual ~SweepSource() = default;

  /// Of the whole drive, read or not.
  virtual std::size_t size() const = 0;
  /// Passes over some sweeps, not beyond the end.
  virtual void skip(std::size_t count) = 0;
  /// Whatever the status, the sweep has its stamp; without points its arrays are empty. Not beyond the end.
  virtual ReadResult next(Sweep& sweep) = 0;
  /// The sweep read last, for people: its file, or its place in the file.
  virtual std::string name() const = 0;
};

}  // namespace fail_aware
