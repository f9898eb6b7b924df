// How widely the information on one horizontal direction is spread. Not in the article.
//
// A vehicle ahead that keeps its distance is the only thing that stands across a smooth tunnel: what it says of the
// motion along it is firm and false. True information comes from several places. So no place, a square of `cell_m`,
// counts for more than `max_place_ratio` of all that counts.
// Cost: about 20 ns a point; used only where a direction is poorly observed.
#pragma once

#include <Eigen/Core>
#include <unordered_map>

#include "fail_aware_lidar_odometry/core/cloud/voxel_key.hpp"

namespace fail_aware {

class InformationSupport {
 public:
  struct Params {
    double cell_m = 5.0;  ///< side of a place: about a vehicle
    double max_place_ratio = 0.2;
    double below_ratio = 0.3;  ///< looked into where a horizontal direction has a smaller share of the information

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("max_place_ratio", self.max_place_ratio);
      v("below_ratio", self.below_ratio);
    }
    void validate() const;
  };

  explicit InformationSupport(const Params& params) : params_(params) {}

  void add(const Eigen::Vector3d& position_m, double information);

  /// The part of the information that counts, 0..1.
  double countedRatio() const;

 private:
  Params params_;
  std::unordered_map<VoxelKey, double, VoxelHash> places_;
};

/// The horizontal direction with the least information, a unit vector in odom.
Eigen::Vector2d weakestHorizontal(const Eigen::Matrix2d& information);

}  // namespace fail_aware
