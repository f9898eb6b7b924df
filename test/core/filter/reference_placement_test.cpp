#include "fail_aware_lidar_odometry/core/filter/reference_placement.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fail_aware {
namespace {

using Placement = ReferencePlacement::Placement;
using Sweep = ReferencePlacement::Sweep;

Measurement withStatus(MeasurementStatus status, int iterations = 0) {
  Measurement measurement;
  measurement.status = status;
  measurement.iterations = iterations;
  return measurement;
}

const Measurement kFound = withStatus(MeasurementStatus::kOk, 5);
const Measurement kNothingThere = withStatus(MeasurementStatus::kNoReference);
const Measurement kLost = withStatus(MeasurementStatus::kNotConverged);
const Measurement kElsewhere = withStatus(MeasurementStatus::kTooFewPoints, 1);
const Measurement kBlind = withStatus(MeasurementStatus::kTooFewPoints);

std::vector<FusionInput> bothIcps(const Measurement* points, const Measurement* planes) {
  return {{kIcpPointToPoint, points}, {kIcpPointToPlane, planes}};
}

constexpr Sweep kMeasured = {true, true, false};
constexpr Sweep kPredicted = {true, false, false};
constexpr Sweep kFollowing = {true, false, false, true};
constexpr Sweep kHeld = {true, true, true};

/// Its first sweep is behind it.
ReferencePlacement underWay() {
  ReferencePlacement placement;
  placement.add({}, Sweep());
  return placement;
}

TEST(ReferencePlacement, TheFirstSweepBeginsIt) {
  ReferencePlacement placement;
  for (int drive = 0; drive < 2; ++drive) {
    const Placement first = placement.add({}, Sweep());
    EXPECT_TRUE(first.begins && first.placed) << drive;
    EXPECT_FALSE(first.anew || first.out_of_sight) << drive;
    EXPECT_FALSE(placement.add({}, Sweep()).begins) << "nobody measures yet";
    placement.clear();
  }
}

TEST(ReferencePlacement, BeforeAMotionIsKnownWhatHasNothingToRegisterAgainstBeginsIt) {
  ReferencePlacement placement = underWay();
  EXPECT_TRUE(placement.add({{"m", &kNothingThere}, {"absent", nullptr}}, Sweep()).begins);
  EXPECT_FALSE(placement.add({{"m", &kNothingThere}, {"n", &kLost}}, Sweep()).begins);
  EXPECT_FALSE(placement.add({{"m", &kNothingThere}}, kPredicted).begins);
}

TEST(ReferencePlacement, TakesInWhatIsObserved) {
  ReferencePlacement placement = underWay();
  const Placement measured = placement.add({{"m", &kFound}}, kMeasured);
  EXPECT_TRUE(measured.placed);
  EXPECT_FALSE(measured.begins || measured.anew || measured.out_of_sight);
  EXPECT_FALSE(placement.add({{"m", &kFound}}, kPredicted).placed);
}

TEST(ReferencePlacement, TakesInTheOtherHalfOfARevolutionAtAGoodPrediction) {
  ReferencePlacement placement = underWay();
  const Placement half = placement.add(bothIcps(&kElsewhere, &kElsewhere), kFollowing);
  EXPECT_TRUE(half.placed);
  EXPECT_FALSE(half.begins || half.anew || half.out_of_sight);
  EXPECT_TRUE(placement.add({{kIcpPointToPlane, &kElsewhere}, {kIcpPointToPoint, nullptr}}, kFollowing).placed);
  EXPECT_FALSE(placement.add(bothIcps(&kElsewhere, &kElsewhere), kPredicted).placed) << "a prediction after others";
  Sweep unknown = kFollowing;
  unknown.motion_known = false;
  EXPECT_FALSE(placement.add(bothIcps(&kElsewhere, &kElsewhere), unknown).placed) << "a prediction at standstill";
  for (const Measurement* other : {&kLost, &kBlind, &kFound}) {
    EXPECT_FALSE(placement.add(bothIcps(other, &kElsewhere), kFollowing).placed) << "not seen elsewhere by both";
  }
  EXPECT_FALSE(placement.add({{"gps", &kElsewhere}}, kFollowing).placed);
}

TEST(ReferencePlacement, IsOutOfSightAfterMoreThanTenSweepsThatWereSought) {
  ReferencePlacement placement = underWay();
  for (int round = 0; round < 2; ++round) {
    for (int i = 1; i <= 10; ++i) {
      const Placement lost = placement.add({{"m", i % 2 == 0 ? &kLost : &kFound}}, kPredicted);
      EXPECT_FALSE(lost.placed || lost.anew) << round << ", " << i;
      for (const Measurement* silent : {&kBlind, static_cast<const Measurement*>(nullptr)}) {
        EXPECT_FALSE(placement.add({{"m", silent}}, kPredicted).placed) << "who has not looked does not count";
      }
    }
    const Placement begun = placement.add({{"m", &kLost}}, kPredicted);
    EXPECT_TRUE(begun.placed && begun.anew && begun.out_of_sight) << round;
    EXPECT_FALSE(begun.begins) << "it was not measured";
  }
}

TEST(ReferencePlacement, OneThatIsFoundEndsTheRow) {
  ReferencePlacement placement = underWay();
  for (int i = 0; i < 10; ++i) placement.add({{"m", &kLost}}, kPredicted);
  placement.add({{"m", &kFound}}, kMeasured);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(placement.add({{"m", &kLost}}, kPredicted).anew) << i;
  EXPECT_TRUE(placement.add({{"m", &kLost}}, kPredicted).anew);
}

TEST(ReferencePlacement, BeginsAnewAtTheTenthSweepThatTellsNoMotion) {
  ReferencePlacement placement = underWay();
  for (int round = 0; round < 2; ++round) {
    for (int i = 1; i < 10; ++i) EXPECT_FALSE(placement.add({{"m", &kFound}}, kHeld).anew) << round << ", " << i;
    const Placement begun = placement.add({{"m", &kFound}}, kHeld);
    EXPECT_TRUE(begun.placed && begun.anew) << round;
    EXPECT_FALSE(begun.out_of_sight) << round;
  }
  for (int i = 0; i < 9; ++i) placement.add({{"m", &kFound}}, kHeld);
  placement.add({{"m", &kFound}}, kMeasured);
  EXPECT_FALSE(placement.add({{"m", &kFound}}, kHeld).anew) << "one that tells ends the row";
}

/// Their error from before is in the new map: a gap that was open must not be forgiven.
TEST(ReferencePlacement, BeginsAnewWhereBothIcpsBeganTheirs) {
  ReferencePlacement placement = underWay();
  const Placement begun = placement.add(bothIcps(&kNothingThere, &kNothingThere), kPredicted);
  EXPECT_TRUE(begun.placed && begun.anew);
  EXPECT_FALSE(begun.begins || begun.out_of_sight);
  EXPECT_FALSE(placement.add(bothIcps(&kNothingThere, &kFound), kMeasured).anew) << "one of them was started anew";
  EXPECT_FALSE(placement.add({{"corner_svd", &kNothingThere}}, kPredicted).anew) << "it is no ICP";
  EXPECT_FALSE(placement.add(bothIcps(nullptr, nullptr), kPredicted).anew) << "nobody speaks";
}

TEST(ReferencePlacement, AfterAPoseIsSetTheIcpsMustBeginAnew) {
  ReferencePlacement placement = underWay();
  placement.setPose();
  EXPECT_FALSE(placement.add(bothIcps(&kNothingThere, &kNothingThere), kPredicted).anew);
  EXPECT_TRUE(placement.add(bothIcps(&kNothingThere, &kNothingThere), kPredicted).anew)
      << "a sweep later by themselves";
}

}  // namespace
}  // namespace fail_aware
