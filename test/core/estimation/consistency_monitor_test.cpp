#include "core/estimation/consistency_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "../parameters/error_of.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::consistency_monitor_test {
namespace {

using Sweep = ConsistencyMonitor::Sweep;
using Inflation = ConsistencyMonitor::Inflation;

Sweep sound(double dt_s = 0.1) { return {dt_s, 0.02, 0.03, 0.5 * kDegree, 0.8}; }

/// After ten sound sweeps, `count` that are changed.
Inflation afterOdd(int count, const std::function<void(Sweep&)>& change,
                   const ConsistencyMonitor::Params& params = {}) {
  ConsistencyMonitor monitor(params);
  Inflation inflation;
  for (int i = 0; i < 10; ++i) inflation = monitor.add(sound());
  for (int i = 0; i < count; ++i) {
    Sweep sweep = sound();
    change(sweep);
    inflation = monitor.add(sweep);
  }
  return inflation;
}

void expectNone(const Inflation& inflation, const std::string& of) {
  EXPECT_EQ(inflation.doubt.sigma_m, 0.0) << of;
  EXPECT_EQ(inflation.doubt.sigma_yaw_rad, 0.0) << of;
  EXPECT_FALSE(inflation.unbelievable || inflation.velocity_unobservable) << of;
}

TEST(ConsistencyMonitor, SoundSweepsAreNotDoubted) {
  ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
  for (int i = 0; i < 30; ++i) expectNone(monitor.add(sound()), std::to_string(i));
}

TEST(ConsistencyMonitor, PersistentDisagreementInflates) {
  const auto apart = [](Sweep& sweep) { sweep.undecided_m = 0.25; };
  expectNone(afterOdd(2, apart), "two of the last five");
  const Inflation accumulated = afterOdd(3, apart);
  EXPECT_DOUBLE_EQ(accumulated.doubt.sigma_m, 0.10);
  EXPECT_FALSE(accumulated.unbelievable) << "one of them is right";
}

TEST(ConsistencyMonitor, PersistentInnovationInflates) {
  const auto off = [](Sweep& sweep) { sweep.innovation_m = 0.12; };
  expectNone(afterOdd(4, off), "four of the last ten");
  const Inflation accumulated = afterOdd(5, off);
  EXPECT_DOUBLE_EQ(accumulated.doubt.sigma_m, 0.12);
  EXPECT_TRUE(accumulated.unbelievable);
  EXPECT_FALSE(accumulated.velocity_unobservable) << "whoever brakes hard would never be believed again";
  expectNone(afterOdd(10, [](Sweep& sweep) { sweep.innovation_m = 0.08; }), "a jerky bend of a country road");
}

TEST(ConsistencyMonitor, LongIntervalAllowsMore) {
  const auto slow = [](double innovation_m) {
    return afterOdd(10, [=](Sweep& sweep) {
      sweep.dt_s = 0.2;
      sweep.innovation_m = innovation_m;
    });
  };
  expectNone(slow(0.39), "below four times 0.1 m");
  EXPECT_DOUBLE_EQ(slow(0.41).doubt.sigma_m, 0.41);
}

TEST(ConsistencyMonitor, WhereLittleFitsTheMapTheIncrementIsOpen) {
  const auto fitting = [](double share) { return afterOdd(2, [=](Sweep& sweep) { sweep.inlier_ratio = share; }); };
  expectNone(fitting(0.3), "the least that is usual");
  EXPECT_NEAR(fitting(0.1).doubt.sigma_m, 0.25 * 2.0 / 3.0, 1e-12);
  EXPECT_TRUE(fitting(0.1).unbelievable && fitting(0.1).velocity_unobservable);
  EXPECT_DOUBLE_EQ(fitting(0.0).doubt.sigma_m, 0.25);
  const Inflation once = afterOdd(1, [](Sweep& sweep) { sweep.inlier_ratio = 0.0; });
  EXPECT_EQ(once.doubt.sigma_m, 0.0) << "one of three";
  EXPECT_FALSE(once.unbelievable);
  EXPECT_TRUE(once.velocity_unobservable) << "at once";
}

TEST(ConsistencyMonitor, WhereNothingHasFittedYetTheMotionIsLearnt) {
  ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
  Sweep unfitting = sound();
  unfitting.inlier_ratio = 0.1;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(monitor.add(unfitting).velocity_unobservable) << i;
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(monitor.add(sound()).velocity_unobservable) << i;
  EXPECT_TRUE(monitor.add(unfitting).velocity_unobservable);
}

TEST(ConsistencyMonitor, YoungMapIsNotJudged) {
  ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
  Sweep sweep = sound();
  for (const double ratio : {0.24, 0.28, 0.43, 0.5, 0.54, 0.6}) {
    sweep.inlier_ratio = ratio;
    expectNone(monitor.add(sweep), std::to_string(ratio));
  }
  sweep.inlier_ratio = 0.1;
  EXPECT_TRUE(monitor.add(sweep).velocity_unobservable) << "it has grown up";
}

TEST(ConsistencyMonitor, ErrorsOfNoisySweepsAddUp) {
  const auto noisy = [](double rms_residual_m, int sweeps = 3) {
    return afterOdd(sweeps, [=](Sweep& sweep) {
      sweep.rms_residual_m = rms_residual_m;
      sweep.increment_sigma_m = 0.03;
      sweep.increment_sigma_yaw_rad = 0.001;
    });
  };
  expectNone(noisy(0.045), "rain");
  expectNone(noisy(0.2, 2), "two of the last five: the mount was hit");
  EXPECT_NEAR(noisy(0.06).doubt.sigma_m, 0.03 * std::sqrt(0.44), 1e-12);
  EXPECT_NEAR(noisy(0.2).doubt.sigma_m, 0.03, 1e-12);
  EXPECT_NEAR(noisy(0.2).doubt.sigma_yaw_rad, 0.001, 1e-12);
  EXPECT_FALSE(noisy(0.2).unbelievable || noisy(0.2).velocity_unobservable) << "R is too small, not wrong";
}

TEST(ConsistencyMonitor, SilentPlanesForgetTheFit) {
  ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
  Sweep unfitting = sound(), silent = sound();
  unfitting.inlier_ratio = 0.0;
  silent.inlier_ratio = std::nullopt;
  for (int i = 0; i < 5; ++i) monitor.add(unfitting);
  for (int i = 1; i <= 10; ++i) EXPECT_DOUBLE_EQ(monitor.add(silent).doubt.sigma_m, 0.25) << i;
  expectNone(monitor.add(silent), "eleven in a row");
}

TEST(ConsistencyMonitor, DisagreementAfterAGapStays) {
  const auto afterGap = [](int silent, double dt_s, int found) {
    return afterOdd(silent + found, [=, i = 0](Sweep& sweep) mutable {
      sweep.disagreement_m = 0.12;
      if (++i <= silent) sweep.inlier_ratio = std::nullopt;
      if (i <= silent + 1) sweep.dt_s = dt_s;
    });
  };
  EXPECT_DOUBLE_EQ(afterGap(12, 0.1, 1).doubt.sigma_m, 0.12) << "silent sweeps";
  EXPECT_DOUBLE_EQ(afterGap(0, 1.2, 1).doubt.sigma_m, 0.12) << "dropped sweeps";
  EXPECT_DOUBLE_EQ(afterGap(0, 1.2, 2).doubt.sigma_m, 0.12);
  EXPECT_FALSE(afterGap(0, 1.2, 1).unbelievable) << "R is too small, not wrong";
  expectNone(afterGap(0, 1.2, 3), "the third is as any other");
  expectNone(afterGap(5, 0.1, 1), "a short gap");
}

TEST(ConsistencyMonitor, ATurnThatNoVehicleMakesMayBeWrongByARatio) {
  const auto turned = [](double turn_deg) {
    return afterOdd(1, [=](Sweep& sweep) { sweep.turn_rad = turn_deg * kDegree; });
  };
  expectNone(turned(4.4), "a bump in the road");
  EXPECT_NEAR(turned(6.0).doubt.sigma_yaw_rad, 0.6 * kDegree, 1e-12);
  EXPECT_EQ(turned(6.0).doubt.sigma_m, 0.0);
  EXPECT_TRUE(turned(6.0).unbelievable);
}

TEST(ConsistencyMonitor, ATiltThatNoVehicleMakesMayBeWrongByARatio) {
  const auto tilted = [](double tilt_deg) {
    return afterOdd(1, [=](Sweep& sweep) { sweep.turn_rad = sweep.tilt_rad = tilt_deg * kDegree; });
  };
  expectNone(tilted(3.4), "a speed bump");
  EXPECT_NEAR(tilted(4.0).doubt.sigma_yaw_rad, 0.4 * kDegree, 1e-12);
  EXPECT_TRUE(tilted(4.0).unbelievable);
}

TEST(ConsistencyMonitor, AJumpThatOverrulesThePredictionMayBeWrong) {
  const auto jumped = [](bool overruled) {
    return afterOdd(1, [=](Sweep& sweep) {
      sweep.innovation_m = 0.4;
      sweep.time_sigma_m = 0.05;
      sweep.overruled = overruled;
    });
  };
  expectNone(jumped(false), "inside the gate the prediction is as uncertain");
  EXPECT_NEAR(jumped(true).doubt.sigma_m, 0.3, 1e-12);
  EXPECT_TRUE(jumped(true).unbelievable);
}

TEST(ConsistencyMonitor, AShortJumpThatFitsIsTheVehicles) {
  const auto jumped = [](double jump_m, double rms_m, double fit) {
    ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
    Sweep sweep = sound();
    sweep.rms_residual_m = 0.02;
    for (int i = 0; i < 6; ++i) monitor.add(sweep);
    sweep.overruled = true;
    sweep.innovation_m = jump_m;
    sweep.rms_residual_m = rms_m;
    sweep.inlier_ratio = fit * *sweep.inlier_ratio;
    return monitor.add(sweep);
  };
  expectNone(jumped(0.15, 0.02, 1.0), "as close as before");
  EXPECT_DOUBLE_EQ(jumped(0.15, 0.03, 1.0).doubt.sigma_m, 0.15) << "less close";
  EXPECT_DOUBLE_EQ(jumped(0.15, 0.02, 0.8).doubt.sigma_m, 0.15) << "fewer points";
  EXPECT_DOUBLE_EQ(jumped(0.4, 0.02, 1.0).doubt.sigma_m, 0.4) << "far enough to be the next tree";
}

TEST(ConsistencyMonitor, AJumpAheadByWholeSweepsIsOfLostSweeps) {
  const auto jumped = [](double ahead_m, double aside_m, double rms_m = 0.02, bool overruled = true) {
    ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
    Sweep sweep = sound();
    sweep.rms_residual_m = 0.02;
    sweep.per_period_m = 1.3;
    for (int i = 0; i < 6; ++i) monitor.add(sweep);
    sweep.overruled = overruled;
    sweep.ahead_m = ahead_m;
    sweep.innovation_m = std::hypot(ahead_m, aside_m);
    sweep.rms_residual_m = rms_m;
    return monitor.add(sweep);
  };
  for (const double ahead_m : {1.3, 1.25, 2.65}) {
    EXPECT_TRUE(jumped(ahead_m, 0.05).sweeps_lost) << ahead_m;
    EXPECT_EQ(jumped(ahead_m, 0.05).doubt.sigma_m, 0.0) << ahead_m;
  }
  const auto isDoubted = [](const Inflation& inflation) {
    return !inflation.sweeps_lost && inflation.doubt.sigma_m > 1.0;
  };
  EXPECT_TRUE(isDoubted(jumped(-1.3, 0.0))) << "back: repeated points";
  EXPECT_TRUE(isDoubted(jumped(1.9, 0.0))) << "one and a half";
  EXPECT_TRUE(isDoubted(jumped(1.3, 0.3))) << "aside";
  EXPECT_TRUE(isDoubted(jumped(1.3, 0.0, 0.03))) << "the map does not confirm it";
  EXPECT_FALSE(jumped(1.3, 0.0, 0.02, false).sweeps_lost) << "within the gate";
}

Sweep oddInAll() { return {0.1, 0.25, 0.12, 10.0 * kDegree, 0.0}; }

TEST(ConsistencyMonitor, ErrorsAddAsIndependent) {
  const Inflation inflation = afterOdd(10, [](Sweep& sweep) { sweep = oddInAll(); });
  EXPECT_NEAR(inflation.doubt.sigma_m, std::hypot(0.10, 0.25), 1e-12) << "the larger one of innovation and unfitting";
}

TEST(ConsistencyMonitor, EachSignCanBeSwitchedOff) {
  ConsistencyMonitor::Params params;
  params.persistent_innovation_m = params.fitting_ratio = params.max_yaw_innovation_deg = 0.0;
  const Inflation inflation = afterOdd(
      10, [](Sweep& sweep) { sweep = oddInAll(); }, params);
  EXPECT_DOUBLE_EQ(inflation.doubt.sigma_m, 0.10) << "what measurements stay apart";
  EXPECT_EQ(inflation.doubt.sigma_yaw_rad, 0.0);
  EXPECT_FALSE(inflation.unbelievable || inflation.velocity_unobservable);
}

TEST(ConsistencyMonitor, WhatTellsNoMotionIsSaidWhateverItAdds) {
  ConsistencyMonitor::Params params;
  params.unfitting_sigma_m = 0.0;
  const auto unfitting = [](Sweep& sweep) { sweep.inlier_ratio = 0.1; };
  EXPECT_TRUE(afterOdd(5, unfitting, params).velocity_unobservable);
  ConsistencyMonitor monitor(params);
  Sweep sweep = sound();
  unfitting(sweep);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(monitor.add(sweep).velocity_unobservable) << "nothing has fitted yet";
}

TEST(ConsistencyMonitor, MisfitAfterDeadReckoningLosesTheMotion) {
  ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
  ConsistencyMonitor::Sweep sweep;
  sweep.dt_s = 0.1;
  sweep.inlier_ratio = 0.9;
  sweep.dead_reckoned = true;
  for (int i = 0; i < 15; ++i) EXPECT_FALSE(monitor.add(sweep).motion_lost) << i;
  sweep.dead_reckoned = false;
  sweep.inlier_ratio = 0.45;
  bool lost = false;
  for (int i = 0; i < 10; ++i) lost = monitor.add(sweep).motion_lost || lost;
  EXPECT_TRUE(lost);
}

TEST(ConsistencyMonitor, ClearedItBeginsAnew) {
  ConsistencyMonitor monitor{ConsistencyMonitor::Params()};
  Sweep odd = oddInAll();
  odd.turn_rad = 0.0;
  for (int i = 0; i < 5; ++i) monitor.add(sound());
  for (int i = 0; i < 10; ++i) monitor.add(odd);
  EXPECT_GT(monitor.add(odd).doubt.sigma_m, 0.25);
  monitor.clear();
  for (int i = 0; i < 4; ++i) expectNone(monitor.add(odd), "nothing lasts yet");
  EXPECT_GE(monitor.add(odd).doubt.sigma_m, 0.25) << "three of the sweeps after the first two";
}

TEST(ConsistencyMonitor, ParametersAreChecked) {
  const auto refused = [](const std::function<void(ConsistencyMonitor::Params&)>& change) {
    ConsistencyMonitor::Params params;
    change(params);
    return errorOf([&] { validate(params); });
  };
  EXPECT_EQ(refused([](ConsistencyMonitor::Params&) {}), "no error");
  EXPECT_NE(refused([](auto& p) { p.persistent_disagreement_m = 0.0; }).find("persistent_disagreement_m = 0"),
            std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.persistent_innovation_m = -1.0; }).find("persistent_innovation_m"),
            std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.fitting_ratio = 1.1; }).find("fitting_ratio"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.max_yaw_innovation_deg = std::nan(""); }).find("max_yaw_innovation_deg"),
            std::string::npos);
}

}  // namespace
}  // namespace fail_aware::consistency_monitor_test
