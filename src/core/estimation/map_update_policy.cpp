#include "core/estimation/map_update_policy.hpp"

#include <algorithm>

#include "core/stamp_difference.hpp"

namespace fail_aware {

namespace {

constexpr int kMaxSkippedSweeps = 10;  // consecutive; one more means that the reference is out of sight
constexpr int kAfterGapSweeps = 2;     // the second is deskewed with the motion that the first one gives
constexpr int kMaxHeldSweeps = 10;     // consecutive; the last one restarts the reference

// A pose measured by one of the package's own sources, which register against the references.
bool isThere(const FusionInput& input) {
  return input.measurement != nullptr && input.kind == FusionInput::Kind::kPose;
}

bool isAnswerOfAnIcp(const FusionInput& input) { return isThere(input) && input.isOfAnIcp(); }

// There are measurements of that kind, and none of them had a reference.
bool haveNoReference(const std::vector<FusionInput>& inputs, bool (*isOfThose)(const FusionInput&)) {
  bool any = false;
  for (const FusionInput& input : inputs) {
    if (!isOfThose(input)) continue;
    if (input.measurement->status != MeasurementStatus::kNoReference) return false;
    any = true;
  }
  return any;
}

// A source without a message or without points did not search.
bool wasSought(const FusionInput& input) {
  return isThere(input) &&
         (input.measurement->iterations > 0 || input.measurement->status == MeasurementStatus::kNotConverged);
}

// Every ICP that answered searched once and found almost no pairs: the references do not hold what the sweep shows.
bool showsOtherThings(const std::vector<FusionInput>& inputs) {
  bool any = false;
  for (const FusionInput& input : inputs) {
    if (!isAnswerOfAnIcp(input)) continue;
    const Measurement& measurement = *input.measurement;
    if (measurement.status != MeasurementStatus::kTooFewPoints || measurement.iterations != 1) return false;
    any = true;
  }
  return any;
}

}  // namespace

bool canBegin(const std::vector<FusionInput>& measurements) {
  const auto has_points = [](const FusionInput& input) {
    return isAnswerOfAnIcp(input) && input.measurement->status != MeasurementStatus::kTooFewPoints;
  };
  const auto isAnIcp = [](const FusionInput& input) { return input.isOfAnIcp(); };
  return std::none_of(measurements.begin(), measurements.end(), isAnIcp) ||
         std::any_of(measurements.begin(), measurements.end(), has_points);
}

bool MapUpdatePolicy::followsGap(const Sweep& sweep) {
  unmeasured_s_ += sweep.dt_s;
  if (!sweep.measured) return false;
  if (started_ && unmeasured_s_ > kLongGap_s) after_gap_sweeps_ = kAfterGapSweeps;
  unmeasured_s_ = 0.0;
  if (after_gap_sweeps_ == 0) return false;
  --after_gap_sweeps_;
  return true;
}

MapUpdatePolicy::Decision MapUpdatePolicy::add(const std::vector<FusionInput>& measurements, const Sweep& sweep) {
  Decision decision;
  decision.begins = !started_ || (!sweep.motion_known && haveNoReference(measurements, isThere));
  const bool joins = sweep.motion_known && sweep.follows && showsOtherThings(measurements);
  const bool follows_gap = followsGap(sweep);
  if (decision.begins || (sweep.observed && !follows_gap) || joins) {
    decision.update = MapUpdate::kInsert;
    skipped_sweeps_ = 0;
  } else if (std::any_of(measurements.begin(), measurements.end(), wasSought) &&
             ++skipped_sweeps_ > kMaxSkippedSweeps) {
    skipped_sweeps_ = 0;
    decision.out_of_sight = true;
  }
  if (!sweep.velocity_unobservable) {
    held_sweeps_ = 0;
  } else if (sweep.measured) {
    ++held_sweeps_;
  }
  const bool icps_began = sweep.motion_known && !pose_set_ && haveNoReference(measurements, isAnswerOfAnIcp);
  const bool spoilt = held_sweeps_ >= kMaxHeldSweeps;
  if (spoilt || icps_began) held_sweeps_ = 0;
  if (decision.out_of_sight || spoilt || icps_began || sweep.motion_lost) decision.update = MapUpdate::kRestart;
  started_ = true;
  pose_set_ = false;
  return decision;
}

}  // namespace fail_aware
