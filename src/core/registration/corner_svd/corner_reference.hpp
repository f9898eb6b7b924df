// The reference corners in odom that a sweep's corners are aligned with (paper, section "SVD Cornering Algorithm").
//
// `sweeps` = 1 is the paper: the corners of the last sweep alone. With more, a corner stays for that many sweeps after
// its last sighting, at the mean of its sightings. The n-th sighting weighs 1/n: the first sightings fix the corner, so
// it does not follow the odometry's drift.
// Frames: new corners in the frame of the centre of gravity, the reference in odom; m.
// Cost: microseconds.
#pragma once

#include <vector>

#include "core/geometry/pose.hpp"
#include "core/parameters/check.hpp"
#include "core/registration/corner_svd/corner.hpp"

namespace fail_aware {

class CornerReference {
 public:
  struct Params {
    int sweeps = 20;
    /// sightings nearer than this are one corner: the odometry drifts less than this within `sweeps`
    double merge_distance_m = 0.3;
    double max_normal_difference_deg = 15.0;  ///< largest angle between the normals of sightings of one corner
    /// corners farther from the vehicle are removed: corners are extracted up to 50 m
    double max_range_m = 60.0;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("sweeps", self.sweeps, within(1, 1000000));
    }
  };

  explicit CornerReference(const Params& params) : params_(params) {}

  /// Adds a sweep's corners at the estimated pose. Ignores an estimate that is not finite.
  void update(const std::vector<Corner>& corners_cog, const Pose& T_odom_cog);
  void clear() { corners_odom_.clear(); }
  const std::vector<Corner>& corners() const { return corners_odom_; }

 private:
  Params params_;
  std::vector<Corner> corners_odom_;
};

}  // namespace fail_aware
