#include "core/registration/normal_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../support/poses.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::normal_equations_test {
namespace {

ObservabilityParams testParams() {
  ObservabilityParams params;
  params.lever_m = 10.0;
  params.min_information_ratio = 0.01;
  params.weak_sigma_m = 3.0;
  params.weak_sigma_deg = 5.0;
  return params;
}

/// H = weight diag(shares), rotation shares at the lever of testParams().
NormalEquations diagonalEquations(const Vector6d& shares, double weight) {
  NormalEquations equations;
  Vector6d lever2;
  lever2 << 1.0, 1.0, 1.0, 100.0, 100.0, 100.0;
  equations.H = (weight * shares.cwiseProduct(lever2)).asDiagonal();
  equations.weight = weight;
  return equations;
}

NormalEquations wellConditioned() {
  NormalEquations equations = diagonalEquations(vector6(0.3, 0.5, 0.2, 0.4, 0.3, 0.6), 1e4);
  const Matrix6d mix = rotateCovariance(equations.H, rotationFromRpy(0.2, -0.4, 1.0));
  equations.H = mix;
  equations.H(0, 5) = equations.H(5, 0) = 900.0;
  equations.b = vector6(10.0, -20.0, 5.0, 100.0, -70.0, 30.0);
  return equations;
}

TEST(NormalEquations, WellConditionedIsSolvedExactly) {
  const NormalEquations equations = wellConditioned();
  const Solution solution = solveObserved(equations, testParams());
  EXPECT_EQ(solution.degenerate_directions, 0);
  EXPECT_LT((equations.H * solution.dx - equations.b).norm(), 1e-9);
}

TEST(NormalEquations, WellConditionedCovarianceIsTheInverse) {
  const NormalEquations equations = wellConditioned();
  const Matrix6d expected = 20.0 * inverseOf(equations.H);
  EXPECT_LT((covarianceObserved(equations, 20.0, testParams()) - expected).norm(), 1e-9 * expected.norm());
}

TEST(NormalEquations, UnobservedAxisStaysAndIsUncertain) {
  NormalEquations equations = diagonalEquations(vector6(0.005, 0.6, 0.4, 0.3, 0.3, 0.3), 1e4);
  equations.b.setConstant(50.0);
  const Solution solution = solveObserved(equations, testParams());
  EXPECT_EQ(solution.degenerate_directions, 1);
  EXPECT_EQ(solution.dx[0], 0.0);
  EXPECT_NEAR(solution.dx[1], 50.0 / 6000.0, 1e-12);
  EXPECT_NEAR(solution.dx[5], 50.0 / 3e5, 1e-12);
  const Matrix6d C = covarianceObserved(equations, 1.0, testParams());
  EXPECT_NEAR(std::sqrt(C(0, 0)), 3.0, 1e-9);
  EXPECT_NEAR(C(1, 1), 1.0 / 6000.0, 1e-12);
}

TEST(NormalEquations, UnobservedRotationGetsTheWeakAngle) {
  NormalEquations equations = diagonalEquations(vector6(0.3, 0.3, 0.4, 0.0, 0.005, 0.3), 1e4);
  equations.b.setConstant(50.0);
  const Solution solution = solveObserved(equations, testParams());
  EXPECT_EQ(solution.degenerate_directions, 2);
  EXPECT_EQ(solution.dx[3], 0.0);
  EXPECT_EQ(solution.dx[4], 0.0);
  const Matrix6d C = covarianceObserved(equations, 1.0, testParams());
  EXPECT_NEAR(std::sqrt(C(3, 3)), 5.0 * kDegree, 1e-9);
  EXPECT_NEAR(std::sqrt(C(4, 4)), 5.0 * kDegree, 1e-9);
}

TEST(NormalEquations, UnobservedDirectionNeedNotBeAnAxis) {
  NormalEquations equations = diagonalEquations(vector6(0.0, 0.6, 0.4, 0.3, 0.3, 0.3), 1e4);
  const Eigen::Matrix3d R = rotationFromRpy(0.0, 0.0, 30.0 * kDegree);
  equations.H = rotateCovariance(equations.H, R).eval();
  equations.b << 50.0, 80.0, 0.0, 0.0, 0.0, 0.0;
  const Eigen::Vector3d along = R.col(0), across = R.col(1);
  const Solution solution = solveObserved(equations, testParams());
  EXPECT_EQ(solution.degenerate_directions, 1);
  EXPECT_NEAR(along.dot(solution.dx.head<3>()), 0.0, 1e-12);
  EXPECT_NEAR(across.dot(solution.dx.head<3>()), across.dot(equations.b.head<3>()) / 6000.0, 1e-12);
  const Eigen::Matrix3d C = covarianceObserved(equations, 1.0, testParams()).topLeftCorner<3, 3>();
  EXPECT_NEAR(along.dot(C * along), 9.0, 1e-9);
  EXPECT_NEAR(across.dot(C * across), 1.0 / 6000.0, 1e-9);
}

TEST(NormalEquations, TheThresholdIsARatioOfTheWeight) {
  for (const double weight : {1.0, 1e6}) {
    NormalEquations equations = diagonalEquations(vector6(0.0101, 0.5, 0.5, 0.0099, 0.3, 0.3), weight);
    EXPECT_EQ(solveObserved(equations, testParams()).degenerate_directions, 1) << weight;
    equations.H *= 0.5;
    EXPECT_EQ(solveObserved(equations, testParams()).degenerate_directions, 2) << weight;
  }
}

TEST(NormalEquations, InformationTellsWhatHDoesNotObserve) {
  // H pulls along x, where no pair informs
  NormalEquations equations = diagonalEquations(vector6(1.0, 1.0, 1.0, 0.5, 0.5, 0.5), 1e4);
  equations.b.setConstant(50.0);
  equations.has_information = equations.slides = true;
  equations.information = diagonalEquations(vector6(0.0, 0.5, 0.5, 0.2, 0.2, 0.2), 1e4).H;
  equations.information_b.setConstant(20.0);
  equations.information_weight = 1e4;
  const Solution solution = solveObserved(equations, testParams());
  EXPECT_EQ(solution.degenerate_directions, 1);
  EXPECT_EQ(solution.dx[0], 0.0);
  EXPECT_NEAR(solution.dx[1], 50.0 / 1e4, 1e-12) << "H's own step where it is observed";
  EXPECT_EQ(solution.min_horizontal_ratio, 0.0);
  const Matrix6d C = covarianceObserved(equations, 1.0, testParams());
  EXPECT_NEAR(std::sqrt(C(0, 0)), 3.0, 1e-9);
  EXPECT_NEAR(C(1, 1), 1.0 / 5000.0, 1e-12);
}

TEST(NormalEquations, PoorInformationAloneGivesTheStep) {
  NormalEquations equations = diagonalEquations(vector6(1.0, 1.0, 1.0, 0.5, 0.5, 0.5), 1e4);
  equations.b.setConstant(50.0);
  equations.has_information = equations.slides = true;
  equations.information = diagonalEquations(vector6(0.02, 0.5, 0.5, 0.2, 0.2, 0.2), 1e4).H;
  equations.information_b.setConstant(20.0);
  equations.information_weight = 1e4;
  const Solution solution = solveObserved(equations, testParams());
  EXPECT_EQ(solution.degenerate_directions, 0);
  EXPECT_NEAR(solution.dx[0], 20.0 / 200.0, 1e-12);
  EXPECT_NEAR(solution.dx[1], 20.0 / 5000.0, 1e-12);
}

TEST(NormalEquations, ADiscountedDirectionCountsForLess) {
  NormalEquations equations = diagonalEquations(vector6(0.02, 0.5, 0.3, 0.3, 0.3, 0.3), 1e4);
  equations.b.setConstant(50.0);
  NormalEquations half = equations, none = equations;
  discount(half, Eigen::Vector2d::UnitX(), 0.6);
  EXPECT_EQ(solveObserved(half, testParams()).degenerate_directions, 0);
  EXPECT_NEAR(covarianceObserved(half, 1.0, testParams())(0, 0), 1.0 / (0.6 * 200.0), 1e-12);
  EXPECT_NEAR(covarianceObserved(half, 1.0, testParams())(1, 1), 1.0 / 5000.0, 1e-12);
  discount(none, Eigen::Vector2d::UnitX(), 0.4);
  EXPECT_EQ(solveObserved(none, testParams()).degenerate_directions, 1);
  EXPECT_EQ(solveObserved(none, testParams()).dx[0], 0.0);
}

TEST(NormalEquations, AStepIsComparedWithItsStandardDeviation) {
  Matrix6d C = Matrix6d::Identity();
  C(0, 0) = 9.0;
  EXPECT_TRUE(isWithinSigma(2.9 * Vector6d::Unit(0), C));
  EXPECT_FALSE(isWithinSigma(1.1 * Vector6d::Unit(1), C));
}

TEST(NormalEquations, NothingAtAllIsAllWeak) {
  const NormalEquations nothing;
  const Solution solution = solveObserved(nothing, testParams());
  EXPECT_EQ(solution.degenerate_directions, 6);
  EXPECT_TRUE(solution.dx.isZero(0.0));
  EXPECT_EQ(solution.min_horizontal_ratio, 0.0);
  const Matrix6d C = covarianceObserved(nothing, 1.0, testParams());
  ASSERT_TRUE(C.allFinite());
  EXPECT_NEAR(std::sqrt(C(0, 0)), 3.0, 1e-9);
  EXPECT_NEAR(std::sqrt(C(5, 5)), 5.0 * kDegree, 1e-9);
}

TEST(NormalEquations, ObservedDirectionsAreBetter) {
  NormalEquations equations = diagonalEquations(vector6(0.02, 0.5, 0.48, 0.3, 0.3, 0.3), 10.0);
  const Matrix6d C = covarianceObserved(equations, 1e3, testParams());
  EXPECT_NEAR(std::sqrt(C(0, 0)), 3.0, 1e-9);
  EXPECT_LE(C(5, 5), std::pow(5.0 * kDegree, 2) + 1e-12);
}

TEST(NormalEquations, CovarianceIsSymmetricPositiveDefinite) {
  for (const NormalEquations& equations :
       {wellConditioned(), NormalEquations(), diagonalEquations(vector6(0.0, 0.5, 0.5, 0.3, 0.0, 0.3), 1e5)}) {
    const Matrix6d C = covarianceObserved(equations, 20.0, testParams());
    EXPECT_LT((C - C.transpose()).norm(), 1e-12);
    EXPECT_GT(symmetricEigenvalues(C)[0], 0.0);
  }
}

TEST(NormalEquations, HorizontalRatiosAreOfTheWeakestAndTheStrongestDirection) {
  EXPECT_NEAR(
      solveObserved(diagonalEquations(vector6(0.1, 0.6, 0.3, 1.0, 1.0, 1.0), 50.0), testParams()).min_horizontal_ratio,
      0.1, 1e-12);
  NormalEquations turned = diagonalEquations(vector6(0.1, 0.6, 0.3, 1.0, 1.0, 1.0), 50.0);
  turned.H = rotateCovariance(turned.H, rotationFromRpy(0.0, 0.0, 0.7)).eval();
  EXPECT_NEAR(solveObserved(turned, testParams()).min_horizontal_ratio, 0.1, 1e-12);
  EXPECT_NEAR(horizontalRatios(turned).weakest, 0.1, 1e-12);
  EXPECT_NEAR(horizontalRatios(turned).strongest, 0.6, 1e-12);
  EXPECT_EQ(horizontalRatios(NormalEquations()).strongest, 0.0);
}

TEST(NormalEquations, AStepTurnsAboutTheVehicleAndMovesAlongOdom) {
  const Pose T = poseFromVector(vector6(100.0, -50.0, 2.0, 0.1, -0.2, 2.0));
  const Vector6d dx = 1e-5 * vector6(3.0, -2.0, 1.0, 0.3, 0.5, -0.7);
  const Pose moved = applyStep(T, dx);
  for (const Eigen::Vector3d& q : {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(20.0, -10.0, 3.0)}) {
    const Eigen::Vector3d arm = T.linear() * q;
    const Eigen::Vector3d expected = T * q + dx.head<3>() + dx.tail<3>().cross(arm);
    EXPECT_LT((moved * q - expected).norm(), 1e-8);
  }
  EXPECT_LT((moved.linear() * moved.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(NormalEquations, ValidatesItsParameters) {
  EXPECT_NO_THROW(validate(ObservabilityParams()));
  ObservabilityParams params = testParams();
  params.min_information_ratio = 0.5;
  EXPECT_THROW(validate(params), ParameterError);
}

TEST(NormalEquations, CurvatureRatioIsThatOfWhatInforms) {
  NormalEquations equations;
  EXPECT_EQ(curvatureRatio(equations), 0.0);
  equations.weight = 100.0;
  equations.curvature = 30.0;
  EXPECT_NEAR(curvatureRatio(equations), 0.3, 1e-12);
  equations.has_information = true;
  equations.information_weight = 40.0;
  EXPECT_NEAR(curvatureRatio(equations), 0.75, 1e-12);
}

}  // namespace
}  // namespace fail_aware::normal_equations_test
