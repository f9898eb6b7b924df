// The vehicle that carries the lidar through the simulated world: a car on four springs and a driver, 1 ms steps.
//
// It differs from the filter's model (core/vehicle): a body of six degrees of freedom on springs and dampers over the
// road's height under each wheel; lateral forces of two axles from slip angles, saturating at the load that springs and
// accelerations put on them (load transfer); drive and brakes with a limited jerk; air and rolling resistance, slopes.
// The driver steers towards a point ahead on the own lane and follows a SpeedProfile. The chassis constants are
// VehicleParameters (the springs are taken as those of one wheel).
//
// World frame x y z up, m; base_link as in cfg/vehicles (on the ground, half-way between the axles). Always finite.
// Cost: about 1.5 us a step without the terrain's sines (four wheels).
#pragma once

#include <cstdint>

#include "core/estimation/vehicle/vehicle_parameters.hpp"
#include "core/geometry/pose.hpp"
#include "simulation/road.hpp"
#include "simulation/speed_profile.hpp"
#include "simulation/terrain.hpp"

namespace fail_aware {

class VehicleDrive {
 public:
  static constexpr double kStep_s = 1e-3;

  struct Params {
    VehicleParameters vehicle;
    SpeedProfile::Params speed;
    double start_speed_mps = -1.0;  ///< < 0: chosen by the scene: standstill in town, else 0.7 of the limit
    double friction = 0.95;
    double max_drive_mps2 = 2.2;
    double max_brake_mps2 = 4.5;
    double max_jerk_mps3 = 5.0;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("vehicle", self.vehicle);
      v("speed", self.speed);
      v("start_speed_mps", self.start_speed_mps);
      v("friction", self.friction);
      v("max_drive_mps2", self.max_drive_mps2);
      v("max_brake_mps2", self.max_brake_mps2);
      v("max_jerk_mps3", self.max_jerk_mps3);
    }
    void validate() const;
  };

  struct State {
    double t_s = 0.0;
    double s_m = 0.0;                                    ///< along the road
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the centre of gravity
    double yaw_rad = 0.0, yaw_rate_rps = 0.0;
    double forward_mps = 0.0, left_mps = 0.0;      ///< of the centre of gravity
    double forward_mps2 = 0.0, left_mps2 = 0.0;    ///< inertial
    double height_m = 0.0, height_rate_mps = 0.0;  ///< of the centre of gravity, world
    double pitch_rad = 0.0, pitch_rate_rps = 0.0;  ///< about the left axis: nose down > 0
    double roll_rad = 0.0, roll_rate_rps = 0.0;    ///< about the forward axis: left side up > 0
    double steering_rad = 0.0;
    double command_mps2 = 0.0;
    Eigen::Vector4d wheel_loads_n = Eigen::Vector4d::Zero();  ///< front left, front right, rear left, rear right
  };

  VehicleDrive(std::uint64_t seed, const Params& params, const Road& road, const Terrain& terrain);

  /// One step of kStep_s.
  void step(const Road& road, const Terrain& terrain);

  const State& state() const { return state_; }
  Pose T_world_base() const;

 private:
  struct AxleForces {
    double front_n, rear_n;
  };
  double roadHeight(const Terrain& terrain, double forward_m, double left_m) const;
  void drive(const Road& road);
  AxleForces lateralForces() const;
  void moveOnPlane(double slope, double bank);
  void moveOnSprings(const Eigen::Vector4d& ground_m);

  Params params_;
  SpeedProfile speed_;
  State state_;
  Eigen::Vector4d ground_m_ = Eigen::Vector4d::Zero();  ///< height under the wheels, one step ago
  double target_mps_ = 0.0;
  int steps_ = 0;
};

}  // namespace fail_aware
