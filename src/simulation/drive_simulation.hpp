// A simulated drive, sweep by sweep: world, vehicle, traffic and lidar, with the ground truth.
//
// Each sweep is what the sensor reports: each point in the sensor's frame at its own time (rolling shutter), in the
// order of time; times from the sweep's start. Without rolling shutter all points belong to the sweep's middle and have
// no times. The stamp is the sweep's middle (KITTI's convention), s from the drive's start.
// The same parameters give the same bits, for any number of threads. Failure: ParameterError for bad parameters;
// std::runtime_error if Embree cannot be set up. Cost: 20 to 60 ms a sweep of one core; memory does not grow.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/sweep.hpp"
#include "simulation/lidar_model.hpp"
#include "simulation/vehicle_drive.hpp"

namespace fail_aware {

struct SimulatedSweep {
  Sweep sweep;
  bool time_sign_wrong = false;  ///< a fault: the output inverts the sign of the point times
  double begin_s = 0.0, period_s = 0.1;
  Pose T_world_lidar = Pose::Identity();     ///< in the sweep's middle
  Pose T_world_base = Pose::Identity();      ///< in the sweep's middle
  Pose T_world_base_end = Pose::Identity();  ///< at the sweep's end

  double middle_s() const { return begin_s + 0.5 * period_s; }
};

class DriveSimulation {
 public:
  struct Params {
    std::string scene = "town";  ///< scene_kind.hpp
    double duration_s = 60.0;
    int seed = 1;
    bool rolling_shutter = true;
    bool traffic = true;
    std::vector<double> lidar_in_base = {-0.595, 0.0, 1.73, 0.0, 0.0, 0.0};  ///< x y z (m) roll pitch yaw (rad)
    VehicleDrive::Params drive;
    LidarModel::Params lidar;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("scene", self.scene);
      v("duration_s", self.duration_s);
      v("seed", self.seed);
      v("rolling_shutter", self.rolling_shutter);
      v("traffic", self.traffic);
      v("lidar_in_base", self.lidar_in_base);
      v("drive", self.drive);
      v("lidar", self.lidar);
    }
    void validate() const;
    Pose T_base_lidar() const;
  };

  DriveSimulation(const Params& params, int threads);
  ~DriveSimulation();

  std::size_t sweeps() const;
  /// False after the end of the drive. `vehicles_around`: dense traffic (fault.hpp), 0 for none.
  bool next(SimulatedSweep& sweep, int vehicles_around = 0);

  double time_s() const;  ///< of the next sweep's start

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fail_aware
