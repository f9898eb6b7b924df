#include "core/estimation/odometry_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "../../support/independent_drift.hpp"
#include "../../support/poses.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware::odometry_covariance_test {
namespace {

Pose planarPose(double x, double y, double yaw) {
  Vector6d v;
  v << x, y, 0, 0, 0, yaw;
  return poseFromVector(v);
}

Matrix6d incrementCovariance() {
  Vector6d variances;
  variances << 4e-4, 1e-4, 2e-4, 1e-6, 1e-6, 4e-6;
  Matrix6d C = variances.asDiagonal();
  C(1, 5) = C(5, 1) = 1e-5;
  return C;
}

double smallestEigenvalue(const Matrix6d& C) { return symmetricEigenvalues(C)[0]; }

// The pose's right error (dt, dr) in geometry/pose.hpp's convention between a true pose and an estimate.
Vector6d poseError(const Pose& T_true, const Pose& T_estimate) {
  Vector6d e;
  e.head<3>() = T_true.translation() - T_estimate.translation();
  e.tail<3>() = logSo3(T_true.linear() * T_estimate.linear().transpose());
  return e;
}

// With the drift since a mark, as the monitor has it.
class MarkedOdometry : public OdometryCovariance {
 public:
  using OdometryCovariance::OdometryCovariance;
  void mark(const Pose& T_odom_mark) { since_mark_ = OdometryCovariance::mark(T_odom_mark); }
  bool propagate(const Pose& T_previous, const Pose& T_now, const OdometryIncrement& increment) {
    if (!OdometryCovariance::propagate(T_previous, T_now, increment)) return false;
    since_mark_.add(lastStep());
    return true;
  }
  const Matrix6d& sinceMark() const { return since_mark_.covariance(); }
  const DriftState& driftSinceMark() const { return since_mark_.state(); }

 private:
  DriftSinceMark since_mark_;
};

TEST(OdometryCovariance, StraightDriveInClosedForm) {
  MarkedOdometry odometry(independentDrift());
  const int n = 500;
  const double step = 1.0;
  const Pose increment = planarPose(step, 0, 0);
  Pose T = planarPose(100.0, -50.0, 0.0);
  for (int i = 0; i < n; ++i) {
    const Pose next = T * increment;
    ASSERT_TRUE(odometry.propagate(T, next, incrementWith(incrementCovariance())));
    T = next;
  }
  // The heading error of increment k acts over the n - k steps that follow it.
  const Matrix6d q = incrementCovariance();
  const double s1 = step * n * (n - 1) / 2.0;
  const double s2 = step * step * (n - 1.0) * n * (2.0 * n - 1.0) / 6.0;
  const Matrix6d& C = odometry.covariance();
  EXPECT_NEAR(C(0, 0), n * q(0, 0), 1e-9);
  EXPECT_NEAR(C(5, 5), n * q(5, 5), 1e-12);
  EXPECT_NEAR(C(1, 1), n * q(1, 1) + 2.0 * s1 * q(1, 5) + s2 * q(5, 5), 1e-6);
  EXPECT_NEAR(C(1, 5), n * q(1, 5) + s1 * q(5, 5), 1e-9);
}

TEST(OdometryCovariance, HeadingErrorBecomesLateral) {
  MarkedOdometry odometry(independentDrift());
  Matrix6d start = Matrix6d::Zero();
  start(5, 5) = 1e-6;
  odometry.reset(start);
  Pose T = planarPose(0, 0, 0.7);
  for (int i = 0; i < 100; ++i) {
    const Pose next = T * planarPose(1, 0, 0);
    odometry.propagate(T, next, incrementWith(Matrix6d::Zero()));
    T = next;
  }
  const Matrix6d C = rotateCovariance(odometry.covariance(), rotationFromRpy(0, 0, 0.7).transpose());
  EXPECT_NEAR(C(1, 1), 100.0 * 100.0 * 1e-6, 1e-10);  // s^2 sigma_yaw^2
  EXPECT_NEAR(C(0, 0), 0.0, 1e-12);
}

TEST(OdometryCovariance, CurveAgainstMonteCarlo) {
  const int steps = 60;
  const int runs = 4000;
  const Pose increment = [] {
    Vector6d twist;
    twist << 1.0, 0, 0.02, 0.001, -0.002, 0.04;
    return expSe3(twist);
  }();
  const Pose start = planarPose(5, 3, -2.0);
  const Matrix6d q = incrementCovariance();
  const Matrix6d half = q.llt().matrixL();

  MarkedOdometry odometry(independentDrift());
  Pose T = start;
  for (int i = 0; i < steps; ++i) {
    odometry.propagate(T, T * increment, incrementWith(q));
    T = T * increment;
  }
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Matrix6d sampled = Matrix6d::Zero();
  for (int run = 0; run < runs; ++run) {
    Pose T_true = start;
    for (int i = 0; i < steps; ++i) {
      const Vector6d error = half * Vector6d::NullaryExpr([&]() { return normal(random); });
      T_true = T_true * perturbed(increment, error);
    }
    const Vector6d error = poseError(T_true, T);
    sampled += error * error.transpose() / runs;
  }
  const Vector6d scale = odometry.covariance().diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d difference = scale.asDiagonal() * (sampled - odometry.covariance()) * scale.asDiagonal();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 0.1);  // 2.2 % is the sampling's standard deviation
}

TEST(OdometryCovariance, SinceMarkForgetsTheTimeBefore) {
  const Pose far = planarPose(400, -900, 2.5);
  MarkedOdometry a(independentDrift()), b(independentDrift());
  Matrix6d start = 0.5 * Matrix6d::Identity();
  a.reset(start);
  Pose T = far * planarPose(-10, 2, 0.3);
  a.propagate(T, far, incrementWith(incrementCovariance()));
  a.mark(far);
  EXPECT_TRUE(a.sinceMark().isZero());
  Pose T_a = far, T_b = Pose::Identity();
  for (int i = 0; i < 100; ++i) {
    const Pose increment = planarPose(1.0, 0.0, 0.02 * std::sin(0.1 * i));
    a.propagate(T_a, T_a * increment, incrementWith(incrementCovariance()));
    b.propagate(T_b, T_b * increment, incrementWith(incrementCovariance()));
    T_a = T_a * increment;
    T_b = T_b * increment;
  }
  EXPECT_TRUE(a.sinceMark().isApprox(b.covariance(), 1e-9));
  EXPECT_GT(a.covariance()(0, 0), 0.5);
  a.reset();
  EXPECT_TRUE(a.covariance().isZero());
}

TEST(OdometryCovariance, StaysACovarianceAndGrowsAboutAFixedPoint) {
  MarkedOdometry odometry(independentDrift());
  Pose T = Pose::Identity();
  const auto aboutOrigin = [&]() {  // of the point of the body that is at odom's origin
    return covarianceAfterOffset(odometry.covariance(), T, T.inverse());
  };
  Matrix6d before = Matrix6d::Zero();
  for (int i = 0; i < 3000; ++i) {
    Vector6d twist;
    twist << 1.5, 0.01, 0.02 * std::sin(0.01 * i), 0.001, 0.002 * std::cos(0.05 * i), 0.05 * std::sin(0.004 * i);
    const Pose next = orthonormalized(T * expSe3(twist));
    ASSERT_TRUE(odometry.propagate(T, next, incrementWith(incrementCovariance())));
    T = next;
    const Matrix6d& C = odometry.covariance();
    ASSERT_TRUE(C == C.transpose());
    if (i % 100 != 0) continue;
    const Vector6d scale = C.diagonal().cwiseSqrt().cwiseInverse();
    ASSERT_GT(smallestEigenvalue(scale.asDiagonal() * C * scale.asDiagonal()), 0.0);
    const Matrix6d now = aboutOrigin();
    ASSERT_GT(smallestEigenvalue(now - before), -1e-9 * now.trace());
    before = now;
  }
}

TEST(OdometryCovariance, DrivingBackUndoesTheStartsHeadingError) {
  MarkedOdometry odometry(independentDrift());
  Matrix6d start = Matrix6d::Zero();
  start(5, 5) = 1e-4;
  odometry.reset(start);
  const Pose there = planarPose(100, 0, 0);
  odometry.propagate(Pose::Identity(), there, incrementWith(Matrix6d::Zero()));
  EXPECT_NEAR(odometry.covariance()(1, 1), 1.0, 1e-12);
  odometry.propagate(there, Pose::Identity(), incrementWith(Matrix6d::Zero()));
  EXPECT_TRUE(odometry.covariance().isApprox(start, 1e-12));
}

TEST(OdometryCovariance, UnusableIncrementsChangeNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MarkedOdometry odometry(independentDrift());
  odometry.mark(Pose::Identity());
  ASSERT_TRUE(odometry.propagate(Pose::Identity(), planarPose(1, 0, 0), incrementWith(incrementCovariance())));
  const Matrix6d before = odometry.covariance();
  Matrix6d bad = incrementCovariance();
  bad(2, 2) = nan;
  EXPECT_FALSE(odometry.propagate(Pose::Identity(), planarPose(1, 0, 0), incrementWith(bad)));
  EXPECT_FALSE(odometry.propagate(Pose::Identity(), planarPose(nan, 0, 0), incrementWith(incrementCovariance())));
  EXPECT_FALSE(odometry.propagate(Pose::Identity(), planarPose(1e200, 0, 0), incrementWith(incrementCovariance())));
  EXPECT_TRUE(odometry.covariance() == before && odometry.sinceMark() == before);
  // A negative eigenvalue must not make the sum shrink.
  EXPECT_TRUE(odometry.propagate(planarPose(1, 0, 0), planarPose(1, 0, 0), incrementWith(-incrementCovariance())));
  EXPECT_TRUE(odometry.covariance().isApprox(before, 1e-12));
}

// Straight on along odom's x, 1 m and 0.1 s a step. The speed, where it is not observed, wanders by `wander` (m^2/s^3).
DriftState driveStraight(MarkedOdometry& odometry, int steps, const Matrix6d& motion,
                         const std::optional<Matrix6d>& registration, Pose T = Pose::Identity(), double wander = 0.0) {
  for (int i = 0; i < steps; ++i) {
    const Pose next = T * planarPose(1.0, 0.0, 0.0);
    OdometryIncrement increment;
    increment.motion = motion;
    increment.registration = registration;
    increment.confirmed = registration.has_value();
    increment.dt_s = 0.1;
    if (wander > 0.0) increment.speed_error = {odometry.speedVariance() + 0.1 * wander, 1.0};
    EXPECT_TRUE(odometry.propagate(T, next, increment));
    T = next;
  }
  return odometry.driftSinceMark();
}

TEST(OdometryCovariance, BiasesGrowWithDistanceAndItsSquare) {
  DriftModel drift = independentDrift();
  drift.heading_bias_deg_per_m = 0.01;
  drift.scale_bias = 0.02;
  MarkedOdometry odometry(drift);
  odometry.mark(Pose::Identity());
  driveStraight(odometry, 100, Matrix6d::Zero(), {});
  const Matrix6d& C = odometry.sinceMark();
  const double bias = 0.01 * kDegree;
  EXPECT_NEAR(std::sqrt(C(0, 0)), 0.02 * 100.0, 1e-9);
  EXPECT_NEAR(std::sqrt(C(5, 5)), bias * 100.0, 1e-12);
  EXPECT_NEAR(std::sqrt(C(1, 1)), bias * 100.0 * 99.0 / 2.0, 1e-9) << "sum of the headings at the steps' begins";
  EXPECT_TRUE(odometry.covariance().isApprox(C, 1e-9));
}

TEST(OdometryCovariance, ObservedJitterDoesNotAddUp) {
  DriftModel drift = independentDrift();
  drift.map_length_m = 1e9;
  drift.transient_ratio = drift.transient_rotation_ratio = 0.5;
  MarkedOdometry odometry(drift);
  Matrix6d R = Matrix6d::Identity();
  R(0, 0) = R(1, 1) = 2e-4;
  R(5, 5) = 2e-6;
  const Matrix6d motion = Matrix6d::Identity();
  driveStraight(odometry, 20, motion, R);
  odometry.mark(planarPose(20.0, 0.0, 0.0));
  EXPECT_TRUE(odometry.sinceMark().isZero()) << "the mark is where the mark is";
  driveStraight(odometry, 50, motion, R, planarPose(20.0, 0.0, 0.0));
  // jitter of the mark and of the pose, 1e-4 each; the mark's heading jitter of 1e-6 over 50 m
  EXPECT_NEAR(odometry.sinceMark()(0, 0), 2e-4, 1e-6);
  EXPECT_NEAR(odometry.sinceMark()(1, 1), 2e-4 + 2500.0 * 1e-6, 1e-5);
  EXPECT_NEAR(odometry.covariance()(0, 0), 1e-4, 1e-6) << "since the start, which is known exactly";
}

TEST(OdometryCovariance, AChangingMotionMakesThePoseJitter) {
  const auto jitterAfter = [](double step_m, double turn_rad) {
    MarkedOdometry odometry(independentDrift());
    driveStraight(odometry, 20, Matrix6d::Identity(), 1e-12 * Matrix6d::Identity());
    odometry.mark(planarPose(20.0, 0.0, 0.0));
    OdometryIncrement increment;
    increment.motion = Matrix6d::Identity();
    increment.registration = 1e-12 * Matrix6d::Identity();
    increment.confirmed = true;
    increment.dt_s = 0.1;
    odometry.propagate(planarPose(20.0, 0.0, 0.0), planarPose(20.0 + step_m, 0.0, turn_rad), increment);
    const Vector6d sigmas = odometry.sinceMark().diagonal().cwiseSqrt();
    return Eigen::Vector2d(sigmas[0], sigmas[5]);
  };
  EXPECT_LT(jitterAfter(1.0, 0.0).norm(), 1e-5) << "as before";
  EXPECT_NEAR(jitterAfter(1.1, 0.0)[0], 0.01, 1e-5) << "a tenth of the change";
  EXPECT_NEAR(jitterAfter(1.0, 0.01)[1], 0.06 * 0.01, 1e-5);
  EXPECT_LT(jitterAfter(1.5, 0.1).norm(), 1e-5) << "a corrected prediction is no motion";
}

TEST(OdometryCovariance, SubsidingJitterDoesNotShrinkIt) {
  DriftModel drift = independentDrift();
  drift.map_length_m = 1e9;
  drift.transient_ratio = drift.transient_rotation_ratio = 0.5;
  MarkedOdometry covariance(drift);
  const Pose step = poseFromVector((Vector6d() << 1.0, 0.0, 0.0, 0.0, 0.0, 0.1).finished());
  Pose T = Pose::Identity();
  covariance.mark(T);
  double yaw = 0.0, position = 0.0;
  for (const double share : {1.0, 0.1, 0.5, 0.01}) {
    OdometryIncrement increment;
    increment.motion = Matrix6d::Identity();
    increment.registration = share * incrementCovariance();
    increment.confirmed = true;
    ASSERT_TRUE(covariance.propagate(T, T * step, increment));
    T = T * step;
    EXPECT_GE(covariance.covariance()(5, 5), yaw * (1.0 - 1e-3));
    EXPECT_GE(covariance.covariance().diagonal().head(3).sum(), position * (1.0 - 1e-3));
    yaw = covariance.covariance()(5, 5);
    position = covariance.covariance().diagonal().head(3).sum();
  }
  EXPECT_LT(covariance.sinceMark()(5, 5), 0.1 * yaw) << "the newest jitter alone";
}

TEST(OdometryCovariance, UnobservedSpeedErrorIsForgotten) {
  MarkedOdometry odometry(independentDrift());
  odometry.mark(Pose::Identity());
  Matrix6d C = Matrix6d::Zero();
  C(0, 0) = 1e-6;
  const DriftState lost = driveStraight(odometry, 100, C, {}, Pose::Identity(), 4.0);
  // 10 s: speed 2 sqrt(t), position 2 sqrt(t^3 / 3), and 100 independent steps of 1 mm
  EXPECT_NEAR(lost.C(DriftState::kSpeed, DriftState::kSpeed), 40.0, 1e-6);
  EXPECT_NEAR(std::sqrt(odometry.sinceMark()(0, 0)), 2.0 * std::sqrt(1000.0 / 3.0), 0.6);
  EXPECT_NEAR(odometry.sinceMark()(1, 1), 0.0, 1e-12);
  const double position = odometry.sinceMark()(0, 0);
  const DriftState seen = driveStraight(odometry, 1, C, 1e-8 * Matrix6d::Identity(), planarPose(100.0, 0.0, 0.0));
  EXPECT_EQ(seen.C(DriftState::kSpeed, DriftState::kSpeed), 0.0);
  EXPECT_NEAR(odometry.sinceMark()(0, 0), position, 1e-6) << "what was lost stays lost";

  driveStraight(odometry, 30, C, {}, planarPose(101.0, 0.0, 0.0), 4.0);
  odometry.mark(planarPose(131.0, 0.0, 0.0));
  EXPECT_NEAR(odometry.driftSinceMark().C(DriftState::kSpeed, DriftState::kSpeed), 12.0, 1e-6)
      << "a mark in the tunnel does not know the speed either";
}

// 1 m a sweep along x; of a gap's sweeps nothing is measured.
class Gap : public ::testing::Test {
 protected:
  void SetUp() override {
    odometry.mark(Pose::Identity());
    drive(10, measured());
    before = odometry.sinceMark()(0, 0);
  }
  static OdometryIncrement measured() {
    OdometryIncrement increment;
    increment.motion = increment.registration.emplace(1e-6 * Matrix6d::Identity());
    increment.dt_s = 0.1;
    return increment;
  }
  static OdometryIncrement predicted() {
    OdometryIncrement increment;
    increment.motion.diagonal() << 1e-2, 1e-2, 1e-2, 1e-4, 1e-4, 1e-4;
    increment.dt_s = 0.1;
    increment.map_update = MapUpdate::kSkip;
    return increment;
  }
  static OdometryIncrement confirmed(const Vector6d& sigmas) {
    OdometryIncrement increment = measured();
    increment.registration = Matrix6d(sigmas.cwiseAbs2().asDiagonal());
    increment.confirmed = true;
    return increment;
  }
  void drive(int sweeps, const OdometryIncrement& increment) {
    for (int i = 0; i < sweeps; ++i) {
      const Pose next = T * planarPose(1.0, 0.0, 0.0);
      ASSERT_TRUE(odometry.propagate(T, next, increment));
      T = next;
    }
  }
  double x() const { return odometry.sinceMark()(0, 0); }
  double y() const { return odometry.sinceMark()(1, 1); }

  MarkedOdometry odometry{DriftModel()};
  Pose T = Pose::Identity();
  double before = 0.0;
};

TEST_F(Gap, IsOverWhenTwoMeasurementsAgree) {
  drive(10, predicted());
  EXPECT_GT(x(), 0.09);
  drive(1, measured());
  EXPECT_GT(x(), 0.09) << "one measurement alone may have settled elsewhere";
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_LT(x(), before + 1e-4);
  EXPECT_LT(y(), before + 1e-3);
  EXPECT_LT(odometry.covariance()(0, 0), before + 1e-4) << "the published one as well";
  const double then = y();
  drive(10, measured());
  EXPECT_LT(y(), then + 1e-3) << "the heading's error is gone, too";
}

TEST_F(Gap, KeepsWhatTheMeasurementDoesNotSee) {
  drive(10, predicted());
  const double lost = x();
  Vector6d corridor = Vector6d::Constant(1e-3);
  corridor[0] = 30.0;
  drive(1, confirmed(corridor));
  EXPECT_NEAR(x(), lost, 0.02 * lost);
  EXPECT_LT(y(), before + 1e-3);
}

TEST_F(Gap, IsNotForgivenTooLateOrTooFarOff) {
  drive(10, predicted());
  drive(100, measured());
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_GT(x(), 0.09);

  SetUp();
  OdometryIncrement wild = predicted();
  wild.motion(0, 0) = 4.0;
  drive(7, wild);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_GT(x(), 27.9);
}

TEST_F(Gap, IsNotForgivenInAReferenceThatBeganInIt) {
  OdometryIncrement restart = predicted();
  restart.map_update = MapUpdate::kRestart;
  drive(9, predicted());
  drive(1, restart);
  const double lost = x();
  EXPECT_GT(lost, 0.09);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_GT(x(), 0.99 * lost);
  drive(5, predicted());
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_LT(x(), lost + 0.02) << "the next gap is one of its own";
  const double then = x();
  drive(9, predicted());
  OdometryIncrement by_corners = measured();  // a third reference begins at what one measurement alone says
  by_corners.map_update = MapUpdate::kRestart;
  drive(1, by_corners);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_GT(x(), then + 0.08);
}

TEST_F(Gap, IsOverWhenOneSourceAloneHoldsForTwoSeconds) {
  drive(10, predicted());
  OdometryIncrement alone = measured();
  alone.alone = true;
  drive(19, alone);
  EXPECT_GT(x(), 0.09);
  drive(1, alone);
  EXPECT_LT(x(), before + 0.02);
}

TEST_F(Gap, LeavesNothingOfItselfToAMark) {
  drive(10, predicted());
  drive(1, measured());
  odometry.mark(T);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_LT(x(), 1e-4) << "the pose did not jump";
}

TEST_F(Gap, ThatWasTooLongIsNotForgivenInParts) {
  drive(150, predicted());
  const double lost = x();
  EXPECT_GT(lost, 1.4);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_GT(x(), 0.99 * lost) << "the map began anew on the way";
  drive(5, predicted());
  EXPECT_GT(x(), lost + 0.04);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_LT(x(), lost + 0.02) << "the next gap is one of its own";
}

TEST_F(Gap, AnUnusableIncrementDoesNotEndIt) {
  drive(5, predicted());
  EXPECT_FALSE(odometry.propagate(T, planarPose(1e200, 0.0, 0.0), confirmed(Vector6d::Constant(1e-3))));
  EXPECT_GT(x(), 0.04);
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_LT(x(), before + 1e-4) << "it is still there to be ended";
}

TEST_F(Gap, AConfirmedSweepWithoutOneChangesNothing) {
  MarkedOdometry other = odometry;
  const Pose next = T * planarPose(1.0, 0.0, 0.0);
  ASSERT_TRUE(other.propagate(T, next, measured()));
  drive(1, confirmed(Vector6d::Constant(1e-3)));
  EXPECT_TRUE(other.sinceMark().isApprox(odometry.sinceMark(), 1e-12));
}

// 1 m and 0.1 s a sweep; the registration observes the way along with `sigma_m`.
double sigmaAlong(MarkedOdometry& odometry, int sweeps, double sigma_m) {
  Matrix6d motion = 1e-4 * Matrix6d::Identity();
  motion(0, 0) = 0.05 * 0.05;
  Matrix6d R = 1e-6 * Matrix6d::Identity();
  R(0, 0) = sigma_m * sigma_m;
  return std::sqrt(driveStraight(odometry, sweeps, motion, R).pose()(0, 0));
}

DriftModel maps(double length_m, double registration_ratio) {
  DriftModel params = independentDrift();
  params.map_length_m = length_m;
  params.registration_ratio = registration_ratio;
  return params;
}

TEST(OdometryCovariance, EachMapCostsOneRegistration) {
  MarkedOdometry odometry(maps(50.0, 1.0));
  odometry.mark(Pose::Identity());
  const double sigma = sigmaAlong(odometry, 1000, 0.02);
  // 20 maps; K R K^T is 0.74 R
  EXPECT_NEAR(sigma, 0.02 * std::sqrt(20.0 * 0.74), 0.01);
}

TEST(OdometryCovariance, WeakRegistrationHoldsThePoseInTheMap) {
  MarkedOdometry held(maps(50.0, 0.0)), blind(maps(50.0, 0.0));
  held.mark(Pose::Identity());
  blind.mark(Pose::Identity());
  // each sweep's motion is as uncertain as its registration: 0.05 m. 0.5 m if nothing held it
  EXPECT_LT(sigmaAlong(held, 100, 0.05), 0.1);
  EXPECT_NEAR(sigmaAlong(blind, 100, 1e3), 0.5, 0.01);
  EXPECT_LT(held.rate().speed_share, 0.05);
  EXPECT_GT(blind.rate().speed_share, 0.95);
}

TEST(OdometryCovariance, AShortPlaceWithoutInformationCostsLittle) {
  MarkedOdometry odometry(maps(100.0, 0.0));
  odometry.mark(Pose::Identity());
  sigmaAlong(odometry, 50, 0.005);
  const double within = sigmaAlong(odometry, 20, 1e3);
  EXPECT_GT(within, 0.2);
  EXPECT_LT(sigmaAlong(odometry, 5, 0.005), 0.3 * within) << "the map from before is seen again";
}

TEST(OdometryCovariance, TheRateIsThatOfTheGrowth) {
  for (const double sigma_m : {0.02, 0.1, 0.5}) {
    MarkedOdometry odometry(maps(50.0, 1.0));
    odometry.mark(Pose::Identity());
    const double before = sigmaAlong(odometry, 1000, sigma_m), after = sigmaAlong(odometry, 1000, sigma_m);
    EXPECT_NEAR(1000.0 * odometry.rate().covariance(0, 0) / (after * after - before * before), 1.0, 0.05) << sigma_m;
  }
}

TEST(OdometryCovariance, WhatHardlyLeftItsGuessObservesNothing) {
  for (const int axis : {0, 5}) {
    MarkedOdometry odometry(maps(50.0, 0.0));
    odometry.mark(Pose::Identity());
    Matrix6d motion = 1e-6 * Matrix6d::Identity(), R = 1e-8 * Matrix6d::Identity();
    motion(axis, axis) = 1e-4;
    R(0, 0) = R(1, 1) = 0.6 * 0.6;  // the way to the side would tell the heading
    if (axis == 5) R(5, 5) = 0.03 * 0.03;
    EXPECT_NEAR(driveStraight(odometry, 100, motion, R).pose()(axis, axis), 100.0 * 1e-4, 1e-4) << axis;
  }
}

TEST(OdometryCovariance, DoubtIsNotTakenBack) {
  MarkedOdometry odometry(maps(50.0, 0.0));
  odometry.mark(Pose::Identity());
  OdometryIncrement increment;
  increment.motion = 1e-4 * Matrix6d::Identity();
  increment.registration = 1e-8 * Matrix6d::Identity();
  increment.confirmed = true;
  increment.doubt.sigma_m = 0.3;
  ASSERT_TRUE(odometry.propagate(Pose::Identity(), planarPose(1.0, 0.0, 0.0), increment));
  increment.doubt.sigma_m = 0.0;
  ASSERT_TRUE(odometry.propagate(planarPose(1.0, 0.0, 0.0), planarPose(2.0, 0.0, 0.0), increment));
  EXPECT_NEAR(std::sqrt(odometry.sinceMark()(0, 0)), 0.3, 0.001);
}

TEST(OdometryCovariance, NewMapCostsWithinItsFirstDecimetre) {
  DriftModel params = independentDrift();
  params.new_map_m = 0.02;
  MarkedOdometry odometry(params);
  const auto drive = [&](double from_m, double to_m, MapUpdate map_update = MapUpdate::kInsert) {
    OdometryIncrement increment;
    increment.map_update = map_update;
    ASSERT_TRUE(odometry.propagate(planarPose(from_m, 0, 0), planarPose(to_m, 0, 0), increment));
  };
  odometry.mark(planarPose(5, 0, 0));
  drive(5.0, 5.0);
  EXPECT_EQ(odometry.sinceMark()(0, 0), 0.0) << "it stands";
  drive(5.0, 5.05);
  EXPECT_NEAR(odometry.sinceMark()(1, 1), 0.5 * 0.0004, 1e-9);
  drive(5.05, 5.0);
  drive(5.0, 8.0);
  drive(8.0, 5.0);
  EXPECT_NEAR(odometry.sinceMark()(0, 0), 0.0004, 1e-9);
  EXPECT_NEAR(odometry.covariance()(0, 0), 0.0004, 1e-9);
  EXPECT_NEAR(std::sqrt(odometry.covariance()(4, 4)) / kDegree, 0.1, 0.01);
  EXPECT_EQ(odometry.covariance()(5, 5), 0.0) << "not the heading";
  drive(5.0, 6.0, MapUpdate::kRestart);
  EXPECT_NEAR(odometry.sinceMark()(0, 0), 0.0008, 1e-9) << "another map";
}

}  // namespace
}  // namespace fail_aware::odometry_covariance_test
