// DBSCAN in the plane: clusters connected by dense points (paper, section "SVD Cornering Algorithm", Clustering).
//
// A point with at least `min_points` points within `eps_m` (itself included, distance <= eps_m) is a core point. Core
// points within eps_m of each other share a cluster. A point within eps_m of a core point joins the cluster of the
// nearest core point (the only choice that the definition leaves open). All other points are noise.
// Exact and deterministic. Clusters are numbered in the order of their first core point.
// Cost: a grid of cells whose points are all mutual neighbours; O(n log n) plus the comparisons in sparse cells.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fail_aware {

/// Returns a label per point, -1 = noise. Points in m; points that are not finite (or beyond 1e8 eps) are noise.
/// eps_m > 0. `weights`: empty, or the number of points that each point represents (a cell's mean with its count).
std::vector<int> dbscan2d(const std::vector<Eigen::Vector2f>& points_xy, double eps_m, int min_points,
                          const std::vector<int>& weights = {});

}  // namespace fail_aware
