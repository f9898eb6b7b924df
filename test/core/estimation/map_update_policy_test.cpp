#include "core/estimation/map_update_policy.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fail_aware::map_update_policy_test {
namespace {

using Decision = MapUpdatePolicy::Decision;
using Sweep = MapUpdatePolicy::Sweep;

bool isInserted(const Decision& decision) { return decision.update == MapUpdate::kInsert; }
bool isSkipped(const Decision& decision) { return decision.update == MapUpdate::kSkip; }
bool isRestart(const Decision& decision) { return decision.update == MapUpdate::kRestart; }

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

constexpr Sweep kMeasured = {true, true, true, false};
constexpr Sweep kPredicted = {true, false, false, false};
constexpr Sweep kFollowing = {true, false, false, false, true};
constexpr Sweep kHeld = {true, true, true, true};

/// Its first sweep is behind it.
MapUpdatePolicy underWay() {
  MapUpdatePolicy policy;
  policy.add({}, Sweep());
  return policy;
}

TEST(MapUpdatePolicy, TheFirstSweepBeginsIt) {
  MapUpdatePolicy policy;
  for (int drive = 0; drive < 2; ++drive) {
    const Decision first = policy.add({}, Sweep());
    EXPECT_TRUE(first.begins && isInserted(first)) << drive;
    EXPECT_FALSE(first.out_of_sight) << drive;
    EXPECT_FALSE(policy.add({}, Sweep()).begins) << "nobody measures yet";
    policy.clear();
  }
}

TEST(MapUpdatePolicy, NoReferenceBeginsBeforeMotion) {
  MapUpdatePolicy policy = underWay();
  EXPECT_TRUE(policy.add({{"m", &kNothingThere}, {"absent", nullptr}}, Sweep()).begins);
  EXPECT_FALSE(policy.add({{"m", &kNothingThere}, {"n", &kLost}}, Sweep()).begins);
  EXPECT_FALSE(policy.add({{"m", &kNothingThere}}, kPredicted).begins);
}

TEST(MapUpdatePolicy, APoseFromElsewhereIsNoReference) {
  MapUpdatePolicy policy = underWay();
  const std::vector<FusionInput> inputs = {{kIcpPointToPlane, &kNothingThere},
                                           {"gps", &kFound, FusionInput::Kind::kExternal}};
  EXPECT_TRUE(policy.add(inputs, Sweep()).begins);
}

TEST(MapUpdatePolicy, TakesInWhatIsObserved) {
  MapUpdatePolicy policy = underWay();
  const Decision measured = policy.add({{"m", &kFound}}, kMeasured);
  EXPECT_TRUE(isInserted(measured));
  EXPECT_FALSE(measured.begins || measured.out_of_sight);
  EXPECT_TRUE(isSkipped(policy.add({{"m", &kFound}}, kPredicted)));
}

TEST(MapUpdatePolicy, InsertsTheOtherHalfRevolution) {
  MapUpdatePolicy policy = underWay();
  const Decision half = policy.add(bothIcps(&kElsewhere, &kElsewhere), kFollowing);
  EXPECT_TRUE(isInserted(half));
  EXPECT_FALSE(half.begins || half.out_of_sight);
  EXPECT_TRUE(isInserted(policy.add({{kIcpPointToPlane, &kElsewhere}, {kIcpPointToPoint, nullptr}}, kFollowing)));
  EXPECT_TRUE(isSkipped(policy.add(bothIcps(&kElsewhere, &kElsewhere), kPredicted))) << "a prediction after others";
  Sweep unknown = kFollowing;
  unknown.motion_known = false;
  EXPECT_TRUE(isSkipped(policy.add(bothIcps(&kElsewhere, &kElsewhere), unknown))) << "a prediction at standstill";
  for (const Measurement* other : {&kLost, &kBlind, &kFound}) {
    EXPECT_TRUE(isSkipped(policy.add(bothIcps(other, &kElsewhere), kFollowing))) << "not seen elsewhere by both";
  }
  EXPECT_TRUE(isSkipped(policy.add({{"gps", &kElsewhere}}, kFollowing)));
}

TEST(MapUpdatePolicy, SkipsTheFirstTwoMeasuredAfterALongGap) {
  MapUpdatePolicy policy = underWay();
  Sweep usual = kMeasured, after_gap = kMeasured, blind = kPredicted;
  usual.dt_s = blind.dt_s = 0.1;
  after_gap.dt_s = 2.0;
  EXPECT_TRUE(isInserted(policy.add({{"m", &kFound}}, usual)));
  EXPECT_TRUE(isSkipped(policy.add({{"m", &kFound}}, after_gap)));
  EXPECT_TRUE(isSkipped(policy.add({{"m", &kBlind}}, blind)));
  EXPECT_TRUE(isSkipped(policy.add({{"m", &kFound}}, usual)));
  EXPECT_TRUE(isInserted(policy.add({{"m", &kFound}}, usual)));
  after_gap.dt_s = 1.0;
  EXPECT_TRUE(isInserted(policy.add({{"m", &kFound}}, after_gap))) << "a shorter one";
  for (int i = 0; i < 20; ++i) policy.add({{"m", &kBlind}}, blind);
  EXPECT_TRUE(isSkipped(policy.add({{"m", &kFound}}, usual))) << "2 s without a measurement";
  EXPECT_TRUE(policy.add({{"m", &kNothingThere}}, Sweep()).begins) << "a reference begins with any";
  policy.clear();
  policy.add({}, Sweep());
  EXPECT_TRUE(isInserted(policy.add({{"m", &kFound}}, usual)));
}

TEST(MapUpdatePolicy, RestartsAfterTenSoughtSweeps) {
  MapUpdatePolicy policy = underWay();
  for (int round = 0; round < 2; ++round) {
    for (int i = 1; i <= 10; ++i) {
      const Decision lost = policy.add({{"m", i % 2 == 0 ? &kLost : &kFound}}, kPredicted);
      EXPECT_TRUE(isSkipped(lost)) << round << ", " << i;
      for (const Measurement* silent : {&kBlind, static_cast<const Measurement*>(nullptr)}) {
        EXPECT_TRUE(isSkipped(policy.add({{"m", silent}}, kPredicted))) << "who has not looked does not count";
      }
    }
    const Decision begun = policy.add({{"m", &kLost}}, kPredicted);
    EXPECT_TRUE(isRestart(begun) && begun.out_of_sight) << round;
    EXPECT_FALSE(begun.begins) << "it was not measured";
  }
}

TEST(MapUpdatePolicy, OneThatIsFoundEndsTheRow) {
  MapUpdatePolicy policy = underWay();
  for (int i = 0; i < 10; ++i) policy.add({{"m", &kLost}}, kPredicted);
  policy.add({{"m", &kFound}}, kMeasured);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(isRestart(policy.add({{"m", &kLost}}, kPredicted))) << i;
  EXPECT_TRUE(isRestart(policy.add({{"m", &kLost}}, kPredicted)));
}

TEST(MapUpdatePolicy, BeginsAnewAtTheTenthSweepThatTellsNoMotion) {
  MapUpdatePolicy policy = underWay();
  for (int round = 0; round < 2; ++round) {
    for (int i = 1; i < 10; ++i) EXPECT_FALSE(isRestart(policy.add({{"m", &kFound}}, kHeld))) << round << ", " << i;
    const Decision begun = policy.add({{"m", &kFound}}, kHeld);
    EXPECT_TRUE(isRestart(begun)) << round;
    EXPECT_FALSE(begun.out_of_sight) << round;
  }
  for (int i = 0; i < 9; ++i) policy.add({{"m", &kFound}}, kHeld);
  policy.add({{"m", &kFound}}, kMeasured);
  EXPECT_FALSE(isRestart(policy.add({{"m", &kFound}}, kHeld))) << "one that tells ends the row";
}

TEST(MapUpdatePolicy, SweepsWithoutAMeasurementSpoilNoMap) {
  MapUpdatePolicy policy = underWay();
  Sweep blind = kPredicted;
  blind.velocity_unobservable = true;  // of the last measured sweep
  policy.add({{"m", &kFound}}, kHeld);
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(isSkipped(policy.add({{"m", &kBlind}}, blind))) << i;
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(isRestart(policy.add({{"m", &kFound}}, kHeld))) << i;
  EXPECT_TRUE(isRestart(policy.add({{"m", &kFound}}, kHeld))) << "the tenth that is measured";
}

/// Their error from before is in the new map: a gap that was open must not be forgiven.
TEST(MapUpdatePolicy, LostMotionRestarts) {
  MapUpdatePolicy policy = underWay();
  Sweep lost = kMeasured;
  lost.motion_lost = true;
  const std::vector<FusionInput> measured = bothIcps(&kFound, &kFound);
  EXPECT_TRUE(isInserted(policy.add(measured, kMeasured)));
  EXPECT_TRUE(isRestart(policy.add(measured, lost)));
  EXPECT_TRUE(isInserted(policy.add(measured, kMeasured)));
}

TEST(MapUpdatePolicy, BeginsAnewWhereBothIcpsBeganTheirs) {
  MapUpdatePolicy policy = underWay();
  const Decision begun = policy.add(bothIcps(&kNothingThere, &kNothingThere), kPredicted);
  EXPECT_TRUE(isRestart(begun));
  EXPECT_FALSE(begun.begins || begun.out_of_sight);
  EXPECT_FALSE(isRestart(policy.add(bothIcps(&kNothingThere, &kFound), kMeasured))) << "one of them was started anew";
  EXPECT_FALSE(isRestart(policy.add({{"corner_svd", &kNothingThere}}, kPredicted))) << "it is no ICP";
  EXPECT_FALSE(isRestart(policy.add(bothIcps(nullptr, nullptr), kPredicted))) << "nobody speaks";
}

TEST(MapUpdatePolicy, AfterAPoseIsSetTheIcpsMustBeginAnew) {
  MapUpdatePolicy policy = underWay();
  policy.setPose();
  EXPECT_FALSE(isRestart(policy.add(bothIcps(&kNothingThere, &kNothingThere), kPredicted)));
  EXPECT_TRUE(isRestart(policy.add(bothIcps(&kNothingThere, &kNothingThere), kPredicted)))
      << "a sweep later by themselves";
}

}  // namespace
}  // namespace fail_aware::map_update_policy_test
