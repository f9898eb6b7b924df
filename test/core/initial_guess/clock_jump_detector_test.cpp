#include "core/initial_guess/clock_jump_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace fail_aware::clock_jump_detector_test {
namespace {

constexpr double kSpeed_mps = 10.0, kPeriod_s = 0.1;

Pose at(double x_m) {
  Pose T = Pose::Identity();
  T.translation().x() = x_m;
  return T;
}

// A world in which everything stands at its place once: within reach_m of the car's place a sweep fits there, and
// elsewhere its road does.
struct World {
  double ratio_elsewhere = 0.75, ratio_here = 0.95;
  double information_elsewhere = 0.015, information_here = 0.1;
  double reach_m = 0.2;
  int degenerate_directions = 0;
  int fits = 0;

  ClockJumpDetector::Fit at(double car_x_m) {
    return [this, car_x_m](const Pose& T) {
      ++fits;
      Measurement found;
      const bool here = std::abs(T.translation().x() - car_x_m) < reach_m;
      found.T_odom_cog = here ? clock_jump_detector_test::at(car_x_m) : T;
      found.inlier_ratio = here ? ratio_here : ratio_elsewhere;
      found.status = found.inlier_ratio > 0.0 ? MeasurementStatus::kOk : MeasurementStatus::kNotConverged;
      found.min_information_ratio = here ? information_here : information_elsewhere;
      found.degenerate_directions = degenerate_directions;
      return found;
    };
  }
};

struct Car {
  ClockJumpDetector check;
  World world;
  double x_m = 0.0;

  /// From here on, by the stamps.
  ClockJumpDetector::Interval interval(double dt_s, double set_back_s = 0.0) const {
    ClockJumpDetector::Interval interval;
    interval.stamps = {dt_s, set_back_s};
    interval.T_odom_cog_placed = at(x_m);
    interval.twist_cog << kSpeed_mps, 0.0, 0.0, 0.0, 0.0, 0.0;
    interval.T_odom_cog_predicted = at(x_m + kSpeed_mps * dt_s);
    interval.T_odom_cog_by_the_stamps = interval.T_odom_cog_predicted;
    return interval;
  }
  /// Drives on for driven_s while the stamps say dt_s.
  std::optional<Pose> drive(double driven_s, double dt_s, double set_back_s = 0.0, bool found_there = true) {
    ClockJumpDetector::Interval interval = this->interval(dt_s, set_back_s);
    if (!found_there) interval.T_odom_cog_by_the_stamps.reset();
    x_m += kSpeed_mps * driven_s;
    return check.findOther(interval, world.at(x_m));
  }
  Car() {
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(drive(kPeriod_s, kPeriod_s));
  }
  void expectHere(const std::optional<Pose>& T) const {
    ASSERT_TRUE(T);
    EXPECT_NEAR(T->translation().x(), x_m, 1e-9);
  }
};

TEST(ClockJumpDetector, ClockSetAheadAndBackKeepsThePose) {
  Car car;
  car.expectHere(car.drive(kPeriod_s, 0.5));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(car.drive(kPeriod_s, kPeriod_s));
  // back by 0.4 s: the stamps 0.3, 0.2, 0.1 and 0 s before the last one are refused
  car.expectHere(car.drive(0.5, kPeriod_s, 0.3));
  EXPECT_FALSE(car.drive(kPeriod_s, kPeriod_s));
}

TEST(ClockJumpDetector, AClockThatIsSetBackByLessThanAnInterval) {
  Car car;
  car.expectHere(car.drive(kPeriod_s, 0.03));
}

TEST(ClockJumpDetector, ClockSetWhileSweepsAreLostKeepsThePose) {
  // 0.5 s back; 1 s ahead
  for (const auto& [driven_s, dt_s] : {std::pair(0.8, 0.3), std::pair(0.6, 1.6)}) {
    Car car;
    car.world.reach_m = 0.5;
    car.expectHere(car.drive(driven_s, dt_s));
    EXPECT_FALSE(car.drive(kPeriod_s, kPeriod_s));
  }
  Car far;
  far.world.reach_m = 0.5;
  EXPECT_FALSE(far.drive(2.5, 0.3)) << "22 m";
  Car usual;
  usual.world.reach_m = 0.5;
  usual.world.ratio_elsewhere = 0.9;
  EXPECT_FALSE(usual.drive(0.8, 0.3)) << "as much fits as ever";
  Car slow;
  ClockJumpDetector::Interval interval = slow.interval(0.3);
  interval.twist_cog *= 0.1;
  slow.world.fits = 0;
  EXPECT_FALSE(slow.check.findOther(interval, slow.world.at(1e3)));
  EXPECT_LE(slow.world.fits, 2) << "registration reaches as far";
}

TEST(ClockJumpDetector, SweepsThatAreLostAreLost) {
  Car car;
  for (const double lost_s : {0.2, 0.5, 2.0}) EXPECT_FALSE(car.drive(lost_s, lost_s));
  EXPECT_FALSE(car.drive(2.0, 2.0, 0.0, false)) << "nor where no place was found";
  EXPECT_FALSE(car.drive(2.0 * kPeriod_s, 2.0 * kPeriod_s, kPeriod_s)) << "nor if one came late";
}

TEST(ClockJumpDetector, UnknownPlaceNeedsAUsualFit) {
  Car car;
  car.expectHere(car.drive(kPeriod_s, 0.5, 0.0, false));
  car.world.ratio_here = 0.65;
  EXPECT_FALSE(car.drive(kPeriod_s, 0.5, 0.0, false)) << "too little fits";
  car.world.information_here = 0.5;
  EXPECT_FALSE(car.drive(kPeriod_s, 0.5, 0.0, false)) << "however much it informs";
  car.world.ratio_here = 0.95;
  car.world.information_here = 0.03;
  EXPECT_FALSE(car.drive(kPeriod_s, 0.5, 0.0, false)) << "what fits is the road";
}

TEST(ClockJumpDetector, UnobservedDistanceTrustsStamps) {
  Car alike;
  World& world = alike.world;
  world.information_elsewhere = world.information_here * world.ratio_here / (1.4 * world.ratio_elsewhere);
  EXPECT_FALSE(alike.drive(kPeriod_s, 0.5));
  Car weak;
  weak.world.degenerate_directions = 1;
  EXPECT_FALSE(weak.drive(kPeriod_s, 0.5));
}

TEST(ClockJumpDetector, NoFitAtStampsNeedsLess) {
  Car car;
  car.world.ratio_here = 0.75;
  car.world.ratio_elsewhere = 0.0;
  car.expectHere(car.drive(kPeriod_s, 0.5));
  car.world.information_here = 0.06;
  EXPECT_FALSE(car.drive(kPeriod_s, 0.5)) << "what fits is the road";
}

// Of a car that was not placed for some intervals.
struct Gap {
  Car car;
  std::vector<ClockJumpDetector::Stamps> unplaced;
  bool found_by_the_stamps = false;

  std::optional<Pose> after(double driven_s, double dt_s = kPeriod_s) {
    ClockJumpDetector::Interval interval = car.interval(dt_s);
    double by_the_stamps_s = dt_s;
    for (const ClockJumpDetector::Stamps& stamps : unplaced) by_the_stamps_s += stamps.dt_s;
    interval.unplaced = unplaced;
    interval.T_odom_cog_predicted = at(car.x_m + kSpeed_mps * by_the_stamps_s);
    interval.T_odom_cog_by_the_stamps.reset();
    if (found_by_the_stamps) interval.T_odom_cog_by_the_stamps = interval.T_odom_cog_predicted;
    car.x_m += kSpeed_mps * driven_s;
    return car.check.findOther(interval, car.world.at(car.x_m));
  }
};

TEST(ClockJumpDetector, UnmeasuredSweepAsksTheNext) {
  for (const bool found_by_the_stamps : {false, true}) {
    for (const double dt_s : {5.1, 0.5, 0.02}) {
      Gap one{{}, {{dt_s}}, found_by_the_stamps};
      one.car.expectHere(one.after(2.0 * kPeriod_s));
      Gap three{{}, {{kPeriod_s}, {dt_s}, {kPeriod_s}}, found_by_the_stamps};
      three.car.expectHere(three.after(4.0 * kPeriod_s));
      Gap lost{{}, {{dt_s}}, found_by_the_stamps};
      EXPECT_FALSE(lost.after(dt_s + kPeriod_s)) << "sweeps were lost: " << dt_s;
    }
  }
  Gap set_back{{}, {{kPeriod_s, 0.3}}};
  set_back.car.expectHere(set_back.after(0.6));
  Gap usual{{}, {{kPeriod_s}, {kPeriod_s}}};
  usual.car.drive(kPeriod_s, kPeriod_s);  // the tenth
  usual.car.world.fits = 0;
  EXPECT_FALSE(usual.after(5.0 * kPeriod_s));
  EXPECT_EQ(usual.car.world.fits, 0) << "nothing is unusual";
}

TEST(ClockJumpDetector, LostSweepNearAJumpIsLost) {
  Gap gap{{}, {{5.1}}};
  gap.car.expectHere(gap.after(0.3, 0.2));
  Gap a_little{{}, {{0.02}}};
  a_little.car.expectHere(a_little.after(0.3, 0.2));
}

TEST(ClockJumpDetector, WhatWasNotPlacedIsLearntFromToo) {
  Gap gap{{}, {{kPeriod_s}}, true};
  gap.car.check.reset();
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(gap.after(2.0 * kPeriod_s));  // every second sweep is skipped
  gap.unplaced = {{5.1}};
  gap.car.expectHere(gap.after(2.0 * kPeriod_s));
}

TEST(ClockJumpDetector, WhereNothingIsUsualNothingIsDoubted) {
  Car car;
  car.check.reset();
  car.world.degenerate_directions = 1;  // a tunnel
  for (int i = 0; i < 20; ++i) car.drive(kPeriod_s, kPeriod_s);
  car.world.degenerate_directions = 0;
  EXPECT_FALSE(car.drive(kPeriod_s, 0.5, 0.0, false));
}

TEST(ClockJumpDetector, NearerStartWinsForOnePlace) {
  Car car;
  ClockJumpDetector::Interval interval = car.interval(0.2);
  // a search found the place, or registration alone
  for (const double found_m : {1.0, 2.0}) {
    interval.T_odom_cog_by_the_stamps = at(car.x_m + found_m);
    for (const double driven_m : {1.0, 2.0}) {
      const auto everywhere = [&](const Pose& T) {
        Measurement found = car.world.at(T.translation().x())(T);
        found.T_odom_cog = at(car.x_m + driven_m);
        return found;
      };
      EXPECT_EQ(car.check.findOther(interval, everywhere).has_value(), driven_m == 1.0) << found_m;
    }
  }
}

TEST(ClockJumpDetector, TheDriverMayHaveBrakedInALongInterval) {
  for (const double braked_mps2 : {2.5, 10.0}) {
    Car car;
    car.world.ratio_elsewhere = 0.9;  // much fits there, too
    const ClockJumpDetector::Interval interval = car.interval(kPeriod_s, 0.4);
    const double x_m = car.x_m + kSpeed_mps * 0.6 - 0.5 * braked_mps2 * 0.36;
    const auto fit = [&](const Pose& T) {
      Measurement found = car.world.at(T.translation().x() > car.x_m + 4.0 ? T.translation().x() : 1e3)(T);
      if (found.min_information_ratio == car.world.information_here) found.T_odom_cog = at(x_m);
      return found;
    };
    EXPECT_EQ(car.check.findOther(interval, fit).has_value(), braked_mps2 < 5.0) << braked_mps2;
  }
}

TEST(ClockJumpDetector, OneOddIntervalKeepsTheUsual) {
  Car car;
  car.world.degenerate_directions = 1;
  EXPECT_FALSE(car.drive(kPeriod_s, 0.04));
  EXPECT_FALSE(car.drive(kPeriod_s, 0.4));
  car.world.degenerate_directions = 0;
  car.expectHere(car.drive(kPeriod_s, 0.5));
}

TEST(ClockJumpDetector, NewRateBecomesUsual) {
  for (const double period_s : {0.05, 0.2}) {
    Car car;
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(car.drive(period_s, period_s));
    car.world.fits = 0;
    for (int i = 0; i < 60; ++i) EXPECT_FALSE(car.drive(period_s, period_s));
    EXPECT_EQ(car.world.fits, 6) << period_s;
    car.expectHere(car.drive(period_s, 0.5));
  }
}

TEST(ClockJumpDetector, APlaceThatRegistrationLeavesIsNone) {
  Car car;
  const ClockJumpDetector::Interval interval = car.interval(0.5);
  double moved_m = 0.0;
  const auto fit = [&](const Pose& T) {
    Measurement found = car.world.at(car.x_m + 1.0)(T);
    if (found.min_information_ratio == car.world.information_here) found.T_odom_cog = at(T.translation().x() + moved_m);
    return found;
  };
  moved_m = 0.4;
  EXPECT_FALSE(car.check.findOther(interval, fit));
  moved_m = 0.2;
  EXPECT_TRUE(car.check.findOther(interval, fit));
}

TEST(ClockJumpDetector, BeforeTheFirstUsualIntervalNothingIsKnown) {
  World world;
  ClockJumpDetector check;
  ClockJumpDetector::Interval interval;
  EXPECT_FALSE(check.findOther(interval, world.at(0.0))) << "the first sweep";
  interval.stamps.dt_s = 0.5;
  interval.T_odom_cog_by_the_stamps = at(5.0);
  EXPECT_FALSE(check.findOther(interval, world.at(1.0)));
  Car car;
  car.check.reset();
  EXPECT_FALSE(car.drive(kPeriod_s, 0.5)) << "after a reset, too";
}

TEST(ClockJumpDetector, RegistersEveryTenthSweepOnly) {
  Car car;
  car.world.fits = 0;
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(car.drive(kPeriod_s, kPeriod_s));
  EXPECT_EQ(car.world.fits, 6);
}

}  // namespace
}  // namespace fail_aware::clock_jump_detector_test
