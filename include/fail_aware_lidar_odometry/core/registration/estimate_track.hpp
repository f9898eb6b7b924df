// What registration has to know of the filter's estimates so far: where the references took a sweep in last, which
// intervals have passed since, and whether the speed is observed. Not in the paper.
//
// Input: FilterState of every sweep, registered here or not, in order. Twists: m/s and rad/s, of the centre of gravity.
#pragma once

#include <optional>
#include <vector>

#include "fail_aware_lidar_odometry/core/registration/clock_jump_detector.hpp"
#include "fail_aware_lidar_odometry/core/types/filter_state.hpp"

namespace fail_aware {

class EstimateTrack {
 public:
  /// Of the newest estimate.
  struct Increment {
    bool between_measured = false;  ///< it and the one before are no mere predictions
    /// The motion between the two, where they tell one: an increment from a prediction holds the prediction's error.
    std::optional<Vector6d> twist_cog;
  };

  Increment add(const FilterState& state);

  /// The map begins with the sweep of the newest estimate: by definition it is where it is.
  void beginAt(const FilterState& state);

  /// The newest estimate is no mere prediction.
  bool measured() const { return measured_; }

  bool speedObserved() const { return speed_observed_; }
  bool speedWasObserved() const { return speed_was_observed_; }
  /// Of the speed, 0 where it is observed.
  double speedSigma_mps() const { return speed_sigma_mps_; }

  /// The newest estimate that references took in.
  const Pose& T_odom_cog_placed() const { return T_odom_cog_placed_; }
  /// The motion then, if it is known.
  const std::optional<Vector6d>& placedTwist() const { return placed_twist_cog_; }
  /// The intervals since.
  const std::vector<ClockJumpDetector::Stamps>& unplaced() const { return unplaced_; }
  /// After so many intervals what the car does now is not known well enough.
  bool tooManyUnplaced() const { return unplaced_.size() >= kMaxUnplaced; }

 private:
  static constexpr std::size_t kMaxUnplaced = 10;

  void setPlaced(const Pose& T_odom_cog);

  bool measured_ = false;
  bool speed_observed_ = false;  ///< the filter does not coast
  bool speed_was_observed_ = false;
  double speed_sigma_mps_ = 0.0;
  Pose T_odom_cog_placed_ = Pose::Identity();
  std::optional<Vector6d> placed_twist_cog_;
  std::vector<ClockJumpDetector::Stamps> unplaced_{};
};

}  // namespace fail_aware
