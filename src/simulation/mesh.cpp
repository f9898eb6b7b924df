#include "simulation/mesh.hpp"

#include <cmath>

namespace fail_aware {

const MaterialProperties& properties(Material material) {
  static const MaterialProperties table[] = {
      {0.14f, 0.004f, 0.00f},  // asphalt
      {0.22f, 0.004f, 0.00f},  // pavement
      {0.35f, 0.025f, 0.01f},  // grass
      {0.40f, 0.006f, 0.00f},  // wall
      {0.12f, 0.004f, 0.45f},  // glass
      {0.38f, 0.005f, 0.00f},  // concrete
      {0.35f, 0.003f, 0.05f},  // paint
      {0.45f, 0.003f, 0.02f},  // metal
      {0.25f, 0.012f, 0.00f},  // bark
      {0.45f, 0.040f, 0.05f},  // foliage
      {0.95f, 0.003f, 0.00f},  // sign
      {0.14f, 0.004f, 0.00f},  // rubber
  };
  return table[static_cast<std::size_t>(material)];
}

std::uint32_t Mesh::addVertex(const Eigen::Vector3d& p) {
  vertices.push_back(p.cast<float>());
  return static_cast<std::uint32_t>(vertices.size() - 1);
}

void Mesh::addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Material material) {
  triangles.push_back({a, b, c, material});
}

void Mesh::addQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   const Eigen::Vector3d& d, Material material) {
  const std::uint32_t i = addVertex(a);
  addVertex(b);
  addVertex(c);
  addVertex(d);
  addTriangle(i, i + 1, i + 2, material);
  addTriangle(i, i + 2, i + 3, material);
}

void Mesh::addBox(const Eigen::Isometry3d& T, const Eigen::Vector3d& size, Material material) {
  addFrustum(T, size, 1.0, 1.0, material);
}

void Mesh::addFrustum(const Eigen::Isometry3d& T, const Eigen::Vector3d& size, double top_length, double top_width,
                      Material material) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (int i = 0; i < 8; ++i) {
    const bool top = i >= 4;
    const double sx = (i & 1) ? 0.5 : -0.5, sy = (i & 2) ? 0.5 : -0.5;
    addVertex(T * Eigen::Vector3d(sx * size.x() * (top ? top_length : 1.0), sy * size.y() * (top ? top_width : 1.0),
                                  top ? size.z() : 0.0));
  }
  static constexpr std::uint32_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                 {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : kFaces) {
    addTriangle(first + f[0], first + f[1], first + f[2], material);
    addTriangle(first + f[0], first + f[2], first + f[3], material);
  }
}

void Mesh::addPole(const Eigen::Vector3d& foot, double radius, double height, int sides, Material material) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * M_PI * i / sides;
    const Eigen::Vector3d rim = foot + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    addVertex(rim);
    addVertex(rim + Eigen::Vector3d(0.0, 0.0, height));
  }
  for (int i = 0; i < sides; ++i) {
    const auto a = first + 2u * static_cast<std::uint32_t>(i);
    const auto b = first + 2u * static_cast<std::uint32_t>((i + 1) % sides);
    addTriangle(a, b, b + 1, material);
    addTriangle(a, b + 1, a + 1, material);
  }
}

void Mesh::append(const Mesh& other, const Eigen::Isometry3d& T) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const Eigen::Vector3f& v : other.vertices) addVertex(T * v.cast<double>());
  for (const Triangle& t : other.triangles) addTriangle(first + t.a, first + t.b, first + t.c, t.material);
}

}  // namespace fail_aware
