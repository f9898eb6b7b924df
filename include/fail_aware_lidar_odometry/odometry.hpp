// The odometry as a library, without ROS: one sweep in, one result out.
//
//   fail_aware::Odometry odometry({}, 2);        // profile "default", 2 threads
//   odometry.startRedundant();                   // t1: the first sweep whose motion is observed
//   fail_aware::Result result = odometry.step(std::move(sweep));
//
// Deterministic: the same sweeps give the same bits, for any number of threads, offline and on the vehicle. A sweep
// that cannot be used is no error: Result says what became of it. Not for use by several threads at once; several
// objects may run beside each other. Example: examples/minimal.cpp.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "fail_aware_lidar_odometry/parameters.hpp"
#include "fail_aware_lidar_odometry/result.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"

namespace fail_aware {

class OdometryPipeline;

class Odometry {
 public:
  /// Throws std::runtime_error (a file cannot be found or read) or std::invalid_argument (a key or a value): one line.
  explicit Odometry(const Parameters& parameters = {}, int threads = 2);
  ~Odometry();
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;

  /// Sweeps come in the order of their stamps. Points that are not finite or exactly zero (no return) are left out;
  /// without points the vehicle model carries the pose. Throws std::invalid_argument if the stamp is not finite, or if
  /// an array is neither empty nor as long as the points.
  Result step(Sweep sweep);

  /// t1: from the next sweep that is not before `from_stamp_s`, the odometry serves as the localisation, and the time
  /// to failure counts the error since then. While no motion is measured yet, t1 is the first sweep that is observed.
  void startRedundant(double from_stamp_s = std::numeric_limits<double>::lowest());
  /// Another localisation serves again: no t1, no time to failure.
  void stopRedundant();

  /// Starts again as a new object does; the next sweep is the first.
  void reset();

  /// Sets the pose of base_link in odom with the next sweep. Returns the reason of a refusal; empty: accepted. See
  /// Result::pose_set_refused.
  std::string setPose(const ExternalPose& pose);

  /// A source of poses from elsewhere that join the fusion, each no later than the sweep it is for and within
  /// `tolerance_s` of it.
  void addSource(const std::string& name, double tolerance_s);
  /// Returns why the pose cannot be used; empty: it waits for its sweep.
  std::string offer(const std::string& source, const ExternalPose& pose);

 private:
  std::unique_ptr<OdometryPipeline> pipeline_;
};

}  // namespace fail_aware
