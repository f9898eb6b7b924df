#include "core/estimation/vertical_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/estimation/odometry_covariance.hpp"
#include "core/geometry/degree.hpp"

namespace fail_aware::vertical_drift_test {
namespace {

constexpr double kTilt = 0.2 * kDegree;

Eigen::Matrix2d pitchAlone() { return Eigen::Vector2d(0.0, kTilt * kTilt).asDiagonal(); }

TEST(VerticalDrift, HeightGrowsWithTheDistanceAlongWhichTheTiltActs) {
  VerticalDrift ahead, left;
  for (int i = 0; i < 100; ++i) {
    ahead.advance(Eigen::Vector3d::UnitX(), pitchAlone());
    left.advance(Eigen::Vector3d::UnitY(), pitchAlone());
  }
  EXPECT_NEAR(std::sqrt(ahead.covariance()(2, 2)), 100.0 * kTilt, 1e-9);
  EXPECT_EQ(left.covariance()(2, 2), 0.0);
  EXPECT_DOUBLE_EQ(ahead.covariance()(4, 4), kTilt * kTilt);
  EXPECT_EQ(ahead.covariance()(3, 3), 0.0);
}

TEST(VerticalDrift, KeepsWhatItKnowsWhereNothingIsGiven) {
  VerticalDrift drift;
  drift.advance(Eigen::Vector3d::UnitX(), pitchAlone());
  drift.advance(Eigen::Vector3d::UnitX(), std::nullopt);
  drift.advance(Eigen::Vector3d::UnitX(), Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_NEAR(std::sqrt(drift.covariance()(2, 2)), 3.0 * kTilt, 1e-12);
}

TEST(VerticalDrift, NothingHorizontalChanges) {
  OdometryCovariance with{DriftModel()}, without{DriftModel()};
  Pose T = Pose::Identity();
  OdometryIncrement increment;
  increment.motion = 1e-6 * Matrix6d::Identity();
  increment.dt_s = 0.1;
  for (int i = 0; i < 200; ++i) {
    Pose next = T;
    next.translation() += Eigen::Vector3d(0.8, 0.3, 0.1);  // uphill
    increment.tilt_moment.reset();
    ASSERT_TRUE(without.propagate(T, next, increment));
    increment.tilt_moment = kTilt * kTilt * Eigen::Matrix2d::Identity();
    ASSERT_TRUE(with.propagate(T, next, increment));
    T = next;
  }
  const Matrix6d added = with.covariance() - without.covariance();
  for (const int i : {0, 1, 5}) EXPECT_TRUE(added.row(i).isZero(0.0)) << i;
  EXPECT_NEAR(std::sqrt(added(2, 2)), 200.0 * std::hypot(0.8, 0.3) * kTilt, 1e-6);
  with.reset();
  EXPECT_TRUE(with.covariance().isApprox(OdometryCovariance{DriftModel()}.covariance()));
}

}  // namespace
}  // namespace fail_aware::vertical_drift_test
