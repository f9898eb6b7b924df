#include "core/geometry/rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace fail_aware::rotation_test {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

const std::vector<Vector3>& axes() {
  static const std::vector<Vector3> kAxes = {Vector3::UnitX(),
                                             Vector3::UnitY(),
                                             Vector3::UnitZ(),
                                             -Vector3::UnitX(),
                                             Vector3(1.0, 2.0, -3.0).normalized(),
                                             Vector3(-1.0, 1e-3, 1e-6).normalized(),
                                             Vector3(1.0, 1.0, 1.0).normalized(),
                                             Vector3(0.0, -1.0, 1.0).normalized()};
  return kAxes;
}

TEST(Rotation, WrapsAnglesIntoTheHalfOpenInterval) {
  EXPECT_EQ(wrapAngle(0.0), 0.0);
  EXPECT_EQ(wrapAngle(-M_PI), -M_PI);
  EXPECT_EQ(wrapAngle(M_PI), -M_PI);
  EXPECT_NEAR(wrapAngle(3.0 * M_PI), -M_PI, 1e-14);
  EXPECT_NEAR(wrapAngle(1.5 * M_PI), -0.5 * M_PI, 1e-14);
  EXPECT_NEAR(wrapAngle(-1.5 * M_PI), 0.5 * M_PI, 1e-14);
  EXPECT_NEAR(wrapAngle(2000.0 * M_PI + 0.25), 0.25, 1e-11);
  for (double angle = -40.0; angle < 40.0; angle += 0.01) {
    const double wrapped = wrapAngle(angle);
    EXPECT_GE(wrapped, -M_PI);
    EXPECT_LT(wrapped, M_PI);
    EXPECT_NEAR(std::remainder(wrapped - angle, 2.0 * M_PI), 0.0, 1e-13);
  }
}

TEST(Rotation, WrapAngleReturnsWhatIsNotFinite) {
  EXPECT_TRUE(std::isnan(wrapAngle(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isinf(wrapAngle(std::numeric_limits<double>::infinity())));
}

TEST(Rotation, RpyTurnsAboutTheRightAxes) {
  const double quarter = M_PI / 2.0;
  EXPECT_LT((rotationFromRpy(0.0, 0.0, quarter) * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_LT((rotationFromRpy(0.0, quarter, 0.0) * Vector3::UnitX() + Vector3::UnitZ()).norm(), 1e-15);  // nose down
  EXPECT_LT((rotationFromRpy(quarter, 0.0, 0.0) * Vector3::UnitY() - Vector3::UnitZ()).norm(), 1e-15);
}

TEST(Rotation, RpyIsYawAfterPitchAfterRoll) {
  const double roll = 0.3, pitch = -0.7, yaw = 2.5;
  const Matrix3 expected = (Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
                            Eigen::AngleAxisd(roll, Vector3::UnitX()))
                               .toRotationMatrix();
  EXPECT_LT((rotationFromRpy(roll, pitch, yaw) - expected).norm(), 1e-15);
}

TEST(Rotation, RpyRoundTrip) {
  for (const double roll : {-3.14159, -1.0, -1e-9, 0.0, 0.4, 3.14159}) {
    for (const double pitch : {-1.5, -0.5, 0.0, 1e-9, 1.0, 1.57}) {
      for (const double yaw : {-3.14159, -2.0, 0.0, 1e-9, 1.0, 3.14159}) {
        const Vector3 rpy = rpyFromRotation(rotationFromRpy(roll, pitch, yaw));
        EXPECT_LT((rpy - Vector3(roll, pitch, yaw)).norm(), 1e-11) << roll << " " << pitch << " " << yaw;
      }
    }
  }
}

TEST(Rotation, GimbalLockPutsAllIntoYaw) {
  for (const double pitch : {M_PI / 2.0, -M_PI / 2.0}) {
    for (const double roll : {-1.0, 0.0, 0.5}) {
      for (const double yaw : {-3.0, 0.0, 0.8}) {
        const Matrix3 R = rotationFromRpy(roll, pitch, yaw);
        const Vector3 rpy = rpyFromRotation(R);
        EXPECT_EQ(rpy.x(), 0.0);
        EXPECT_NEAR(rpy.y(), pitch, 1e-9);
        EXPECT_LT((rotationFromRpy(rpy.x(), rpy.y(), rpy.z()) - R).norm(), 1e-9) << roll << " " << pitch << " " << yaw;
      }
    }
  }
}

TEST(Rotation, RpyNearGimbalLockStillGivesTheSameRotation) {
  for (const double distance : {1e-3, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12}) {
    for (const double sign : {1.0, -1.0}) {
      const Matrix3 R = rotationFromRpy(0.4, sign * (M_PI / 2.0 - distance), -1.2);
      const Vector3 rpy = rpyFromRotation(R);
      EXPECT_LT((rotationFromRpy(rpy.x(), rpy.y(), rpy.z()) - R).norm(), 3e-8) << distance;
    }
  }
}

TEST(Rotation, SkewIsTheCrossProduct) {
  const Vector3 a(0.3, -2.0, 5.0), b(-1.0, 0.7, 2.0);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
  EXPECT_TRUE((skew(a) + skew(a).transpose()).isZero(0.0));
}

TEST(Rotation, ExpIsTheRotationAboutTheVector) {
  for (const Vector3& axis : axes()) {
    for (const double angle : {1e-9, 5e-5, 0.99e-4, 1.01e-4, 0.02, 1.0, 3.0, M_PI, 4.0, 7.0}) {
      const Matrix3 R = expSo3(angle * axis);
      EXPECT_LT((R - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(), 1e-14) << angle;
      EXPECT_LT((R * R.transpose() - Matrix3::Identity()).norm(), 1e-14) << angle;
    }
  }
  EXPECT_TRUE(expSo3(Vector3::Zero()).isIdentity(0.0));
}

TEST(Rotation, LogInvertsExpFromZeroToPi) {
  for (const Vector3& axis : axes()) {
    for (const double angle : {0.0, 1e-14, 1e-11, 1e-9, 1e-6, 0.99e-4, 1.01e-4, 1e-2, 1.0, 2.0, 3.0, M_PI - 1e-3,
                               M_PI - 1e-6, M_PI - 1e-9}) {
      const Vector3 w = angle * axis;
      const Vector3 back = logSo3(expSo3(w));
      EXPECT_LT((back - w).norm(), 1e-13 + 1e-9 * angle) << angle << " about " << axis.transpose();
      EXPECT_LT((back - w).norm(), 1e-4 * angle + 1e-300) << angle;
    }
  }
}

TEST(Rotation, LogAtPiMayTakeEitherSign) {
  for (const Vector3& axis : axes()) {
    const Matrix3 R = expSo3(M_PI * axis);
    const Vector3 w = logSo3(R);
    EXPECT_NEAR(w.norm(), M_PI, 1e-9);
    EXPECT_LT((expSo3(w) - R).norm(), 1e-9);
  }
}

TEST(Rotation, LogBeyondPiTakesTheShortWay) {
  for (const Vector3& axis : axes()) {
    EXPECT_LT((logSo3(expSo3(4.0 * axis)) - (4.0 - 2.0 * M_PI) * axis).norm(), 1e-13);
    EXPECT_LT(logSo3(expSo3(2.0 * M_PI * axis)).norm(), 1e-12);
  }
}

TEST(Rotation, FixedAxisRatesMatchFiniteDifferences) {
  constexpr double kStep = 1e-6;
  for (const double roll : {-0.6, 0.0, 0.3}) {
    for (const double pitch : {-1.2, 0.0, 0.5}) {
      for (const double yaw : {-3.0, 0.0, 1.7}) {
        const Vector3 rpy(roll, pitch, yaw);
        Matrix3 expected;
        for (int i = 0; i < 3; ++i) {
          const Vector3 up = rpy + kStep * Vector3::Unit(i), down = rpy - kStep * Vector3::Unit(i);
          const Matrix3 turned =
              rotationFromRpy(up.x(), up.y(), up.z()) * rotationFromRpy(down.x(), down.y(), down.z()).transpose();
          expected.col(i) = logSo3(turned) / (2.0 * kStep);
        }
        EXPECT_LT((fixedAxisFromRpyRates(rpy) - expected).norm(), 1e-8) << rpy.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace fail_aware::rotation_test
