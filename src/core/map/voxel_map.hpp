// The reference against which sweeps are registered: a flat voxel hash map in odom with, per voxel, a few points (for
// point to point) and a plane fitted to all that fell into it (for point to plane).
//
// A voxel's points and statistics are floats relative to its own centre, so precision does not depend on how far the
// vehicle has driven. Statistics are summed over every inserted point until `max_samples`, then frozen. Early freezing
// and large voxels leave a bias: what is seen first is the side that faces the oncoming vehicle, later points lie
// deeper, and the estimated distance becomes too short (0.2 m per km at 1 m and 200 samples).
// Insertion costs about 40 ns a point, a plane query one to four probes of about 15 ns, a nearest-point query one to
// eight and the distances in their voxels. A probe that a Neighborhood remembers costs about nothing.
// Reading from several threads at once is safe, with a Neighborhood for each; inserting is not.
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/preprocessing/voxel_key.hpp"

namespace fail_aware {

/// A plane patch; `mean` is that of the points it was fitted to.
struct PlanePatch {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();    ///< m, relative to the voxel's centre
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, odom axes
  float variance = 0.0f;                             ///< m^2, of the points along the normal
  float normal_variance = 0.0f;  ///< rad^2, of the normal's tilt, about the axis that is known worse
  Eigen::Vector3f tangent = Eigen::Vector3f::Zero();  ///< unit, in the plane, across the points' longest extent
  float spread = 0.0f;                                ///< m^2, variance of the points along `tangent`
  float samples = 0.0f;                               ///< points fitted; 0: no plane here
  /// Unit, horizontal, odom axes: from the origin of the points, when the voxel was first seen. Most of the points that
  /// are kept are of that view.
  Eigen::Vector2f first_view = Eigen::Vector2f::Zero();
  bool post = false;  ///< no plane but thin and upright: a post, a trunk, an edge of a house
};

class VoxelMap {
 public:
  struct Params {
    double voxel_size_m = 0.8;
    int max_points = 12;                ///< points kept per voxel for nearest-point queries
    double min_point_spacing_m = 0.15;  ///< a point nearer to a kept one is not kept: a fifth of a voxel
    int min_plane_samples = 6;
    int max_samples = 1000;  ///< statistics are frozen from here on
    /// thicker patches are no planes: hedges; a wall seen by all beams is thinner
    double max_plane_sigma_m = 0.12;
    double min_plane_flatness = 5.0;  ///< middle over smallest eigenvalue: a line is no plane

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("voxel_size_m", self.voxel_size_m, within(0.01, 100.0));
      v("min_plane_samples", self.min_plane_samples, within(3, 1e6));
      v("max_samples", self.max_samples);
    }
    void checkRules() const;
  };

  static constexpr int kMaxPoints = 20;  ///< upper limit of Params::max_points

  VoxelMap() : VoxelMap(Params{}) {}
  explicit VoxelMap(const Params& params);

  /// Reserves memory for the points and planes of this many voxels, so that they are not copied while the map grows
  /// (the index still grows). It costs 280 bytes of address space a voxel; the system provides memory when it is
  /// written to.
  void reserve(std::size_t voxels);

  /// Adds points, seen from the origin of T_odom_points and moved into odom by it, and refits the planes that changed.
  /// What is not finite is left out.
  void insert(const std::vector<Eigen::Vector3f>& points, const Pose& T_odom_points);

  /// Forgets voxels whose centre is farther than range_m from the position (horizontally and vertically alike).
  void removeFartherThan(double range_m, const Eigen::Vector3d& position_odom);

  void clear();
  bool empty() const { return voxels_.empty(); }
  std::size_t size() const { return voxels_.size(); }

  /// The eight voxels that meet at the corner of the grid nearest to a query, as far as queries have looked them up.
  /// One for each point, handed to its query in every iteration, spares the probes as long as the point stays near the
  /// same corner; the answers are the same without. Of one map, and to be forgotten when that changes.
  class Neighborhood {
    friend class VoxelMap;
    static constexpr std::uint32_t kUnknown = ~std::uint32_t{0}, kNone = kUnknown - 1;  // not looked up; no such voxel
    Eigen::Vector3i corner_ = Eigen::Vector3i::Constant(std::numeric_limits<std::int32_t>::min());  // of no query
    // A voxel's place: the axes, as bits, on whose upper side of the corner it lies.
    std::uint32_t own_ = 0;                // the place that the query is in
    std::array<std::uint32_t, 8> voxels_;  // by place: index
    Eigen::Vector3i at(std::uint32_t place) const {
      return corner_ - Eigen::Vector3i((place & 1u) == 0, (place & 2u) == 0, (place & 4u) == 0);
    }
    void moveTo(const Eigen::Vector3d& scaled) {  // the query, in voxels
      const Eigen::Vector3i corner(fastFloor(scaled.x() + 0.5), fastFloor(scaled.y() + 0.5),
                                   fastFloor(scaled.z() + 0.5));
      if (corner != corner_) {
        corner_ = corner;
        voxels_.fill(kUnknown);
      }
      const Eigen::Array<bool, 3, 1> upper = scaled.array() >= corner.cast<double>().array();
      own_ = (upper.x() ? 1u : 0u) | (upper.y() ? 2u : 0u) | (upper.z() ? 4u : 0u);
    }

   public:
    Neighborhood() { voxels_.fill(kUnknown); }
  };

  static constexpr std::size_t kPrefetchAhead = 8;  ///< so many queries before the point's own
  /// Begin to load what a point's next query will need first, if the point stays in its voxel.
  void prefetchPlane(const Neighborhood& neighborhood) const {
    const std::uint32_t voxel = neighborhood.voxels_[neighborhood.own_];
    if (voxel < Neighborhood::kNone) prefetch(&planes_[voxel], 1);
  }
  void prefetchPoints(const Neighborhood& neighborhood) const {
    const std::uint32_t voxel = neighborhood.voxels_[neighborhood.own_];
    if (voxel < Neighborhood::kNone) prefetch(&points_[3 * slots_ * voxel], 3 * slots_);
  }

  struct PlaneMatch {
    const PlanePatch* plane;  ///< valid until the map changes
    float distance_m;         ///< signed, along the normal: n . (query - mean)
    float tangential_m;       ///< distance of the query from the mean, along PlanePatch::tangent
  };
  /// The plane of the query's own voxel, or, if that has none, of the nearest of the neighbours that share a face
  /// with the query's octant (3 voxels). False when there is none.
  bool findPlane(const Eigen::Vector3d& query_odom, PlaneMatch& match, Neighborhood& neighborhood) const;

  struct PointMatch {
    Eigen::Vector3f offset_m;  ///< neighbour - query
    float distance2_m2;
    std::uint32_t voxel;  ///< that the neighbour is in; index, valid until the map changes
  };
  /// The nearest stored point within max_distance_m; exact for distances up to half a voxel, beyond that among the
  /// eight voxels nearest to the query.
  bool findNearest(const Eigen::Vector3d& query_odom, double max_distance_m, PointMatch& match,
                   Neighborhood& neighborhood) const;
  bool findNearest(const Eigen::Vector3d& query_odom, double max_distance_m, PointMatch& match) const;

  /// Of a voxel that a match named: its plane, if samples > 0, or whether it is a post.
  const PlanePatch& surface(std::uint32_t voxel) const { return planes_[voxel]; }

  /// All stored points in odom (for display and for files).
  std::vector<Eigen::Vector3d> points() const;

 private:
  struct Statistics {
    float n = 0.0f;
    float fitted_n = 0.0f;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();

    void add(const Eigen::Vector3f& p) {
      n += 1.0f;
      sum += p;
      squares += p * p.transpose();
    }
  };
  struct Voxel {
    VoxelKey key;
    Eigen::Vector3i at;
    Statistics statistics;
    bool touched = false;
  };

  std::uint32_t findOrAdd(const Eigen::Vector3i& at);
  void keepPoint(std::uint32_t voxel, const Eigen::Vector3f& local);
  void refitPlanes();
  std::uint32_t lookUp(std::uint32_t place, Neighborhood& neighborhood) const;
  /// Sets all of the patch but `first_view`.
  void fitPlane(const Statistics& statistics, PlanePatch& patch) const;
  template <class Value>
  static void prefetch(const Value* values, std::size_t count) {
    constexpr std::size_t kLine = 64;
    const char* const bytes = reinterpret_cast<const char*>(values);
    for (std::size_t i = 0; i < count * sizeof(Value); i += kLine) __builtin_prefetch(bytes + i);
    __builtin_prefetch(bytes + count * sizeof(Value) - 1);  // they begin anywhere in a line
  }
  Eigen::Vector3d centreOf(const Eigen::Vector3i& voxel) const {
    return params_.voxel_size_m * (voxel.cast<double>().array() + 0.5).matrix();
  }

  Params params_;
  double inverse_size_;
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelHash> index_;
  std::vector<Voxel> voxels_;
  static constexpr std::size_t kLane = 4;   ///< points whose distances are computed at once
  std::size_t slots_;                       ///< max_points, rounded up to whole lanes
  std::vector<float> points_;               ///< 3 slots_ a voxel, in the order of voxels_: all x, all y, all z
  std::vector<std::uint8_t> point_counts_;  ///< of these in use
  std::vector<PlanePatch> planes_;          ///< in the order of voxels_; apart, so that queries stay in the cache
  std::vector<std::uint32_t> touched_, voxel_of_;  ///< voxels that changed; of each point that is inserted
};

}  // namespace fail_aware
