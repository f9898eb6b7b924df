#include "simulation/drive_simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/mounting.hpp"
#include "simulation/random.hpp"
#include "simulation/scene.hpp"
#include "simulation/traffic.hpp"
#include "simulation/uneven_road.hpp"

namespace fail_aware {

namespace {

constexpr int kColumnsPerBlock = 64;
constexpr std::array<VehicleShape, 3> kShapes = {VehicleShape::kCar, VehicleShape::kVan, VehicleShape::kTruck};

/// Poses of the vehicle, one per simulation step, evenly spaced from a sweep's start to its end.
struct Motion {
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<Eigen::Vector3d> translations;

  void clear() {
    rotations.clear();
    translations.clear();
  }
  void push(const Pose& T) {
    rotations.emplace_back(T.linear());
    translations.push_back(T.translation());
  }
  /// fraction: 0 start, 1 end
  Pose at(double fraction) const {
    const double place = fraction * static_cast<double>(rotations.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(place), rotations.size() - 2);
    const double f = place - static_cast<double>(i);
    Pose T = Pose::Identity();
    T.linear() = rotations[i].slerp(f, rotations[i + 1]).toRotationMatrix();
    T.translation() = translations[i] + f * (translations[i + 1] - translations[i]);
    return T;
  }
};

struct Block {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensities, times_s;
  std::vector<std::uint16_t> rings;
};

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void DriveSimulation::Params::validate() const {
  requireWithin("duration_s", duration_s, 0.1, 1e6);
  ScenePlan::parse(scene, duration_s);
  requireParameter(seed >= 0, "seed", seed, ">= 0");
  requireMounting("lidar_in_base", lidar_in_base);
  drive.validate();
  lidar.validate();
}

Pose DriveSimulation::Params::T_base_lidar() const { return mountingPose(lidar_in_base); }

struct DriveSimulation::Impl {
  Impl(const Params& p, int threads)
      : params((p.validate(), p)),
        seed(mixBits(static_cast<std::uint64_t>(p.seed))),
        T_base_lidar(p.T_base_lidar()),
        scene(seed, ScenePlan::parse(p.scene, p.duration_s)),
        lidar(seed, p.lidar),
        traffic(seed),
        vehicle(seed, p.drive, scene.road(), scene.terrain()),
        arena(arenaSize(threads)),
        sweeps(static_cast<std::size_t>(std::max(1L, std::lround(p.duration_s / p.lidar.period_s)))) {
    for (VehicleShape shape : kShapes) {
      Mesh mesh;
      addVehicle(mesh, Place::Identity(), shape);
      shapes[static_cast<std::size_t>(shape)] = caster.addShape(mesh);
    }
  }

  void moveVehicle() {
    motion.clear();
    motion.push(vehicle.T_world_base());
    const long steps = std::lround(params.lidar.period_s / VehicleDrive::kStep_s);
    for (long i = 0; i < steps; ++i) {
      vehicle.step(scene.road(), scene.terrain());
      motion.push(vehicle.T_world_base());
    }
  }

  void moveWorld(double s_begin_m, int vehicles_around) {
    SceneChange change = scene.update(vehicle.state().position, vehicle.state().s_m);
    for (std::int64_t id : change.removed) caster.remove(id);
    for (const SceneTile& tile : change.added) caster.add(tile.id, tile.origin, tile.mesh);
    std::vector<MovingShape> moving;
    if (params.traffic || vehicles_around > 0) {
      for (const TrafficVehicle& other : traffic.update(scene.road(), scene.terrain(), begin_s(), params.lidar.period_s,
                                                        s_begin_m, vehicle.state().s_m, vehicles_around)) {
        moving.push_back({shapes[static_cast<std::size_t>(other.shape)], other.T_world_begin, other.T_world_end});
      }
    }
    caster.setMoving(moving);
    caster.commit(motion.translations.front());
  }

  void scanColumn(int column, Block& block) const {
    const double fraction = params.rolling_shutter ? lidar.columnTime(column) / params.lidar.period_s : 0.5;
    const Pose T_world_lidar = motion.at(fraction) * T_base_lidar;
    const double azimuth = lidar.azimuth(column);
    std::array<Eigen::Vector3f, LidarModel::kMaxBeams> directions;
    std::array<RayHit, LidarModel::kMaxBeams> hits;
    lidar.pointing(azimuth, directions.data());
    const Eigen::Matrix3f R = T_world_lidar.linear().cast<float>();
    for (std::size_t beam = 0; beam < lidar.beams(); ++beam) directions[beam] = R * directions[beam];
    caster.cast(T_world_lidar.translation(), static_cast<float>(fraction), directions.data(), lidar.beams(),
                static_cast<float>(params.lidar.max_range_m), hits.data());
    for (std::size_t beam = 0; beam < lidar.beams(); ++beam) {
      if (hits[beam].material != Material::kAsphalt || !hits[beam].hit()) continue;
      hits[beam].range_m =
          rangeOnUnevenRoad(T_world_lidar.translation(), directions[beam], hits[beam], scene.terrain());
    }
    const std::uint64_t column_key = combineKeys(seed, 61, sweep_index, static_cast<std::uint64_t>(column));
    for (std::size_t beam = 0; beam < lidar.beams(); ++beam) {
      const auto echo = lidar.measure(beam, azimuth, hits[beam], column_key + beam);
      if (!echo) continue;
      block.points.push_back(echo->point_lidar);
      block.intensities.push_back(echo->intensity);
      if (params.rolling_shutter) block.times_s.push_back(static_cast<float>(lidar.columnTime(column)));
      block.rings.push_back(static_cast<std::uint16_t>(beam));
    }
  }

  void scan(Sweep& sweep) {
    const int columns = params.lidar.columns;
    std::vector<Block> blocks(static_cast<std::size_t>((columns + kColumnsPerBlock - 1) / kColumnsPerBlock));
    inArena(arena, [&] {
      inParallelFor(blocks.size(), [&](std::size_t b) {
        const int first = static_cast<int>(b) * kColumnsPerBlock;
        for (int column = first; column < std::min(columns, first + kColumnsPerBlock); ++column) {
          scanColumn(column, blocks[b]);
        }
      });
    });
    sweep = Sweep();
    for (const Block& block : blocks) {
      append(sweep.points_lidar, block.points);
      append(sweep.intensities, block.intensities);
      append(sweep.times_s, block.times_s);
      append(sweep.rings, block.rings);
    }
  }

  double begin_s() const { return params.lidar.period_s * static_cast<double>(sweep_index); }

  Params params;
  std::uint64_t seed;
  Pose T_base_lidar;
  Scene scene;
  LidarModel lidar;
  Traffic traffic;
  VehicleDrive vehicle;
  RayCaster caster;
  std::array<int, kShapes.size()> shapes{};
  tbb::task_arena arena;
  Motion motion;
  std::size_t sweeps;
  std::size_t sweep_index = 0;
};

DriveSimulation::DriveSimulation(const Params& params, int threads) {
  requireWithin("threads", threads, 1, 256);
  impl_ = std::make_unique<Impl>(params, threads);
}

DriveSimulation::~DriveSimulation() = default;

std::size_t DriveSimulation::sweeps() const { return impl_->sweeps; }
double DriveSimulation::time_s() const { return impl_->begin_s(); }

bool DriveSimulation::next(SimulatedSweep& out, int vehicles_around) {
  Impl& sim = *impl_;
  if (sim.sweep_index >= sim.sweeps) return false;
  const double s_begin_m = sim.vehicle.state().s_m;
  sim.moveVehicle();
  sim.moveWorld(s_begin_m, vehicles_around);
  out = SimulatedSweep();
  sim.scan(out.sweep);
  out.begin_s = sim.begin_s();
  out.period_s = sim.params.lidar.period_s;
  out.sweep.stamp_s = out.middle_s();
  out.T_world_base = sim.motion.at(0.5);
  out.T_world_lidar = out.T_world_base * sim.T_base_lidar;
  out.T_world_base_end = sim.motion.at(1.0);
  ++sim.sweep_index;
  return true;
}

}  // namespace fail_aware
