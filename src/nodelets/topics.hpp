// The graph's topics, in the namespace of the nodelets.
#pragma once

#include <cstdint>
#include <string>

namespace fail_aware::topics {

inline constexpr std::uint32_t kQueue = 8;  ///< messages, for publishers and subscribers within the graph
/// Number of waiting sweeps: their clouds are in a buffer of kQueue, with the cloud in work and the next one.
inline constexpr int kMaxWaiting = static_cast<int>(kQueue) - 2;

inline constexpr const char* kClouds = "points";  ///< in: the lidar's clouds; odometry.launch remaps it
inline constexpr const char* kSetPose = "set_pose";
inline constexpr const char* kSweepPrediction = "sweep/prediction";
inline constexpr const char* kSweepPoints = "sweep/points";
inline constexpr const char* kSweepCheck = "sweep/check";
inline constexpr const char* kFilterState = "filter_state";
inline constexpr const char* kOdometry = "odometry";
inline constexpr const char* kPath = "path";
inline constexpr const char* kTimeToFailure = "time_to_failure";
inline constexpr const char* kMarkers = "markers";
inline constexpr const char* kLocalMap = "local_map";

/// `source`: kIcpPointToPoint and the like (core/types/measurement.hpp).
inline std::string ofMeasurement(const std::string& source) { return "measurement/" + source; }

}  // namespace fail_aware::topics
