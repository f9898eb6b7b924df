// All parameters of the odometry as one tree: what the profile, vehicle and sensor files fill, offline and on the
// vehicle alike. Keys are the dotted names, e.g. `registration.plane.kernel_m`.
#pragma once

#include <vector>

#include "fail_aware_lidar_odometry/core/fail_aware/monitor.hpp"
#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"
#include "fail_aware_lidar_odometry/core/fusion/measurement_fusion.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_alignment.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_extraction.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_reference.hpp"
#include "fail_aware_lidar_odometry/core/registration/motion_initialization.hpp"
#include "fail_aware_lidar_odometry/core/registration/multiplex_icp.hpp"
#include "fail_aware_lidar_odometry/core/registration/normal_filtered_icp.hpp"
#include "fail_aware_lidar_odometry/core/registration/reference_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_cloud.hpp"
#include "fail_aware_lidar_odometry/core/registration/relocalization.hpp"
#include "fail_aware_lidar_odometry/core/registration/road_relief.hpp"
#include "fail_aware_lidar_odometry/core/registration/standing_match.hpp"
#include "fail_aware_lidar_odometry/core/registration/turn_search.hpp"
#include "fail_aware_lidar_odometry/core/sweep/correction.hpp"
#include "fail_aware_lidar_odometry/core/sweep/level_keeping.hpp"
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
  SweepCheckParams check;
  std::vector<double> lidar_in_base = {0, 0, 0, 0, 0, 0};  ///< x y z (m) roll pitch yaw (rad) of the lidar in base_link

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("timing", self.timing);
    v("vertical_angle", self.vertical_angle);
    v("check", self.check);
    v("lidar_in_base", self.lidar_in_base);
  }
  void validate() const;
  Pose T_base_lidar() const;
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

struct RegistrationParameters {
  bool use_point = true;  ///< the three measurements, each can be left out (the article's "2 measurements")
  bool use_plane = true;
  bool use_corners = true;
  bool refine_correction = true;  ///< correct once more, by the registered motion, what joins the reference
  RegistrationCloudBuilder::Params cloud;
  ReferenceMap::Params reference;
  MotionInitialization::Params initialization;
  RoadRelief::Params relief;
  Relocalization::Params relocalization;
  TurnSearch::Params turn_search;
  StandingMatch::Params standing;
  MultiplexIcp::Params point;
  NormalFilteredIcp::Params plane;
  CornerExtractor::Params corner_extraction;
  CornerReference::Params corner_reference;
  CornerAlignment::Params corner_alignment;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("use_point", self.use_point);
    v("use_plane", self.use_plane);
    v("use_corners", self.use_corners);
    v("refine_correction", self.refine_correction);
    v("cloud", self.cloud);
    v("reference", self.reference);
    v("initialization", self.initialization);
    v("relief", self.relief);
    v("relocalization", self.relocalization);
    v("turn_search", self.turn_search);
    v("standing", self.standing);
    v("point", self.point);
    v("plane", self.plane);
    v("corner_extraction", self.corner_extraction);
    v("corner_reference", self.corner_reference);
    v("corner_alignment", self.corner_alignment);
  }
  void validate() const;
};

/// cfg/profiles/*.yaml
struct ProfileParameters {
  SweepCorrectionParams sweep_correction;
  LevelKeepingParams level_keeping;
  VehicleModel::Params model;
  MotionHistory::Params history;
  RoadPlaneEstimator::Params road;
  Ukf::Params ukf;
  PoseFilter::Params filter;
  RegistrationParameters registration;
  MeasurementFusion::Params fusion;
  MonitorParameters monitor;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("sweep_correction", self.sweep_correction);
    v("level_keeping", self.level_keeping);
    v("model", self.model);
    v("history", self.history);
    v("road", self.road);
    v("ukf", self.ukf);
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
