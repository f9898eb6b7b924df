#include "core/estimation/observed_directions.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../support/random_orthogonal.hpp"
#include "core/estimation/ukf.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/registration/normal_equations.hpp"

namespace fail_aware::observed_directions_test {
namespace {

constexpr ObservedLimit kLimit = {0.3, 0.5};

TEST(ObservedDirections, CountAsTheyAreLessOrNotAtAll) {
  std::mt19937 random(1);
  const Eigen::Matrix3d Q = randomOrthogonal(random).topLeftCorner<3, 3>().householderQr().householderQ();
  Eigen::Matrix3d C = Q * Eigen::Vector3d(0.04, 0.16, 9.0).asDiagonal() * Q.transpose();
  openUnobserved(kLimit, C);
  const Eigen::Vector3d variances = (Q.transpose() * C * Q).diagonal();
  EXPECT_NEAR(variances[0], 0.04, 1e-6) << "surely";
  EXPECT_NEAR(variances[1], 0.32, 1e-6) << "half";
  EXPECT_NEAR(variances[2], 1e6, 1.0) << "not at all";
}

TEST(ObservedDirections, APoseFromElsewhereMeasuresInAll) {
  Measurement gps;
  gps.status = MeasurementStatus::kOk;
  FusionResult fusion;
  fusion.R = 4.0 * Matrix6d::Identity();
  for (const double weight : {0.0, 0.5}) {
    fusion.weights = {weight};
    const Matrix6d R = covarianceForFilter(fusion, {{"gps", &gps, FusionInput::Kind::kExternal}});
    EXPECT_EQ(R.isApprox(fusion.R), weight > 0.0) << weight;
  }
}

// A tunnel of 60 s: a registration leaves the pose along it at the prediction, ten times a second.
TEST(ObservedDirections, OpenTheyLeaveTheFilterUncertain) {
  const double step_sigma_m = 0.06, weak_m = ObservabilityParams().weak_sigma_m;
  Matrix6d Q = 1e-4 * Matrix6d::Identity(), R = 1e-4 * Matrix6d::Identity();
  Q(0, 0) = step_sigma_m * step_sigma_m;
  R(0, 0) = weak_m * weak_m;
  openUnobserved({1.0, 2.0}, R.topLeftCorner<3, 3>());
  Ukf ukf;
  ASSERT_TRUE(ukf.reset(Vector6d::Zero(), 1e-6 * Matrix6d::Identity()));
  for (int i = 0; i < 600; ++i) {
    ASSERT_TRUE(ukf.predict([](const Vector6d& x) { return x; }, Q));
    ASSERT_TRUE(ukf.correct(ukf.state(), R));
  }
  EXPECT_GT(std::sqrt(ukf.covariance()(0, 0)), 0.9 * step_sigma_m * std::sqrt(600.0));
}

}  // namespace
}  // namespace fail_aware::observed_directions_test
