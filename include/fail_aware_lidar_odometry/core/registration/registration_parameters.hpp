// The parameters of the three measurements and of what they share: the branch `registration` of the parameters' tree.
#pragma once

#include "fail_aware_lidar_odometry/core/registration/beam_ranges.hpp"
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

namespace fail_aware {

struct RegistrationParameters {
  bool use_point = true;  ///< the three measurements, each can be left out (the article's "2 measurements")
  bool use_plane = true;
  bool use_corners = true;
  bool refine_correction = true;  ///< correct once more, by the registered motion, what joins the reference
                                  ///< (its turn only where turn_search found none; not what came compensated)
  RegistrationCloudBuilder::Params cloud;
  ReferenceMap::Params reference;
  MotionInitialization::Params initialization;
  RoadRelief::Params relief;
  Relocalization::Params relocalization;
  TurnSearch::Params turn_search;
  BeamRanges::Params beam_ranges;
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
    v("beam_ranges", self.beam_ranges);
    v("standing", self.standing);
    v("point", self.point);
    v("plane", self.plane);
    v("corner_extraction", self.corner_extraction);
    v("corner_reference", self.corner_reference);
    v("corner_alignment", self.corner_alignment);
  }
  void validate() const;
};

}  // namespace fail_aware
