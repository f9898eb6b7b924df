// The time of one turn of the head, from the azimuths and times of a sweep's points: the slope of azimuth over time.
// Works on a part of a turn and on several turns. Points: m, lidar frame; times: s, one a point, from any zero.
// Failure: 0, where points or times are too few, or do not turn steadily. Cost: about 0.1 ms (some 4000 points are used).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fail_aware {

double revolutionFromTimes(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<float>& times_s);

}  // namespace fail_aware
