// Triangles with materials, and the basic shapes of the scenes.
//
// Coordinates: m, z up, in the mesh's own frame; scenes choose an origin near the mesh, so that float is exact to well
// below a millimetre. No failure modes. Cost: a box has 12 triangles, a pole 12 (6 sides).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace fail_aware {

enum class Material : std::uint8_t {
  kAsphalt,  ///< the road's surface only
  kPavement,
  kGrass,
  kWall,
  kGlass,
  kConcrete,
  kPaint,  ///< cars
  kMetal,
  kBark,
  kFoliage,
  kSign,  ///< retroreflective
  kRubber,
};

struct MaterialProperties {
  float reflectivity;  ///< 0..1
  float roughness_m;   ///< standard deviation of the range in addition to the sensor's
  float dropout;       ///< ratio of pulses without a return
};

const MaterialProperties& properties(Material material);

struct Triangle {
  std::uint32_t a, b, c;
  Material material;
};

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;

  bool empty() const { return triangles.empty(); }

  std::uint32_t addVertex(const Eigen::Vector3d& p);
  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Material material);
  /// Corners in order round the quad.
  void addQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d,
               Material material);
  /// Centred on T's x and y, from T's z = 0 upwards.
  void addBox(const Eigen::Isometry3d& T, const Eigen::Vector3d& size, Material material);
  /// A box with a smaller top: `top_length`, `top_width` are ratios of the bottom's length and width.
  void addFrustum(const Eigen::Isometry3d& T, const Eigen::Vector3d& size, double top_length, double top_width,
                  Material material);
  /// Vertical, from `foot`, with `sides` faces and open ends.
  void addPole(const Eigen::Vector3d& foot, double radius, double height, int sides, Material material);
  void append(const Mesh& other, const Eigen::Isometry3d& T);
};

}  // namespace fail_aware
