// The parameters of the three measurements and of what they share: the branch `registration` of the parameters' tree.
#pragma once

#include "fail_aware_lidar_odometry/core/registration/beam_range_bias.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_alignment.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_extraction.hpp"
#include "fail_aware_lidar_odometry/core/registration/corner_reference.hpp"
#include "fail_aware_lidar_odometry/core/registration/motion_initialization.hpp"
#include "fail_aware_lidar_odometry/core/registration/icp_point_to_point.hpp"
#include "fail_aware_lidar_odometry/core/registration/icp_point_to_plane.hpp"
#include "fail_aware_lidar_odometry/core/registration/reference_map.hpp"
#include "fail_aware_lidar_odometry/core/registration/registration_cloud.hpp"
#include "fail_aware_lidar_odometry/core/registration/relocalization.hpp"
#include "fail_aware_lidar_odometry/core/registration/road_profile_odometry.hpp"
#include "fail_aware_lidar_odometry/core/registration/above_ground_matcher.hpp"
#include "fail_aware_lidar_odometry/core/registration/deskew_refinement.hpp"

namespace fail_aware {

struct RegistrationParameters {
  bool use_icp_point_to_point = true;  ///< the three measurements, each can be left out (the article's "2 measurements")
  bool use_icp_point_to_plane = true;
  bool use_corner_svd = true;
  bool refine_deskew = true;  ///< correct once more, by the registered motion, what joins the reference
                                  ///< (its turn only where deskew_refinement found none; not what came compensated)
  RegistrationCloudBuilder::Params cloud;
  ReferenceMap::Params reference;
  MotionInitialization::Params initialization;
  RoadProfileOdometry::Params road_profile;
  Relocalization::Params relocalization;
  DeskewRefinement::Params deskew_refinement;
  BeamRangeBias::Params beam_range_bias;
  AboveGroundMatcher::Params above_ground;
  IcpPointToPoint::Params icp_point_to_point;
  IcpPointToPlane::Params icp_point_to_plane;
  CornerExtractor::Params corner_extraction;
  CornerReference::Params corner_reference;
  CornerAlignment::Params corner_alignment;

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
    v("beam_range_bias", self.beam_range_bias);
    v("above_ground", self.above_ground);
    v("icp_point_to_point", self.icp_point_to_point);
    v("icp_point_to_plane", self.icp_point_to_plane);
    v("corner_extraction", self.corner_extraction);
    v("corner_reference", self.corner_reference);
    v("corner_alignment", self.corner_alignment);
  }
  void validate() const;
};

}  // namespace fail_aware
