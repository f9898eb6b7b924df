// Casts the lidar's rays into the scene's triangles, with Embree.
//
// Static meshes are fixed at their origins (world, double precision; stored relative to a point near the sensor, so
// float is exact far from the world's origin). Moving objects are instances of shapes whose pose changes linearly from
// begin to end of the time interval; each ray has its own time in the interval. Call commit() after every change.
// Several threads may call cast() at once. Results do not depend on threads.
// Failure: std::runtime_error if Embree cannot be set up. Cost: about 0.2 us a ray, some 0.1 ms for a commit.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/pose.hpp"
#include "simulation/mesh.hpp"

namespace fail_aware {

struct RayHit {
  float range_m = 0.0f;  ///< 0: no hit within range
  float incidence_cos = 0.0f;
  Material material = Material::kAsphalt;

  bool hit() const { return range_m > 0.0f; }
};

struct MovingShape {
  int shape = 0;
  Pose T_world_begin = Pose::Identity();
  Pose T_world_end = Pose::Identity();
};

class RayCaster {
 public:
  RayCaster();
  ~RayCaster();

  void add(std::int64_t id, const Eigen::Vector3d& origin_world, const Mesh& mesh);
  void remove(std::int64_t id);
  /// Returns the number that MovingShape::shape refers to.
  int addShape(const Mesh& mesh);
  void setMoving(const std::vector<MovingShape>& moving);
  /// `near_world`: approximate origin of the later rays.
  void commit(const Eigen::Vector3d& near_world);

  /// `count` rays from one point at one time (`time`: 0 begin, 1 end of the interval); unit directions, world axes.
  void cast(const Eigen::Vector3d& from_world, float time, const Eigen::Vector3f* directions, std::size_t count,
            float max_range_m, RayHit* hits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fail_aware
