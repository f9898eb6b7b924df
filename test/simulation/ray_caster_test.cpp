#include "simulation/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fail_aware::ray_caster_test {
namespace {

const Eigen::Vector3f kAhead = Eigen::Vector3f::UnitX();

Mesh wallAt(double x, Material material) {
  Mesh mesh;
  mesh.addQuad({x, -50, -10}, {x, 50, -10}, {x, 50, 10}, {x, -50, 10}, material);
  return mesh;
}

RayHit castOne(const RayCaster& caster, const Eigen::Vector3d& from, const Eigen::Vector3f& direction,
               float time = 0.0f, float reach_m = 100.0f) {
  RayHit hit;
  caster.cast(from, time, &direction, 1, reach_m, &hit);
  return hit;
}

TEST(RayCaster, RangeAndIncidenceOnAWall) {
  RayCaster caster;
  caster.add(1, {0, 0, 0}, wallAt(12.0, Material::kSign));
  caster.commit({0, 0, 0});
  std::vector<Eigen::Vector3f> directions;  // no multiple of a packet
  for (int i = 0; i < 21; ++i) {
    const double yaw = -1.2 + 0.12 * i;
    directions.push_back(Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.1).normalized().cast<float>());
  }
  std::vector<RayHit> hits(directions.size());
  caster.cast({2.0, 1.0, 0.5}, 0.0f, directions.data(), directions.size(), 100.0f, hits.data());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    ASSERT_TRUE(hits[i].hit());
    EXPECT_NEAR(hits[i].range_m, 10.0f / directions[i].x(), 2e-5f * hits[i].range_m);
    EXPECT_NEAR(hits[i].incidence_cos, directions[i].x(), 1e-5f);
    EXPECT_EQ(hits[i].material, Material::kSign);
  }
}

TEST(RayCaster, NearestOfSeveralAndNothingBeyondReach) {
  RayCaster caster;
  caster.add(1, {0, 0, 0}, wallAt(30.0, Material::kWall));
  caster.add(2, {5, 0, 0}, wallAt(10.0, Material::kMetal));
  caster.commit({0, 0, 0});
  EXPECT_FLOAT_EQ(castOne(caster, {0, 0, 0}, kAhead).range_m, 15.0f);
  EXPECT_EQ(castOne(caster, {0, 0, 0}, kAhead).material, Material::kMetal);
  EXPECT_FALSE(castOne(caster, {0, 0, 0}, -kAhead).hit());
  caster.remove(2);
  caster.commit({0, 0, 0});
  EXPECT_FLOAT_EQ(castOne(caster, {0, 0, 0}, kAhead).range_m, 30.0f);
  EXPECT_FALSE(castOne(caster, {0, 0, 0}, kAhead, 0.0f, 29.0f).hit());
}

TEST(RayCaster, ExactFarFromTheWorldsOrigin) {
  RayCaster caster;
  const Eigen::Vector3d far(123456.75, -98765.5, 321.25);
  caster.add(1, far, wallAt(10.0, Material::kWall));
  caster.commit(far);
  EXPECT_NEAR(castOne(caster, far + Eigen::Vector3d(0.001, 0, 0), kAhead).range_m, 9.999f, 1e-5f);
}

TEST(RayCaster, MovingThingsAreWhereTheyAreAtTheRaysInstant) {
  RayCaster caster;
  Mesh box;
  box.addBox(Eigen::Isometry3d::Identity(), {2, 2, 2}, Material::kPaint);
  MovingShape moving;
  moving.shape = caster.addShape(box);
  moving.T_world_begin.translation() << 20, 0, -1;
  moving.T_world_end.translation() << 23, 0, -1;
  caster.setMoving({moving});
  caster.commit({0, 0, 0});
  for (float time : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const RayHit hit = castOne(caster, {0, 0, 0}, kAhead, time);
    EXPECT_NEAR(hit.range_m, 19.0f + 3.0f * time, 1e-4f);
    EXPECT_NEAR(hit.incidence_cos, 1.0f, 1e-5f);
  }
  caster.setMoving({});
  caster.commit({0, 0, 0});
  EXPECT_FALSE(castOne(caster, {0, 0, 0}, kAhead, 0.5f).hit());
}

}  // namespace
}  // namespace fail_aware::ray_caster_test
