// How widely the information on one horizontal direction is spread in space. Not in the paper.
//
// A vehicle ahead that keeps its distance may be the only surface that observes the motion along a smooth tunnel: its
// information is precise and wrong. True information comes from several places. Therefore no place (a square of
// `cell_m`) counts for more than `max_place_ratio` of all the information that counts.
//
// The normals of the walls and rails along a road are tilted by chance, some forwards, some backwards, and seem to
// observe the motion along it. Therefore what a place has by chance does not count.
// Cost: about 20 ns per point; used only where a direction is weakly observed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <unordered_map>

#include "core/parameters/check.hpp"
#include "core/preprocessing/voxel_key.hpp"

namespace fail_aware {

class InformationSupport {
 public:
  struct Params {
    double cell_m = 5.0;  ///< side of a place: about the length of a vehicle
    double max_place_ratio = 0.2;
    double below_ratio = 0.3;  ///< applied where the ratio of information in a horizontal direction is below this

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("max_place_ratio", self.max_place_ratio, within(0.01, 1.0));
      v("below_ratio", self.below_ratio, within(0.0, 1.0));
    }
  };

  explicit InformationSupport(const Params& params) : params_(params) {}

  /// `by_chance`: what the errors of the normal alone are expected to add to the information.
  void add(const Eigen::Vector3d& position_m, double information, double by_chance = 0.0);

  /// The ratio of the information that counts, 0..1.
  double countedRatio() const;

 private:
  struct Place {
    double information = 0.0, by_chance = 0.0;
  };

  Params params_;
  std::unordered_map<VoxelKey, Place, VoxelHash> places_;
};

/// A horizontal direction (unit vector in odom) along which only a part of the information counts.
struct WeakHorizontal {
  Eigen::Vector2d direction;
  double counted_ratio;
};

/// The horizontal direction with the least information, a unit vector in odom; nullopt if it has `below_ratio` of
/// `weight` or more.
std::optional<Eigen::Vector2d> weakDirection(const Eigen::Matrix2d& information, double weight, double below_ratio);

}  // namespace fail_aware
