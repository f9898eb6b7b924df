// Corners of walls in a sweep (paper, section "SVD Cornering Algorithm", Plane Extraction to Synthetic Points).
//
//   points in cells of an (x, y) grid with >= min_beams_per_cell beams -> DBSCAN -> clusters with enough points
//   -> RANSAC plane, again on its outliers -> pairs at an angle in [45, 135] deg -> intersection line -> M, J, N
// Input: a corrected sweep in any frame fixed to the vehicle (lidar or CoG), z roughly up, m; and the predicted
// rotation of this frame in odom, which defines the vertical and, for N, the longitudinal direction.
// Output: corners in the points' frame.
//
// Beams: the number of beams of a cell is the number of its distinct heights, in steps of height_step_m (ground gives
// one or two at any density), counted modulo 64.
// DBSCAN over every kept point is the paper's method (`cluster_cells` false). By default DBSCAN runs over the mean
// point of each cell, weighted by its count. The clusters are the same if gaps and density differ from the thresholds
// by more than the cell size; the cost is a twentieth. All other steps use all points. A cluster may hold a row of
// houses: up to max_planes_per_cluster planes are searched (paper: 2). A pair is a corner only if both planes have
// points within max_corner_gap_m of their line; this excludes two distant walls.
//
// Failure: an empty vector; never a corner that is not finite.
// Cost: three passes over the points and a few more over those of walls: 2 ms for 125,000 points in a town, one core
// (paper's settings: 5..8 ms).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/parameters/check.hpp"
#include "core/registration/corner_svd/corner.hpp"
#include "core/registration/corner_svd/ransac_plane.hpp"

namespace fail_aware {

class CornerExtractor {
 public:
  struct Params {
    double cell_m = 0.4;  ///< side of a cell in the plane: the points of all beams on a wall fall into one cell
    /// nearest points used, horizontal, from the frame's origin: nearer points belong to the vehicle
    double min_range_m = 2.0;
    double max_range_m = 50.0;
    int min_beams_per_cell = 10;  ///< paper: 20, which walls beyond about 20 m cannot reach
    /// points this far apart in height belong to different beams: less than the beams' spacing at 5 m
    double height_step_m = 0.03;
    double dbscan_eps_m = 0.7;   ///< distance of neighbours: a little more than the diagonal of a cell
    int dbscan_min_points = 50;  ///< a point with fewer neighbours is no core point
    bool cluster_cells = true;
    int min_cluster_points = 300;  ///< smaller clusters hold no planes
    int max_planes_per_cluster = 6;
    double max_corner_gap_m = 1.0;
    int min_points_near_corner = 20;  ///< of each plane, within max_corner_gap_m of the line; 0: no such rule
    double min_plane_height_m = 1.2;  ///< from the lowest to the highest of a plane's points
    double min_angle_deg = 45.0;      ///< smallest angle between two planes: paper
    double max_angle_deg = 135.0;     ///< largest angle between two planes: paper
    /// of two corners nearer than this, the one with more points is kept: matching could not distinguish them
    double min_corner_distance_m = 1.0;
    int seed = 1;  ///< seed of the random numbers: any constant, so that runs repeat
    RansacPlane::Params ransac;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("max_range_m", self.max_range_m);
      v("min_beams_per_cell", self.min_beams_per_cell, within(1, 64));
      v("cluster_cells", self.cluster_cells);
      v("max_planes_per_cluster", self.max_planes_per_cluster, within(2, 100));
      v("max_corner_gap_m", self.max_corner_gap_m, requirePositive);
      v("min_points_near_corner", self.min_points_near_corner, within(0, 1000000));
      v("min_plane_height_m", self.min_plane_height_m, requireNotNegative);
      v("ransac", self.ransac);
    }
    void checkRules() const;
  };

  explicit CornerExtractor(const Params& params);

  /// Not const: buffers are reused; each result depends on the arguments alone.
  std::vector<Corner> extract(const std::vector<Eigen::Vector3f>& points, const Eigen::Matrix3d& R_odom_frame);

 private:
  using Points = std::vector<Eigen::Vector3f>;
  struct Plane {
    Eigen::Vector3d normal;
    double d_m;
    double rms_m;
    Points inliers;
  };

  std::vector<Points> cellsWithWalls(const Points& points);
  std::vector<Points> clustersOf(std::vector<Points> cells) const;
  std::vector<Plane> findPlanes(Points cluster, const Eigen::Vector3d& up, std::uint32_t seed) const;
  bool makeCorner(const Plane& a, const Plane& b, const Eigen::Matrix3d& R_odom_frame, Corner& corner) const;

  Params params_;
  int grid_width_;                      ///< cells
  std::vector<std::uint64_t> grid_;     ///< beams that hit each cell, as bits; all zero between calls
  std::vector<std::uint32_t> touched_;  ///< cells with a point
  std::vector<std::uint32_t> cell_of_point_;
};

}  // namespace fail_aware
