// The parameters that can change at run time, per nodelet: those of cfg/*.cfg, with the same names, mapped to the
// fields of the parameter structs. A test compares names, types and defaults.
#pragma once

#include "core/parameters/validate.hpp"
#include "core/pipeline_parameters.hpp"
#include "fusion_ukf_params.hpp"

namespace fail_aware {

struct FusionUkfTuning {
  FusionUkfNodeletParams node;
  RegistrationParameters registration;  ///< only which measurements are in use
  MeasurementFusion fusion;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("use_icp_point_to_point", self.registration.use_icp_point_to_point);
    v("use_icp_point_to_plane", self.registration.use_icp_point_to_plane);
    v("use_corner_svd", self.registration.use_corner_svd);
    v("deadline_s", self.node.deadline_s);
    v("late_deadline_s", self.node.late_deadline_s);
    v("first_deadline_s", self.node.first_deadline_s);
    v("queue_size", self.node.queue_size);
    v("max_reorder_s", self.node.max_reorder_s);
    v("absent_after_sweeps", self.node.absent_after_sweeps);
    v("gate_sigma", self.fusion.gate_sigma);
    v("min_weight", self.fusion.min_weight);
    v("agreement_distance_m", self.fusion.agreement_distance_m);
    v("agreement_yaw_deg", self.fusion.agreement_yaw_deg);
  }
  void checkRules() const {
    validate(node);
    validate(registration);
    validate(fusion);
  }
};

struct FailAwareMonitorTuning {
  MonitorParameters monitor;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("alert_limit_m", self.monitor.predictor.alert_limit_m);
    v("confidence", self.monitor.predictor.confidence);
    v("alarm_confidence", self.monitor.predictor.alarm_confidence);
    v("comfortable_deceleration_mps2", self.monitor.thresholds.comfortable_deceleration_mps2);
    v("failing_s", self.monitor.thresholds.failing_s);
    v("degraded_s", self.monitor.thresholds.degraded_s);
    v("disagreement_m", self.monitor.disagreement_m);
    v("min_information_ratio", self.monitor.min_information_ratio);
  }
  void checkRules() const {
    validate(monitor.predictor);
    validate(monitor.thresholds);
    validate(monitor);
  }
};

struct IcpPointToPointTuning {
  IcpPointToPoint::Params icp;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("seeds", self.icp.seeds);
    v("spread", self.icp.spread);
    v("max_refined_seeds", self.icp.max_refined_seeds);
    v("max_iterations", self.icp.max_iterations);
    v("max_distance_m", self.icp.max_distance_m);
    v("kernel_m", self.icp.kernel_m);
    v("min_inlier_ratio", self.icp.min_inlier_ratio);
  }
  void checkRules() const { validate(icp); }
};

struct IcpPointToPlaneTuning {
  IcpPointToPlane::Params icp;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("filter_normals", self.icp.filter_normals);
    v("heading_tolerance_deg", self.icp.heading_tolerance_deg);
    v("keep_ground", self.icp.keep_ground);
    v("ground_tolerance_deg", self.icp.ground_tolerance_deg);
    v("max_iterations", self.icp.max_iterations);
    v("max_distance_m", self.icp.max_distance_m);
    v("kernel_m", self.icp.kernel_m);
  }
  void checkRules() const { validate(icp); }
};

struct CornerSvdTuning {
  CornerAlignment alignment;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("association_distance_m", self.alignment.association_distance_m);
    v("min_corners", self.alignment.min_corners);
    v("max_residual_m", self.alignment.max_residual_m);
    v("min_baseline_m", self.alignment.min_baseline_m);
  }
  void checkRules() const { validate(alignment); }
};

}  // namespace fail_aware
