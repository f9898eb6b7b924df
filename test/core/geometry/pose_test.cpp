#include "core/geometry/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "../../support/poses.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware::pose_test {
namespace {

Vector6d twistOf(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation) {
  Vector6d twist;
  twist << translation, rotation;
  return twist;
}

double distance(const Pose& a, const Pose& b) { return (a.matrix() - b.matrix()).norm(); }

/// (dt, dr) of the covariance convention.
Vector6d errorOf(const Pose& T_true, const Pose& T) {
  return twistOf(T_true.translation() - T.translation(), logSo3(T_true.linear() * T.linear().transpose()));
}

Pose disturbed(const Pose& T, const Vector6d& error) {
  Pose out = T;
  out.translation() += error.head<3>();
  out.linear() = expSo3(error.tail<3>()) * T.linear();
  return out;
}

Matrix6d someCovariance() {
  Matrix6d A;
  A << 2.0, 0.1, 0.3, 0.0, 0.2, -0.4,  //
      0.0, 1.5, 0.2, 0.3, 0.0, 0.1,    //
      0.2, 0.0, 0.5, -0.1, 0.3, 0.0,   //
      0.0, 0.1, 0.0, 0.4, 0.1, 0.2,    //
      0.1, 0.0, 0.2, 0.0, 0.3, 0.0,    //
      0.3, -0.2, 0.0, 0.1, 0.0, 0.6;
  return A * A.transpose();
}

Pose somePose() { return poseFromVector(vector6(12.0, -7.0, 2.0, 0.2, -0.3, 2.2)); }
Pose someOffset() { return poseFromVector(vector6(-3.0, 4.0, 1.5, -0.1, 0.4, -0.8)); }

// Exp of the 4x4 twist matrix, summed as its power series.
Eigen::Matrix4d exponentialSeries(const Vector6d& twist) {
  Eigen::Matrix4d X = Eigen::Matrix4d::Zero(), term = Eigen::Matrix4d::Identity(), sum = term;
  X.topLeftCorner<3, 3>() = skew(twist.tail<3>());
  X.topRightCorner<3, 1>() = twist.head<3>();
  for (int k = 1; k < 60; ++k) {
    term = (term * X / k).eval();
    sum += term;
  }
  return sum;
}

TEST(Pose, ExpIsTheMatrixExponential) {
  for (const double angle : {0.0, 1e-9, 0.99e-4, 1.01e-4, 0.01, 1.0, 3.0, 5.0}) {
    const Vector6d twist = twistOf({1.0, -20.0, 3.0}, angle * Eigen::Vector3d(0.6, 0.0, -0.8));
    EXPECT_LT((expSe3(twist).matrix() - exponentialSeries(twist)).norm(), 1e-11) << angle;
  }
}

TEST(Pose, ExpOfDrivingACircle) {
  const double v = 10.0, w = 0.4, t = 2.0;
  const Pose T = expSe3(t * vector6(v, 0.0, 0.0, 0.0, 0.0, w));
  EXPECT_NEAR(T.translation().x(), v / w * std::sin(w * t), 1e-12);
  EXPECT_NEAR(T.translation().y(), v / w * (1.0 - std::cos(w * t)), 1e-12);
  EXPECT_NEAR(rpyFromRotation(T.linear()).z(), w * t, 1e-12);
}

TEST(Pose, LogInvertsExp) {
  const std::vector<Eigen::Vector3d> axes = {Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(),
                                             Eigen::Vector3d(1.0, -2.0, 0.5).normalized()};
  for (const Eigen::Vector3d& axis : axes) {
    for (const double angle : {0.0, 1e-12, 1e-9, 1e-6, 0.99e-4, 1.01e-4, 1e-2, 1.0, 3.0, M_PI - 1e-3, M_PI - 1e-6}) {
      const Vector6d twist = twistOf({1.5, -30.0, 4.0}, angle * axis);
      EXPECT_LT((logSe3(expSe3(twist)) - twist).norm(), 1e-8) << angle;
    }
  }
  EXPECT_TRUE(logSe3(Pose::Identity()).isZero(0.0));
}

TEST(Pose, ExpInvertsLogAtPi) {
  const Pose T = expSe3(twistOf({2.0, 1.0, -5.0}, M_PI * Eigen::Vector3d(0.0, 0.6, 0.8)));
  EXPECT_LT(distance(expSe3(logSe3(T)), T), 1e-9);
}

TEST(Pose, StateVectorRoundTrip) {
  const Vector6d state = vector6(1e4, -2e4, 30.0, 0.1, -0.2, 3.0);
  EXPECT_LT((vectorFromPose(poseFromVector(state)) - state).norm(), 1e-11);
  const Pose T = poseFromVector(state);
  EXPECT_LT((T * Eigen::Vector3d(1.0, 2.0, 3.0) -
             (state.head<3>() + rotationFromRpy(0.1, -0.2, 3.0) * Eigen::Vector3d(1.0, 2.0, 3.0)))
                .norm(),
            1e-10);
}

TEST(Pose, StateDifferenceWrapsOnlyAngles) {
  const Vector6d a = vector6(10.0, 0.0, 0.0, 3.1, -3.1, 3.0), b = vector6(0.0, 8.0, -9.0, -3.1, 3.1, 1.0);
  const Vector6d expected = vector6(10.0, -8.0, 9.0, 6.2 - 2.0 * M_PI, 2.0 * M_PI - 6.2, 2.0);
  EXPECT_LT((stateDifference(a, b) - expected).norm(), 1e-14);
}

TEST(Pose, StateJacobianMatchesFiniteDifferences) {
  constexpr double kStep = 1e-6;
  const Vector6d state = vector6(5.0, 6.0, 7.0, 0.3, -0.8, 2.0);
  Matrix6d expected;
  for (int i = 0; i < 6; ++i) {
    expected.col(i) =
        errorOf(poseFromVector(state + kStep * Vector6d::Unit(i)), poseFromVector(state - kStep * Vector6d::Unit(i))) /
        (2.0 * kStep);
  }
  EXPECT_LT((poseFromStateJacobian(state.tail<3>()) - expected).norm(), 1e-8);
}

TEST(Pose, CovarianceAfterOffsetMatchesFiniteDifferences) {
  constexpr double kStep = 1e-6;
  const Pose T_a_b = somePose(), T_b_c = someOffset();
  Matrix6d J;
  for (int i = 0; i < 6; ++i) {
    J.col(i) = errorOf(disturbed(T_a_b, kStep * Vector6d::Unit(i)) * T_b_c,
                       disturbed(T_a_b, -kStep * Vector6d::Unit(i)) * T_b_c) /
               (2.0 * kStep);
  }
  const Matrix6d C = someCovariance();
  const Matrix6d expected = J * C * J.transpose();
  EXPECT_LT((covarianceAfterOffset(C, T_a_b, T_b_c) - expected).norm(), 1e-6 * expected.norm());
}

TEST(Pose, YawErrorMovesAFarPointSideways) {
  Matrix6d C = Matrix6d::Zero();
  C(5, 5) = 0.01 * 0.01;
  Pose T_b_c = Pose::Identity();
  T_b_c.translation().x() = 100.0;
  const Matrix6d moved = covarianceAfterOffset(C, Pose::Identity(), T_b_c);
  EXPECT_NEAR(std::sqrt(moved(1, 1)), 1.0, 1e-12);
  EXPECT_NEAR(moved(0, 0), 0.0, 1e-15);
  EXPECT_NEAR(moved(1, 5), 1.0 * 0.01, 1e-12);
}

TEST(Pose, RotatedCovarianceFollowsItsAxes) {
  Matrix6d C = Matrix6d::Zero();
  C.diagonal() << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  const Matrix6d turned = rotateCovariance(C, rotationFromRpy(0.0, 0.0, M_PI / 2.0));
  EXPECT_LT((turned.diagonal() - vector6(2.0, 1.0, 3.0, 5.0, 4.0, 6.0)).norm(), 1e-14);
  const Eigen::Matrix3d R = rotationFromRpy(0.1, 0.2, 0.3);
  EXPECT_LT((rotateCovariance(rotateCovariance(someCovariance(), R), R.transpose()) - someCovariance()).norm(), 1e-13);
}

TEST(Pose, OrthonormalizedStaysRigidOverThousandsOfProducts) {
  const Pose step = expSe3(vector6(1.0, 0.01, 0.0, 0.001, -0.002, 0.03));
  Pose T = Pose::Identity();
  for (int i = 0; i < 20000; ++i) T = orthonormalized(T * step);
  EXPECT_LT((T.linear() * T.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(T.linear().determinant(), 1.0, 1e-14);
  EXPECT_TRUE(isFinite(T));
}

TEST(Pose, OrthonormalizedChangesNoMoreThanTheError) {
  const Pose T = somePose();
  EXPECT_LT(distance(orthonormalized(T), T), 1e-14);
  Pose bent = T;
  bent.linear()(0, 1) += 1e-6;
  bent.linear()(2, 2) -= 1e-6;
  const Pose mended = orthonormalized(bent);
  EXPECT_LT((mended.linear() * mended.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT(distance(mended, T), 2e-6);
}

TEST(Pose, FinitenessLooksAtEveryNumber) {
  EXPECT_TRUE(isFinite(somePose()));
  Pose T = somePose();
  T.translation().z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isFinite(T));
  T = somePose();
  T.linear()(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(isFinite(T));
}

TEST(Pose, AsExchangedIsThePoseOnceRounded) {
  for (int i = 0; i < 200; ++i) {
    Vector6d v;
    for (int k = 0; k < 6; ++k) v[k] = std::sin(1.7 * i + 2.3 * k) * (k < 3 ? 100.0 : 3.1);
    v[4] *= 0.4;
    const Pose T = poseFromVector(v);
    EXPECT_TRUE(quaternionRoundTrip(T).isApprox(T, 1e-14));
    EXPECT_GE(quaternionOf(T).w(), 0.0);
    EXPECT_TRUE(poseOf(T.translation(), quaternionOf(T)).matrix() == quaternionRoundTrip(T).matrix());
  }
  EXPECT_TRUE(quaternionRoundTrip(Pose::Identity()).matrix() == Pose::Identity().matrix());
}

}  // namespace
}  // namespace fail_aware::pose_test
