// All parameters of the odometry as one tree. The profile, vehicle and sensor files fill it, offline and on the
// vehicle. Keys are dotted names, e.g. `registration.icp_point_to_plane.kernel_m`. The profile's keys have two tiers:
// what a user may have to set (default.yaml) and what a developer varies (expert.yaml). Members that visit() leaves out
// are constants, with the reason for their value beside them.
#pragma once

#include <cmath>
#include <vector>

#include "core/estimation/measurement_fusion.hpp"
#include "core/estimation/pose_filter.hpp"
#include "core/estimation/vehicle/motion_derivatives.hpp"
#include "core/estimation/vehicle/vehicle_model.hpp"
#include "core/estimation/vehicle/vehicle_parameters.hpp"
#include "core/integrity/monitor.hpp"
#include "core/parameters/mounting.hpp"
#include "core/preprocessing/angle_corrections.hpp"
#include "core/preprocessing/correction.hpp"
#include "core/preprocessing/sweep_check.hpp"
#include "core/preprocessing/timing.hpp"
#include "core/preprocessing/vertical_reference.hpp"
#include "core/registration_parameters.hpp"

namespace fail_aware {

/// cfg/sensors/*.yaml: the sensor and its mounting.
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
    v("lidar_in_base", self.lidar_in_base, requireMounting);
  }
  Pose T_base_lidar() const { return mountingPose(lidar_in_base); }
  /// `timing` for points with corrected azimuth: in corrected azimuths the sweep begins at a different angle.
  SweepTimingParams correctedTiming() const {
    SweepTimingParams corrected = timing;
    if (azimuth.angle_deg != 0.0) {
      corrected.start_azimuth_deg = std::remainder(timing.start_azimuth_deg + azimuth.angle_deg, 360.0);
    }
    return corrected;
  }
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
  void checkRules() const { requireFiniteNumbers("cog_in_base", cog_in_base, 3); }
  Pose T_base_cog() const { return Pose(Eigen::Translation3d(Eigen::Vector3d(cog_in_base.data()))); }
};

/// cfg/profiles/*.yaml. The values in code are those of default.yaml and expert.yaml.
struct ProfileParameters {
  SweepCorrectionParams sweep_correction;
  VerticalReferenceParams vertical_reference;
  VehicleModel::Params model;
  MotionHistory::Params history;
  PoseFilter::Params filter;
  RegistrationParameters registration;
  MeasurementFusion fusion;
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
};

struct PipelineParameters {
  SensorParameters sensor;
  VehicleFileParameters vehicle;
  ProfileParameters profile;

  /// All keys in one namespace for `--set`: the profile's keys have no prefix.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("sensor", self.sensor);
    v("vehicle", self.vehicle);
    ProfileParameters::visit(self.profile, v);
  }
};

}  // namespace fail_aware
