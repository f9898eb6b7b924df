// What the nodelets show in rviz -> visualization_msgs, topic `markers`. Each nodelet publishes its own data:
//
// namespace            from              what
// seeds before         IcpPointToPoint   white arrows: the multiplex ICP's seeds. Their offsets from the measurement
//                                        are drawn 10 times as large
// seeds after                            arrows: where each seed ended, green: the best, orange: others
// corners              CornerSvd         this sweep's corners: the line and M white, J blue, N magenta
// corner planes                          their walls, one magenta rectangle a plane
// corner reference                       grey lines of 1 m: the corners that the sweep's corners are aligned with
// uncertainty          FailAwareMonitor  ellipses of 1, 2, 3 sigma: horizontal, accumulated since t1, at base_link
// alert limit                            a red circle: the error that counts as failure
// road ahead                             an orange line across the road: where the weak stretch ahead begins
// time to failure                        text over the vehicle: state, time, reasons
//
// Every marker has the given header (odometry frame, stamp of the sweep) and a fixed id, so it replaces the previous
// one. A marker with nothing to show deletes it. Markers vanish after kMarkerLifetime_s. Sizes are bounded; values that
// are not finite are left out. m, rad. Cost: microseconds.
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <Eigen/Core>
#include <vector>

#include "core/registration/corner_svd/corner.hpp"
#include "core/registration/icp_point_to_point.hpp"
#include "fail_aware_lidar_odometry/monitor.hpp"

namespace fail_aware {

constexpr double kMarkerLifetime_s = 1.0;
constexpr double kSeedMagnification = 10.0;
constexpr std::size_t kMaxSeedMarkers = 8;
constexpr std::size_t kMaxCornerMarkers = 200;

visualization_msgs::MarkerArray seedMarkers(const std::vector<SeedTrack>& tracks, const std_msgs::Header& header);

/// Shows the first kMaxCornerMarkers of each list.
visualization_msgs::MarkerArray cornerMarkers(const std::vector<Corner>& corners_odom,
                                              const std::vector<Corner>& reference_odom,
                                              const std_msgs::Header& header);

/// `covariance_odom`: of (x, y), m^2, in odom's axes. An invalid covariance has no ellipse.
visualization_msgs::MarkerArray uncertaintyMarkers(const Eigen::Matrix2d& covariance_odom,
                                                   const Eigen::Vector3d& position_odom, double alert_limit_m,
                                                   const std_msgs::Header& header);

/// A line across the road where the weak stretch ahead begins (WEAK_ROAD_AHEAD), drawn straight ahead. Deleted without
/// one.
visualization_msgs::Marker roadAheadMarker(const MonitorOutput& output, const Pose& T_odom_base,
                                           const std_msgs::Header& header);

visualization_msgs::Marker timeToFailureMarker(const MonitorOutput& output, const Eigen::Vector3d& position_odom,
                                               const std_msgs::Header& header);

}  // namespace fail_aware
