// The odometry metric of the KITTI benchmark (Geiger, Lenz, Urtasun, CVPR 2012), segment for segment as its development
// kit computes it; the figures of the article (section "Ranking Evaluation") are of this kind.
//
// From every `step`-th pose, for every length: the segment ends at the first pose whose distance along the ground truth
// exceeds the length. Its error is the relative pose E = (estimated motion)^-1 (true motion); |t_E| and the angle of
// R_E are divided by the nominal length. All segments count alike, so lengths with more segments weigh more.
//
// Both trajectories in the same moving frame, pose by pose (equal counts, else InputError); the frames of their first
// poses do not matter. A run in which no segment fits gives `segments` 0 and errors 0: check the count.
// Cost: O(poses / step x lengths x log poses).
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/pose.hpp"

namespace fail_aware {

struct KittiMetric {
  struct Params {
    std::vector<double> lengths_m = {100, 200, 300, 400, 500, 600, 700, 800};
    int step = 10;
    void validate() const;

    /// For runs in which no segment of 100 m fits.
    static Params forShortRuns() { return {{5, 10, 20, 40, 80}, 1}; }
  };

  struct Average {
    double length_m = 0.0;  ///< 0 for all lengths together
    std::size_t segments = 0;
    double t_err_percent = 0.0;
    double r_err_deg_per_m = 0.0;
  };

  Average total;
  std::vector<Average> per_length;  ///< in the order of Params::lengths_m
};

/// Path length (m) from the first pose to each pose.
std::vector<double> distancesAlong(const std::vector<Pose>& poses);

/// Index of the first pose whose distance from pose `first` exceeds length_m; none if the run ends before.
std::optional<std::size_t> segmentEnd(const std::vector<double>& distances_m, std::size_t first, double length_m);

/// First and last pose of each segment of that length, from every `step`-th pose.
std::vector<std::pair<std::size_t, std::size_t>> segmentsOf(const std::vector<double>& distances_m, double length_m,
                                                            int step);

KittiMetric kittiMetric(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                        const KittiMetric::Params& params = {});

}  // namespace fail_aware
