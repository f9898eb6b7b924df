#include "simulation/mesh.hpp"

#include <gtest/gtest.h>

namespace fail_aware::mesh_test {
namespace {

TEST(Mesh, BoxHasItsSizeAndIsClosed) {
  Mesh mesh;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 10, 20, 30;
  mesh.addBox(T, {2, 4, 6}, Material::kWall);
  ASSERT_EQ(mesh.vertices.size(), 8u);
  Eigen::Vector3f low = mesh.vertices[0], high = low;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  EXPECT_EQ(low, Eigen::Vector3f(9, 18, 30));
  EXPECT_EQ(high, Eigen::Vector3f(11, 22, 36));
  float area = 0.0f;
  for (const Triangle& t : mesh.triangles) {
    area += 0.5f * (mesh.vertices[t.b] - mesh.vertices[t.a]).cross(mesh.vertices[t.c] - mesh.vertices[t.a]).norm();
  }
  EXPECT_NEAR(area, 2 * (2 * 4 + 2 * 6 + 4 * 6), 1e-3);
}

TEST(Mesh, AppendMovesAndRenumbers) {
  Mesh part, whole;
  part.addQuad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, Material::kSign);
  whole.addPole({0, 0, 0}, 0.1, 2.0, 6, Material::kMetal);
  const std::size_t before = whole.vertices.size();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = 5.0;
  whole.append(part, T);
  EXPECT_EQ(whole.vertices[before], Eigen::Vector3f(5, 0, 0));
  EXPECT_EQ(whole.triangles.back().a, before);
  EXPECT_EQ(whole.triangles.back().material, Material::kSign);
}

}  // namespace
}  // namespace fail_aware::mesh_test
