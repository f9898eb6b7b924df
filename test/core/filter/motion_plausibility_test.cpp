#include "fail_aware_lidar_odometry/core/filter/motion_plausibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "../parameters/error_of.hpp"
#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"

namespace fail_aware {
namespace {

using Sweep = MotionPlausibility::Sweep;
using Doubt = MotionPlausibility::Doubt;

Sweep sound(double dt_s = 0.1) { return {dt_s, 0.02, 0.03, 0.5 * kDegree, 0.8}; }

/// After ten sound sweeps, `count` that are changed.
Doubt afterOdd(int count, const std::function<void(Sweep&)>& change, const MotionPlausibility::Params& params = {}) {
  MotionPlausibility plausibility(params);
  Doubt doubt;
  for (int i = 0; i < 10; ++i) doubt = plausibility.add(sound());
  for (int i = 0; i < count; ++i) {
    Sweep sweep = sound();
    change(sweep);
    doubt = plausibility.add(sweep);
  }
  return doubt;
}

void expectNone(const Doubt& doubt, const std::string& of) {
  EXPECT_EQ(doubt.sigma_m, 0.0) << of;
  EXPECT_EQ(doubt.sigma_yaw_rad, 0.0) << of;
  EXPECT_FALSE(doubt.unbelievable || doubt.tells_no_motion) << of;
}

TEST(MotionPlausibility, SoundSweepsAreNotDoubted) {
  MotionPlausibility plausibility{MotionPlausibility::Params()};
  for (int i = 0; i < 30; ++i) expectNone(plausibility.add(sound()), std::to_string(i));
}

TEST(MotionPlausibility, WhatMeasurementsStayApartBeyondTheUsualIsAdded) {
  const auto apart = [](Sweep& sweep) { sweep.undecided_m = 0.25; };
  expectNone(afterOdd(2, apart), "two of the last five");
  const Doubt lasting = afterOdd(3, apart);
  EXPECT_DOUBLE_EQ(lasting.sigma_m, 0.10);
  EXPECT_FALSE(lasting.unbelievable) << "one of them is right";
}

TEST(MotionPlausibility, MeasurementsOffThePredictionSweepAfterSweepAreAsUncertain) {
  const auto off = [](Sweep& sweep) { sweep.innovation_m = 0.12; };
  expectNone(afterOdd(4, off), "four of the last ten");
  const Doubt lasting = afterOdd(5, off);
  EXPECT_DOUBLE_EQ(lasting.sigma_m, 0.12);
  EXPECT_TRUE(lasting.unbelievable);
  EXPECT_FALSE(lasting.tells_no_motion) << "whoever brakes hard would never be believed again";
  expectNone(afterOdd(10, [](Sweep& sweep) { sweep.innovation_m = 0.067; }), "as sound sweeps at most");
}

TEST(MotionPlausibility, APredictionOverALongerIntervalMayBeOffByMore) {
  const auto slow = [](double innovation_m) {
    return afterOdd(10, [=](Sweep& sweep) {
      sweep.dt_s = 0.2;
      sweep.innovation_m = innovation_m;
    });
  };
  expectNone(slow(0.27), "below four times 0.07 m");
  EXPECT_DOUBLE_EQ(slow(0.29).sigma_m, 0.29);
}

TEST(MotionPlausibility, WhereLittleFitsTheMapTheIncrementIsOpen) {
  const auto fitting = [](double share) { return afterOdd(2, [=](Sweep& sweep) { sweep.fitting_share = share; }); };
  expectNone(fitting(0.3), "the least that is usual");
  EXPECT_NEAR(fitting(0.1).sigma_m, 0.25 * 2.0 / 3.0, 1e-12);
  EXPECT_TRUE(fitting(0.1).unbelievable && fitting(0.1).tells_no_motion);
  EXPECT_DOUBLE_EQ(fitting(0.0).sigma_m, 0.25);
  const Doubt once = afterOdd(1, [](Sweep& sweep) { sweep.fitting_share = 0.0; });
  EXPECT_EQ(once.sigma_m, 0.0) << "one of three";
  EXPECT_FALSE(once.unbelievable);
  EXPECT_TRUE(once.tells_no_motion) << "at once";
}

TEST(MotionPlausibility, WhereNothingHasFittedYetTheMotionIsLearnt) {
  MotionPlausibility plausibility{MotionPlausibility::Params()};
  Sweep unfitting = sound();
  unfitting.fitting_share = 0.1;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(plausibility.add(unfitting).tells_no_motion) << i;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(plausibility.add(sound()).tells_no_motion) << i;
  EXPECT_TRUE(plausibility.add(unfitting).tells_no_motion);
}

TEST(MotionPlausibility, WhatFittedIsForgottenWhereThePlanesStaySilent) {
  MotionPlausibility plausibility{MotionPlausibility::Params()};
  Sweep unfitting = sound(), silent = sound();
  unfitting.fitting_share = 0.0;
  silent.fitting_share = std::nullopt;
  for (int i = 0; i < 3; ++i) plausibility.add(unfitting);
  for (int i = 1; i <= 10; ++i) EXPECT_DOUBLE_EQ(plausibility.add(silent).sigma_m, 0.25) << i;
  expectNone(plausibility.add(silent), "eleven in a row");
}

TEST(MotionPlausibility, ATurnThatNoVehicleMakesMayBeWrongByAShare) {
  const auto turned = [](double turn_deg) {
    return afterOdd(1, [=](Sweep& sweep) { sweep.turn_rad = turn_deg * kDegree; });
  };
  expectNone(turned(4.4), "a bump in the road");
  EXPECT_NEAR(turned(6.0).sigma_yaw_rad, 0.6 * kDegree, 1e-12);
  EXPECT_EQ(turned(6.0).sigma_m, 0.0);
  EXPECT_TRUE(turned(6.0).unbelievable);
}

Sweep oddInAll() { return {0.1, 0.25, 0.12, 10.0 * kDegree, 0.0}; }

TEST(MotionPlausibility, DisagreementAndTheRestAddUpAsIndependentErrors) {
  const Doubt doubt = afterOdd(10, [](Sweep& sweep) { sweep = oddInAll(); });
  EXPECT_NEAR(doubt.sigma_m, std::hypot(0.10, 0.25), 1e-12) << "the larger one of innovation and unfitting";
}

TEST(MotionPlausibility, EachSignCanBeSwitchedOff) {
  MotionPlausibility::Params params;
  params.lasting_innovation_m = params.fitting_share = params.usual_turn_deg = 0.0;
  const Doubt doubt = afterOdd(
      10, [](Sweep& sweep) { sweep = oddInAll(); }, params);
  EXPECT_DOUBLE_EQ(doubt.sigma_m, 0.10) << "what measurements stay apart";
  EXPECT_EQ(doubt.sigma_yaw_rad, 0.0);
  EXPECT_FALSE(doubt.unbelievable || doubt.tells_no_motion);
}

TEST(MotionPlausibility, WhatTellsNoMotionIsSaidWhateverItAdds) {
  MotionPlausibility::Params params;
  params.unfitting_sigma_m = 0.0;
  const auto unfitting = [](Sweep& sweep) { sweep.fitting_share = 0.1; };
  EXPECT_TRUE(afterOdd(5, unfitting, params).tells_no_motion);
  MotionPlausibility plausibility(params);
  Sweep sweep = sound();
  unfitting(sweep);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(plausibility.add(sweep).tells_no_motion) << "nothing has fitted yet";
}

TEST(MotionPlausibility, ClearedItBeginsAnew) {
  MotionPlausibility plausibility{MotionPlausibility::Params()};
  Sweep odd = oddInAll();
  odd.turn_rad = 0.0;
  for (int i = 0; i < 3; ++i) plausibility.add(sound());
  for (int i = 0; i < 10; ++i) plausibility.add(odd);
  EXPECT_GT(plausibility.add(odd).sigma_m, 0.25);
  plausibility.clear();
  expectNone(plausibility.add(odd), "nothing lasts yet");
  plausibility.add(odd);
  EXPECT_DOUBLE_EQ(plausibility.add(odd).sigma_m, 0.25) << "the planes are heard from the third sweep on";
}

TEST(MotionPlausibility, ParametersAreChecked) {
  const auto refused = [](const std::function<void(MotionPlausibility::Params&)>& change) {
    MotionPlausibility::Params params;
    change(params);
    return errorOf([&] { MotionPlausibility plausibility(params); });
  };
  EXPECT_EQ(refused([](MotionPlausibility::Params&) {}), "no error");
  EXPECT_NE(refused([](auto& p) { p.lasting_disagreement_m = 0.0; }).find("lasting_disagreement_m = 0"),
            std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.lasting_innovation_m = -1.0; }).find("lasting_innovation_m"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.fitting_share = 1.1; }).find("fitting_share"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.unfitting_sigma_m = -0.1; }).find("unfitting_sigma_m"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.usual_turn_deg = std::nan(""); }).find("usual_turn_deg"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.wrong_share_of_turn = 2.0; }).find("wrong_share_of_turn"), std::string::npos);
}

}  // namespace
}  // namespace fail_aware
