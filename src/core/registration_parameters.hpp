// The parameters of the three measurements and of their shared stages: the branch `registration` of the parameter tree.
#pragma once

#include "core/aiding/above_ground_matcher.hpp"
#include "core/aiding/road_profile_odometry.hpp"
#include "core/initial_guess/deskew_refinement.hpp"
#include "core/initial_guess/motion_initialization.hpp"
#include "core/initial_guess/relocalization.hpp"
#include "core/map/local_map.hpp"
#include "core/parameters/check.hpp"
#include "core/preprocessing/registration_cloud.hpp"
#include "core/registration/beam_bias_estimator.hpp"
#include "core/registration/corner_svd/corner_alignment.hpp"
#include "core/registration/corner_svd/corner_extraction.hpp"
#include "core/registration/corner_svd/corner_reference.hpp"
#include "core/registration/icp_point_to_plane.hpp"
#include "core/registration/icp_point_to_point.hpp"

namespace fail_aware {

struct RegistrationParameters {
  bool use_icp_point_to_point =
      true;  ///< the three measurements; each can be switched off (the paper's "2 measurements")
  bool use_icp_point_to_plane = true;
  bool use_corner_svd = true;
  /// Deskew the inserted sweep again for the registered motion (for its turn rate only where deskew_refinement found
  /// none; never if it came compensated).
  bool refine_deskew = true;
  RegistrationCloudBuilder::Params cloud;
  LocalMap::Params reference;
  MotionInitialization::Params initialization;
  RoadProfileOdometry::Params road_profile;
  Relocalization::Params relocalization;
  DeskewRefinement::Params deskew_refinement;
  BeamBiasEstimator::Params beam_bias;
  AboveGroundMatcher::Params above_ground;
  IcpPointToPoint::Params icp_point_to_point;
  IcpPointToPlane::Params icp_point_to_plane;
  CornerExtractor::Params corner_extraction;
  CornerReference::Params corner_reference;
  CornerAlignment corner_alignment;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("use_icp_point_to_point", self.use_icp_point_to_point);
    v("use_icp_point_to_plane", self.use_icp_point_to_plane);
    v("use_corner_svd", self.use_corner_svd);
    v("refine_deskew", self.refine_deskew);
    v("cloud", self.cloud);
    v("reference", self.reference);
    v("initialization", self.initialization);
    v("road_profile", self.road_profile);
    v("relocalization", self.relocalization);
    v("deskew_refinement", self.deskew_refinement);
    v("beam_bias", self.beam_bias);
    v("above_ground", self.above_ground);
    v("icp_point_to_point", self.icp_point_to_point);
    v("icp_point_to_plane", self.icp_point_to_plane);
    v("corner_extraction", self.corner_extraction);
    v("corner_reference", self.corner_reference);
    v("corner_alignment", self.corner_alignment);
  }
  void checkRules() const {
    requireParameter(use_icp_point_to_point || use_icp_point_to_plane, "use_icp_point_to_point", use_icp_point_to_point,
                     "true, or use_icp_point_to_plane be true (corners alone cannot find the first motion)");
  }
};

}  // namespace fail_aware
