#include "core/registration/corner_svd/corner_alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "../../../support/poses.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::corner_alignment_test {
namespace {

Corner cornerAt(double x, double y, double turn_rad = 0.0) {
  Corner corner;
  corner.M = {x, y, 0.0};
  corner.J = {x, y, 0.5};
  corner.N = {x + std::cos(turn_rad), y + std::sin(turn_rad), 0.0};
  corner.planes[0] = {{std::sin(turn_rad), -std::cos(turn_rad), 0}, 0.02, 400, {}};
  corner.planes[1] = {{-std::cos(turn_rad), -std::sin(turn_rad), 0}, 0.02, 400, {}};
  return corner;
}

std::vector<Corner> town() {
  return {cornerAt(12, 6), cornerAt(25, -7, 0.3), cornerAt(4, -9, -0.2), cornerAt(-10, 8), cornerAt(-18, -6, 0.1)};
}

std::vector<Corner> seenFrom(const Pose& T_odom_cog, const std::vector<Corner>& corners_odom) {
  std::vector<Corner> corners;
  for (const Corner& corner : corners_odom) corners.push_back(movedCorner(T_odom_cog.inverse(), corner));
  return corners;
}

Matrix6d predictedCovariance() {
  Vector6d variances;
  variances << 0.01, 0.01, 0.04, 0.003, 0.003, 0.0001;
  return variances.asDiagonal();
}

Measurement align(const std::vector<Corner>& corners_cog, const std::vector<Corner>& reference, const Pose& prediction,
                  const CornerAlignment& params = {}) {
  return params.align(corners_cog, reference, prediction, predictedCovariance());
}

double normal(std::mt19937& generator) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(static_cast<std::uint32_t>(generator())) / 4294967296.0;
  return sum;
}

TEST(CornerAlignment, RecoversTheMotionFromTwoCornersAndMore) {
  const Pose truth = pose(1.5, 0.2, 0.1, 0.01, -0.02, 0.08);
  const Pose prediction = pose(1.3, 0.3, 0.1, 0.01, -0.02, 0.07);
  for (std::size_t count = 2; count <= town().size(); ++count) {
    std::vector<Corner> some = town();
    some.resize(count);
    const Measurement result = align(seenFrom(truth, some), town(), prediction);
    ASSERT_TRUE(result.ok());
    EXPECT_EQ(result.inliers, count);
    EXPECT_TRUE(result.T_odom_cog.isApprox(truth, 1e-9));
    EXPECT_NEAR(result.rms_residual_m, 0.0, 1e-9);
    EXPECT_DOUBLE_EQ(result.inlier_ratio, 1.0);
  }
}

TEST(CornerAlignment, HeightRollPitchStayPredicted) {
  const Pose truth = pose(1.5, 0.2, 0.3, 0.02, -0.01, 0.08);
  const Pose prediction = pose(1.4, 0.2, 0.0, 0.0, 0.0, 0.08);
  const Measurement result = align(seenFrom(truth, town()), town(), prediction);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.degenerate_directions, 3);
  const Vector6d state = vectorFromPose(result.T_odom_cog);
  EXPECT_NEAR(state(2), 0.0, 1e-9);
  EXPECT_NEAR(state(3), 0.0, 1e-9);
  EXPECT_NEAR(state(4), 0.0, 1e-9);
  EXPECT_NEAR(state(0), 1.5, 0.02);
  EXPECT_NEAR(state(1), 0.2, 0.02);
  for (const int k : {2, 3, 4}) EXPECT_GE(result.covariance(k, k), 9.9 * predictedCovariance()(k, k));
  for (const int k : {0, 1}) EXPECT_LT(result.covariance(k, k), 0.03 * 0.03);
  EXPECT_LT(result.covariance(5, 5), 0.005 * 0.005);
}

TEST(CornerAlignment, OneCornerIsTooFew) {
  EXPECT_EQ(align({cornerAt(12, 6)}, town(), Pose::Identity()).status, MeasurementStatus::kTooFewCorners);
  EXPECT_EQ(align({cornerAt(12, 6)}, town(), Pose::Identity()).iterations, 1);
  EXPECT_EQ(align({}, town(), Pose::Identity()).status, MeasurementStatus::kTooFewCorners);
  EXPECT_EQ(align({}, town(), Pose::Identity()).iterations, 0) << "a sweep without corners did not search";
}

TEST(CornerAlignment, WithoutAReferenceThereIsNoReference) {
  EXPECT_EQ(align(town(), {}, Pose::Identity()).status, MeasurementStatus::kNoReference);
}

TEST(CornerAlignment, AtSpeedItTakesThePrediction) {
  const Pose truth = pose(2.5, 0.0, 0.0, 0.0, 0.0, 0.02);  // 25 m/s
  EXPECT_EQ(align(seenFrom(truth, town()), town(), Pose::Identity()).status, MeasurementStatus::kTooFewCorners);
  EXPECT_TRUE(align(seenFrom(truth, town()), town(), pose(2.3, 0.1, 0.0, 0.0, 0.0, 0.02)).ok());
}

TEST(CornerAlignment, MirrorImageIsDegenerate) {
  const std::vector<Corner> corners{cornerAt(12, 0, 0.05), cornerAt(20, 0, -0.05)};
  const std::vector<Corner> mirrored{cornerAt(12, 0, -0.05), cornerAt(20, 0, 0.05)};
  EXPECT_EQ(align(corners, mirrored, Pose::Identity()).status, MeasurementStatus::kDegenerate);
  EXPECT_TRUE(align(corners, corners, Pose::Identity()).ok());
}

TEST(CornerAlignment, CornersThatStandTogetherAreDegenerate) {
  const std::vector<Corner> together{cornerAt(12, 6), cornerAt(13, 6.5)};
  EXPECT_EQ(align(together, together, Pose::Identity()).status, MeasurementStatus::kDegenerate);
}

TEST(CornerAlignment, MovingEdgesAreLeftOut) {
  const Pose truth = pose(1.5, 0.2, 0.0, 0.0, 0.0, 0.05);
  std::vector<Corner> now = town();
  now.push_back(cornerAt(9.4, -2.0));
  now.push_back(cornerAt(15.35, 2.1));
  std::vector<Corner> before = town();
  before.push_back(cornerAt(9.0, -2.0));
  before.push_back(cornerAt(15.0, 2.0));
  const Measurement result = align(seenFrom(truth, now), before, truth);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.inliers, 5u);
  EXPECT_NEAR(result.inlier_ratio, 5.0 / 7.0, 1e-12);
  EXPECT_TRUE(result.T_odom_cog.isApprox(truth, 1e-9));
}

TEST(CornerAlignment, TwoCornersThatContradictEachOtherAreTooFew) {
  std::vector<Corner> now{cornerAt(12, 6), cornerAt(-10.45, 8)};
  EXPECT_EQ(align(now, town(), Pose::Identity()).status, MeasurementStatus::kTooFewCorners);
}

TEST(CornerAlignment, NInTheOtherPlaneIsPutRight) {
  std::vector<Corner> now = town();
  for (Corner& corner : now) corner = withOtherPlane(corner);
  const Measurement result = align(now, town(), pose(0.1, 0, 0, 0, 0, 0.01));
  ASSERT_TRUE(result.ok());
  EXPECT_TRUE(result.T_odom_cog.isApprox(Pose::Identity(), 1e-9));
}

// Monte Carlo: corners with the errors that R is computed for.
TEST(CornerAlignment, StatedCovarianceIsThatOfTheError) {
  const CornerAlignment params;
  const double place_variance = 0.02 * 0.02 + 0.5 * 2.0 * 4.0 * 0.02 * 0.02 / 20.0;
  const double direction_variance = std::pow(0.5 * 3.14159265 / 180.0, 2) + 0.02 * 0.02 / 20.0;
  const Pose truth = pose(2.0, 1.0, 0.0, 0.0, 0.0, 0.3);
  std::mt19937 generator(1);
  Eigen::Matrix3d measured = Eigen::Matrix3d::Zero(), stated = Eigen::Matrix3d::Zero();
  const int trials = 2000;
  const auto disturbed = [&](Corner corner) {
    const Eigen::Vector3d e(std::sqrt(place_variance) * normal(generator),
                            std::sqrt(place_variance) * normal(generator), 0);
    const Eigen::AngleAxisd turn(std::sqrt(direction_variance) * normal(generator), Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d direction = turn * (corner.N - corner.M);
    corner.M += e;
    corner.J += e;
    corner.N = corner.M + direction;
    return corner;
  };
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<Corner> now, before;
    for (const Corner& corner : town()) {
      now.push_back(movedCorner(truth.inverse(), disturbed(corner)));
      before.push_back(disturbed(corner));
    }
    const Measurement result = align(now, before, truth, params);
    ASSERT_TRUE(result.ok());
    const Vector6d error = stateDifference(vectorFromPose(result.T_odom_cog), vectorFromPose(truth));
    const Eigen::Vector3d planar(error(0), error(1), error(5));
    measured += planar * planar.transpose() / trials;
    Eigen::Matrix3d R;
    const int index[3] = {0, 1, 5};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) R(i, j) = result.covariance(index[i], index[j]);
    }
    stated += R / trials;
  }
  for (int i = 0; i < 3; ++i) {
    const double ratio = std::sqrt(measured(i, i) / stated(i, i));
    EXPECT_GT(ratio, 0.7) << i;
    EXPECT_LT(ratio, 1.1) << i;
  }
  const double nees = (stated.inverse() * measured).trace() / 3.0;
  EXPECT_GT(nees, 0.6);
  EXPECT_LT(nees, 1.15);
}

TEST(CornerAlignment, CovarianceGrowsWithResiduals) {
  const Measurement good = align(town(), town(), Pose::Identity());
  std::vector<Corner> rough = town();
  for (Corner& corner : rough) corner.planes[0].rms_m = corner.planes[1].rms_m = 0.3;
  EXPECT_GT(align(rough, town(), Pose::Identity()).covariance(0, 0), 2.0 * good.covariance(0, 0));
  std::vector<Corner> spread = town();
  const double shift = 0.1;
  for (std::size_t i = 0; i < spread.size(); ++i) {
    Pose T = Pose::Identity();
    T.translation().x() = i % 2 == 0 ? shift : -shift;
    spread[i] = movedCorner(T, spread[i]);
  }
  const Measurement scattered = align(spread, town(), Pose::Identity());
  ASSERT_TRUE(scattered.ok());
  EXPECT_GT(scattered.covariance(0, 0), 2.0 * good.covariance(0, 0));
  EXPECT_GT(scattered.rms_residual_m, 0.03);
}

TEST(CornerAlignment, MoreCornersMeanMoreInformation) {
  std::vector<Corner> two = town();
  two.resize(2);
  const double few = align(two, town(), Pose::Identity()).min_information_ratio;
  const double many = align(town(), town(), Pose::Identity()).min_information_ratio;
  EXPECT_GT(few, 0.0);
  EXPECT_LT(few, many);
  EXPECT_LE(many, 1.0);
}

TEST(CornerAlignment, NothingThatIsNoNumberComesOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Corner> bad = town();
  bad[0].M.x() = nan;
  bad[1].N.y() = nan;
  bad[2].J.z() = nan;
  bad.push_back(cornerAt(1e300, -1e300));
  const Measurement result = align(bad, town(), Pose::Identity());
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.inliers, 2u);
  EXPECT_TRUE(isFinite(result.T_odom_cog) && result.covariance.allFinite());

  Pose lost = Pose::Identity();
  lost.translation().x() = nan;
  const Measurement unplaced = align(town(), town(), lost);
  EXPECT_FALSE(unplaced.ok());
  EXPECT_TRUE(isFinite(unplaced.T_odom_cog) && unplaced.covariance.allFinite());
  EXPECT_FALSE(CornerAlignment().align(town(), town(), Pose::Identity(), Matrix6d::Constant(nan)).ok());
}

TEST(CornerAlignment, BadParametersThrow) {
  CornerAlignment params;
  params.min_corners = 1;
  EXPECT_THROW(validate(params), ParameterError);
}

}  // namespace
}  // namespace fail_aware::corner_alignment_test
