// All parameters of the odometry as one tree: what the profile, vehicle and sensor files fill, offline and on the
// vehicle alike. Keys are the dotted names, e.g. `registration.icp_point_to_plane.kernel_m`. The profile's are of two tiers, what a
// user may have to set (default.yaml) and what a developer varies (expert.yaml); members that visit() leaves out are
// constants, with the reason for their value beside them.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/fail_aware/monitor.hpp"
#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"
#include "fail_aware_lidar_odometry/core/fusion/measurement_fusion.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_parameters.hpp"
#include "fail_aware_lidar_odometry/core/sweep/azimuth_correction.hpp"
#include "fail_aware_lidar_odometry/core/sweep/correction.hpp"
#include "fail_aware_lidar_odometry/core/sweep/vertical_reference.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_check.hpp"
#include "fail_aware_lidar_odometry/core/sweep/timing.hpp"
#include "fail_aware_lidar_odometry/core/sweep/vertical_angle_correction.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/motion_derivatives.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/road_plane.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/vehicle_model.hpp"
#include "fail_aware_lidar_odometry/core/vehicle/vehicle_parameters.hpp"

namespace fail_aware {

/// cfg/sensors/*.yaml: the head and where it sits.
struct SensorParameters {
  SweepTimingParams timing;
  VerticalAngleCorrectionParams vertical_angle;
  AzimuthCorrectionParams azimuth;
  SweepCheckParams check;
  std::vector<double> lidar_in_base = {0, 0, 0, 0, 0, 0};  ///< x y z (m) roll pitch yaw (rad) of the lidar in base_link

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("timing", self.timing);
    v("vertical_angle", self.vertical_angle);
    v("azimuth", self.azimuth);
    v("check", self.check);
    v("lidar_in_base", self.lidar_in_base);
  }
  void validate() const;
  Pose T_base_lidar() const;
  /// `timing` for points whose azimuth is corrected: the sweep begins at another azimuth of theirs.
  SweepTimingParams correctedTiming() const;
};

/// cfg/vehicles/*.yaml
struct VehicleFileParameters {
  VehicleParameters dynamics;
  std::vector<double> cog_in_base = {0, 0, 0};  ///< x y z (m) of the centre of gravity in base_link

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("dynamics", self.dynamics);
    v("cog_in_base", self.cog_in_base);
  }
  void validate() const;
  Pose T_base_cog() const;
};

/// cfg/profiles/*.yaml. The values in code are those of default.yaml and expert.yaml.
struct ProfileParameters {
  SweepCorrectionParams sweep_correction;
  LevelKeepingParams vertical_reference;
  VehicleModel::Params model;
  MotionHistory::Params history;
  RoadPlaneEstimator::Params road;  ///< constants
  Ukf::Params ukf;                  ///< constants
  PoseFilter::Params filter;
  RegistrationParameters registration;
  MeasurementFusion::Params fusion;
  MonitorParameters monitor;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("sweep_correction", self.sweep_correction);
    v("vertical_reference", self.vertical_reference);
    v("model", self.model);
    v("history", self.history);
    v("filter", self.filter);
    v("registration", self.registration);
    v("fusion", self.fusion);
    v("monitor", self.monitor);
  }
  void validate() const;
};

struct PipelineParameters {
  SensorParameters sensor;
  VehicleFileParameters vehicle;
  ProfileParameters profile;

  /// One flat namespace for `--set`: the profile's keys stand without a prefix.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("sensor", self.sensor);
    v("vehicle", self.vehicle);
    ProfileParameters::visit(self.profile, v);
  }
  void validate() const;
};

}  // namespace fail_aware
