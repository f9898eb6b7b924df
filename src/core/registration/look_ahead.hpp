// Looks ahead: how well poses further along the road will be observed along it (not in the paper).
//
// A lidar sees some 80 m of the road ahead, a tunnel's mouth with the smooth walls behind it. A sweep that is taken
// there registers against the walls near there. So for poses every 10 m along the path of constant curvature: of what
// the wall patches within 25 m say of the horizontal position, the ratio along the path. It hardly depends on how
// densely the walls are seen from here. What the errors of the normals add by chance does not count. On roads the ratio
// is 0.02 to 0.3, between the niches of a tunnel 0.001.
//
// The result is the weakest stretch of three poses: the best of the three counts. It begins 20 to 70 m ahead; the sweep
// itself registers against what is nearer, and inside a tunnel the distance stays 20 m. Poses that few patches surround
// say nothing (a bend, fog, few beams, an open field).
// Frame: odom. Cost: a plane query for every second point of the sweep, as half an iteration of the ICP.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/icp_point_to_plane.hpp"
#include "core/types/information_ahead.hpp"

namespace fail_aware {

/// params: which pairs count, and how much. points_cog: of the sweep, about T_odom_cog; twist_cog: m/s, rad/s, in the
/// axes of the centre of gravity.
InformationAhead lookAhead(const IcpPointToPlane::Params& params, const std::vector<Eigen::Vector3f>& points_cog,
                           const VoxelMap& map, const Pose& T_odom_cog, const Vector6d& twist_cog);

}  // namespace fail_aware
