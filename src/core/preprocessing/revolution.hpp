// The time of one revolution of the head, from the azimuths and times of a sweep's points: the slope of azimuth over
// time. Works on a part of a revolution and on several revolutions.
// Points: m, lidar frame; times: s, one per point, from any zero.
// Failure: 0, if points or times are too few, or the rotation is not steady.
// Cost: about 0.1 ms (about 4000 points are used).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fail_aware {

double revolutionFromTimes(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<float>& times_s);

}  // namespace fail_aware
