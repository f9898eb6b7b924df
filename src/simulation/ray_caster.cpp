#include "simulation/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

namespace fail_aware {

namespace {

constexpr std::size_t kPacket = 8;
constexpr double kRecentre_m = 200.0;

struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;

struct Solid {
  ScenePtr scene;
  std::vector<Material> materials;  ///< of the triangles
};

void setTransform(RTCGeometry instance, unsigned step, const Eigen::Matrix3f& R, const Eigen::Vector3f& t) {
  Eigen::Matrix<float, 3, 4> columns;  // Embree reads it column by column
  columns << R, t;
  rtcSetGeometryTransform(instance, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
}

}  // namespace

struct RayCaster::Impl {
  struct Placed {
    unsigned instance;
    Eigen::Vector3d origin;
  };
  /// The object of an instance number in the top scene.
  struct Target {
    const Solid* solid = nullptr;
    Eigen::Matrix3f R_object_world = Eigen::Matrix3f::Identity();
  };

  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::map<std::int64_t, Solid> solids;
  std::map<std::int64_t, Placed> placed;
  std::vector<Solid> shapes;
  std::vector<unsigned> moving_instances;
  std::vector<Target> targets;  ///< by instance number
  std::vector<MovingShape> moving;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();

  Solid build(const Mesh& mesh) const {
    Solid solid;
    solid.scene.reset(rtcNewScene(device));
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
    if (!vertices || !indices) throw std::runtime_error("Embree: no memory for a mesh");
    for (const Eigen::Vector3f& v : mesh.vertices) vertices = std::copy_n(v.data(), 3, vertices);
    for (const Triangle& t : mesh.triangles) {
      *indices++ = t.a;
      *indices++ = t.b;
      *indices++ = t.c;
      solid.materials.push_back(t.material);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(solid.scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(solid.scene.get());
    return solid;
  }

  unsigned attach(const Solid& solid, unsigned time_steps, const Eigen::Matrix3f& R_object_world) {
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, solid.scene.get());
    rtcSetGeometryTimeStepCount(instance, time_steps);
    const unsigned id = rtcAttachGeometry(top, instance);
    rtcReleaseGeometry(instance);
    if (targets.size() <= id) targets.resize(id + 1);
    targets[id] = {&solid, R_object_world};
    return id;
  }

  void place(const Placed& p) {
    RTCGeometry instance = rtcGetGeometry(top, p.instance);
    setTransform(instance, 0, Eigen::Matrix3f::Identity(), (p.origin - centre).cast<float>());
    rtcCommitGeometry(instance);
  }
};

RayCaster::RayCaster() : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice("threads=1,set_affinity=0");
  if (!impl_->device) {
    throw std::runtime_error("Embree cannot be set up (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
  }
  impl_->top = rtcNewScene(impl_->device);
}

RayCaster::~RayCaster() {
  rtcReleaseScene(impl_->top);
  impl_->solids.clear();
  impl_->shapes.clear();
  rtcReleaseDevice(impl_->device);
}

void RayCaster::add(std::int64_t id, const Eigen::Vector3d& origin_world, const Mesh& mesh) {
  remove(id);
  if (mesh.empty()) return;
  const Solid& solid = impl_->solids.emplace(id, impl_->build(mesh)).first->second;
  const Impl::Placed placed{impl_->attach(solid, 1, Eigen::Matrix3f::Identity()), origin_world};
  impl_->placed.emplace(id, placed);
  impl_->place(placed);
}

void RayCaster::remove(std::int64_t id) {
  const auto found = impl_->placed.find(id);
  if (found == impl_->placed.end()) return;
  rtcDetachGeometry(impl_->top, found->second.instance);
  impl_->placed.erase(found);
  impl_->solids.erase(id);
}

int RayCaster::addShape(const Mesh& mesh) {
  // instances store the addresses of shapes
  if (!impl_->moving_instances.empty()) throw std::logic_error("shapes come before what moves");
  impl_->shapes.push_back(impl_->build(mesh));
  return static_cast<int>(impl_->shapes.size()) - 1;
}

void RayCaster::setMoving(const std::vector<MovingShape>& moving) { impl_->moving = moving; }

void RayCaster::commit(const Eigen::Vector3d& near_world) {
  if ((near_world - impl_->centre).norm() > kRecentre_m) {
    impl_->centre = near_world;
    for (const auto& item : impl_->placed) impl_->place(item.second);
  }
  for (unsigned instance : impl_->moving_instances) rtcDetachGeometry(impl_->top, instance);
  impl_->moving_instances.clear();
  for (const MovingShape& moving : impl_->moving) {
    const Solid& shape = impl_->shapes.at(static_cast<std::size_t>(moving.shape));
    const Eigen::Matrix3f R_begin = moving.T_world_begin.linear().cast<float>();
    const unsigned id = impl_->attach(shape, 2, R_begin.transpose());
    RTCGeometry instance = rtcGetGeometry(impl_->top, id);
    setTransform(instance, 0, R_begin, (moving.T_world_begin.translation() - impl_->centre).cast<float>());
    setTransform(instance, 1, moving.T_world_end.linear().cast<float>(),
                 (moving.T_world_end.translation() - impl_->centre).cast<float>());
    rtcCommitGeometry(instance);
    impl_->moving_instances.push_back(id);
  }
  rtcCommitScene(impl_->top);
  const RTCError error = rtcGetDeviceError(impl_->device);
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree: error " + std::to_string(error));
}

void RayCaster::cast(const Eigen::Vector3d& from_world, float time, const Eigen::Vector3f* directions,
                     std::size_t count, float max_range_m, RayHit* hits) const {
  const Eigen::Vector3f from = (from_world - impl_->centre).cast<float>();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < count; first += kPacket) {
    const std::size_t size = std::min(kPacket, count - first);
    alignas(32) int valid[kPacket];
    RTCRayHit8 packet{};
    for (std::size_t i = 0; i < kPacket; ++i) {
      valid[i] = i < size ? -1 : 0;
      const Eigen::Vector3f& direction = directions[first + std::min(i, size - 1)];
      packet.ray.org_x[i] = from.x();
      packet.ray.org_y[i] = from.y();
      packet.ray.org_z[i] = from.z();
      packet.ray.dir_x[i] = direction.x();
      packet.ray.dir_y[i] = direction.y();
      packet.ray.dir_z[i] = direction.z();
      packet.ray.tnear[i] = 0.0f;
      packet.ray.tfar[i] = max_range_m;
      packet.ray.time[i] = time;
      packet.ray.mask[i] = ~0u;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, impl_->top, &context, &packet);
    for (std::size_t i = 0; i < size; ++i) {
      RayHit& hit = hits[first + i];
      hit = RayHit();
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const Impl::Target& target = impl_->targets[packet.hit.instID[0][i]];
      const Eigen::Vector3f normal(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]);
      const Eigen::Vector3f direction = target.R_object_world * directions[first + i];
      hit.range_m = packet.ray.tfar[i];
      hit.incidence_cos = std::abs(normal.dot(direction)) / std::max(normal.norm(), 1e-12f);
      hit.material = target.solid->materials[packet.hit.primID[i]];
    }
  }
}

}  // namespace fail_aware
