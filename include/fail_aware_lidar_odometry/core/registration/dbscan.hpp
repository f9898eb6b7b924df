// DBSCAN in the plane: clusters are what dense points connect (paper, section "SVD Cornering Algorithm", Clustering).
//
// A point with at least `min_points` points within `eps_m` of it (itself among them, distance <= eps_m) is a core
// point; core points within eps_m of each other share a cluster; a point within eps_m of a core point joins the
// nearest one's cluster (the only freedom the definition leaves); the rest is noise.
// Exact, deterministic. Clusters are numbered in the order of their first core point.
// Cost: a grid of cells in which all points are mutual neighbours; O(n log n) plus the comparisons in sparse cells.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fail_aware {

/// A label per point, -1 = noise. Points in m; points not finite (or beyond 1e8 eps) are noise. A bad parameter
/// (eps_m not > 0) makes everything noise.
/// `weights`: empty, or how many points each point stands for: a cell's mean with its count.
std::vector<int> dbscan2d(const std::vector<Eigen::Vector2f>& points_xy, double eps_m, int min_points,
                          const std::vector<int>& weights = {});

}  // namespace fail_aware
