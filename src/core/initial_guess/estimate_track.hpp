// What registration needs from the filter's estimates so far: the last inserted sweep, the intervals since then, and
// whether the speed is observed. Not in the paper.
//
// Input: FilterState of every sweep, registered here or not, in order. Twists: m/s and rad/s, of the centre of gravity.
#pragma once

#include <optional>
#include <vector>

#include "core/initial_guess/clock_jump_detector.hpp"
#include "core/types/filter_state.hpp"

namespace fail_aware {

class EstimateTrack {
 public:
  /// Of the newest estimate.
  struct Increment {
    bool between_measured = false;  ///< the newest and the previous estimate both come from measurements
    /// The motion between the two, if known: an increment from a dead-reckoned estimate contains the error of dead
    /// reckoning.
    std::optional<Vector6d> twist_cog;
  };

  Increment add(const FilterState& state);

  /// The map begins with the sweep of the newest estimate, so its pose is exact by definition.
  void beginAt(const FilterState& state);

  /// The newest estimate comes from a measurement.
  bool measured() const { return measured_; }

  bool speedObserved() const { return speed_observed_; }
  bool speedWasObserved() const { return speed_was_observed_; }
  /// Sigma of the speed; 0 where the speed is observed.
  double speedSigma_mps() const { return speed_sigma_mps_; }

  /// The newest estimate whose sweep was inserted into the references.
  const Pose& T_odom_cog_placed() const { return T_odom_cog_placed_; }
  /// The motion at that time, if known.
  const std::optional<Vector6d>& placedTwist() const { return placed_twist_cog_; }
  /// The intervals since then.
  const std::vector<ClockJumpDetector::Stamps>& unplaced() const { return unplaced_; }
  /// After this many intervals the current motion is not known well enough.
  bool tooManyUnplaced() const { return unplaced_.size() >= kMaxUnplaced; }

 private:
  static constexpr std::size_t kMaxUnplaced = 10;

  void setPlaced(const Pose& T_odom_cog);

  bool measured_ = false;
  bool speed_observed_ = false;  ///< the filter does not use dead reckoning
  bool speed_was_observed_ = false;
  double speed_sigma_mps_ = 0.0;
  Pose T_odom_cog_placed_ = Pose::Identity();
  std::optional<Vector6d> placed_twist_cog_;
  std::vector<ClockJumpDetector::Stamps> unplaced_{};
};

}  // namespace fail_aware
