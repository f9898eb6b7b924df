#include "core/estimation/measurement_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "../../support/poses.hpp"
#include "../../support/random_orthogonal.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::measurement_fusion_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Measurement measurementAt(const Vector6d& state, const Matrix6d& covariance) {
  Measurement m;
  m.status = MeasurementStatus::kOk;
  m.T_odom_cog = poseFromVector(state);
  m.covariance = covariance;
  return m;
}

Matrix6d diagonal(double xy, double z, double angle) { return vector6(xy, xy, z, angle, angle, angle).asDiagonal(); }

MeasurementFusion literalFusion() {
  MeasurementFusion params;
  params.literal = true;
  params.gate_sigma = 1.0;
  return params;
}

MeasurementFusion defaultFusion() { return {}; }

std::vector<FusionInput> inputsOf(const std::vector<Measurement>& measurements) {
  std::vector<FusionInput> inputs;
  for (const Measurement& m : measurements) inputs.push_back({"m" + std::to_string(inputs.size()), &m});
  return inputs;
}

// --- the article's formula

TEST(MeasurementFusionLiteral, MatchesTheArticle) {
  Matrix6d P = diagonal(0.04, 0.01, 0.01);
  P(1, 1) = 0.25;
  P(0, 1) = P(1, 0) = 0.09;  // the article's ellipse is axis-aligned: no effect
  const std::vector<Measurement> m = {measurementAt(vector6(0.1, 0.0, 1.0, 0, 0, 0.2), diagonal(0.01, 0.02, 0.03)),
                                      measurementAt(vector6(-0.05, 0.0, 2.0, 0, 0, 0.0), diagonal(0.05, 0.02, 0.01)),
                                      measurementAt(vector6(0.0, 0.3, 0.0, 0, 0, 0.1), diagonal(0.01, 0.06, 0.01))};
  const FusionResult r = literalFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
  ASSERT_TRUE(r.has_measurement);
  EXPECT_NEAR(r.weights[0], 0.5, 1e-12);   // |0.1/0.2 - 1|
  EXPECT_NEAR(r.weights[1], 0.75, 1e-12);  // |0.05/0.2 - 1|
  EXPECT_NEAR(r.weights[2], 0.4, 1e-12);   // |0.3/0.5 - 1|
  const double total = 1.65;
  EXPECT_NEAR(r.z[0], (0.5 * 0.1 - 0.75 * 0.05) / total, 1e-12);
  EXPECT_NEAR(r.z[1], 0.4 * 0.3 / total, 1e-12);
  EXPECT_NEAR(r.z[2], (0.5 * 1.0 + 0.75 * 2.0) / total, 1e-12);
  EXPECT_NEAR(r.z[5], (0.5 * 0.2 + 0.4 * 0.1) / total, 1e-12);
  EXPECT_NEAR(r.R(0, 0), (0.5 * 0.01 + 0.75 * 0.05 + 0.4 * 0.01) / total, 1e-12);
  EXPECT_NEAR(r.R(2, 2), (0.5 * 0.02 + 0.75 * 0.02 + 0.4 * 0.06) / total, 1e-12);
  EXPECT_TRUE(r.R.isDiagonal(1e-15));
}

TEST(MeasurementFusionLiteral, TheEllipsesEdge) {
  const Matrix6d P = diagonal(0.25, 1.0, 1.0);  // sigma 0.5, exact in binary
  const auto weightAt = [&](double x) {
    const std::vector<Measurement> m = {measurementAt(vector6(x, 0, 0, 0, 0, 0), diagonal(0.01, 0.01, 0.01))};
    const FusionResult r = literalFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
    EXPECT_EQ(r.has_measurement, r.weights[0] > 0.0);
    EXPECT_EQ(r.all_gated_out, !r.has_measurement);
    EXPECT_FALSE(r.prediction_overruled);
    return r.weights[0];
  };
  EXPECT_NEAR(weightAt(0.499), 0.002, 1e-12);
  EXPECT_EQ(weightAt(0.5), 0.0);
  EXPECT_EQ(weightAt(0.501), 0.0);
  EXPECT_EQ(weightAt(0.0), 1.0);
}

TEST(MeasurementFusionLiteral, NeverOverrulesThePrediction) {
  const Measurement far = measurementAt(vector6(5, 0, 0, 0, 0, 0), diagonal(0.01, 0.01, 0.01));
  const FusionResult r = literalFusion().fuse(Vector6d::Zero(), diagonal(0.01, 0.01, 0.01), inputsOf({far, far}));
  EXPECT_FALSE(r.has_measurement);
  EXPECT_TRUE(r.all_gated_out);
}

TEST(MeasurementFusion, YawIsAveragedAcrossItsWrapInBothFormulas) {
  const Vector6d predicted = vector6(0, 0, 0, 0, 0, M_PI - 0.01);
  const Matrix6d R = diagonal(0.01, 0.01, 0.01);
  const std::vector<Measurement> m = {measurementAt(vector6(0, 0, 0, 0, 0, M_PI - 0.02), R),
                                      measurementAt(vector6(0, 0, 0, 0, 0, -M_PI + 0.04), R)};
  for (const MeasurementFusion& fusion : {literalFusion(), defaultFusion()}) {
    const FusionResult r = fusion.fuse(predicted, R, inputsOf(m));
    ASSERT_TRUE(r.has_measurement);
    EXPECT_NEAR(wrapAngle(r.z[5] - (-M_PI + 0.01)), 0.0, 1e-12);
    EXPECT_LE(std::abs(r.z[5]), M_PI);
    EXPECT_NEAR(r.disagreement_yaw_rad, 0.06, 1e-12);
  }
}

// --- the default

TEST(MeasurementFusion, GateUsesTheFullCovarianceBlock) {
  Matrix6d P = diagonal(0.5, 0.1, 0.1);
  P(0, 1) = P(1, 0) = 0.49;  // long axis along (1, 1): sigma 0.995; across: 0.1
  const Matrix6d R = diagonal(1e-6, 0.1, 0.1);
  const std::vector<Measurement> m = {measurementAt(vector6(0.7, 0.7, 0, 0, 0, 0), R),
                                      measurementAt(vector6(0.7, -0.7, 0, 0, 0, 0), R)};
  const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
  EXPECT_NEAR(r.weights[0], 1.0 - std::sqrt(0.98 / 0.990001) / 3.0, 1e-9);
  EXPECT_EQ(r.weights[1], 0.0);
  EXPECT_NEAR((r.z - m[0].T_odom_cog.translation().x() * vector6(1, 1, 0, 0, 0, 0)).norm(), 0.0, 1e-12);
  EXPECT_FALSE(r.all_gated_out);
  EXPECT_NEAR(r.disagreement_m, 1.4, 1e-12);
}

TEST(MeasurementFusion, AnOutvotedMeasurementDecidesNothing) {
  const Matrix6d P = diagonal(0.01, 0.1, 0.1), R = diagonal(1e-4, 0.1, 0.1);
  std::vector<Measurement> m = {measurementAt(vector6(0.02, 0, 0, 0, 0, 0), R),
                                measurementAt(vector6(0.0, 0.01, 0, 0, 0, 0), R),
                                measurementAt(vector6(1.0, 0, 0, 0, 0, 0), R)};
  FusionResult r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
  EXPECT_EQ(r.weights[2], 0.0);
  EXPECT_NEAR(r.disagreement_m, 1.0, 1e-3);
  EXPECT_EQ(r.undecided_m, 0.0);
  m.erase(m.begin() + 1);
  r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
  EXPECT_EQ(r.weights[1], 0.0);
  EXPECT_EQ(r.undecided_m, r.disagreement_m) << "one against one";
  EXPECT_FALSE(r.confirmed);
}

TEST(MeasurementFusion, TwoDoNotOutvoteTwo) {
  const Matrix6d P = diagonal(0.01, 0.1, 0.1), R = diagonal(1e-4, 0.1, 0.1);
  const auto at = [&](double x_m) { return measurementAt(vector6(x_m, 0, 0, 0, 0, 0), R); };
  const FusionResult tie = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({at(0.0), at(0.02), at(1.0), at(1.1)}));
  EXPECT_GT(tie.weights[1], 0.0);
  EXPECT_EQ(tie.weights[2], 0.0);
  EXPECT_NEAR(tie.undecided_m, 1.1, 1e-12);
  EXPECT_FALSE(tie.confirmed);
  const FusionResult alone_each =
      defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({at(0.0), at(0.02), at(1.0), at(-1.0)}));
  EXPECT_NEAR(alone_each.disagreement_m, 2.0, 1e-12);
  EXPECT_EQ(alone_each.undecided_m, 0.0) << "two against one, twice";
  EXPECT_TRUE(alone_each.confirmed);
  const FusionResult three =
      defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({at(0.0), at(0.02), at(1.0), at(0.03), at(1.1)}));
  EXPECT_EQ(three.undecided_m, 0.0) << "three against two";
}

TEST(MeasurementFusion, ExpectedDistanceDecidesNothing) {
  const Matrix6d P = diagonal(0.04, 0.1, 0.1), R = diagonal(1e-4, 0.1, 0.1);
  const auto undecidedWith = [&](double sigma_m) {
    const std::vector<Measurement> m = {
        measurementAt(vector6(0.01, 0, 0, 0, 0, 0), R), measurementAt(vector6(-0.01, 0, 0, 0, 0, 0), R),
        measurementAt(vector6(0.0, 0.25, 0, 0, 0, 0), diagonal(sigma_m * sigma_m, 0.1, 0.1))};
    const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
    EXPECT_GT(r.weights[2], 0.0);
    EXPECT_NEAR(r.disagreement_m, std::hypot(0.25, 0.01), 1e-12) << "is told all the same";
    EXPECT_EQ(r.confirmed, r.undecided_m == 0.0);
    return r.undecided_m / r.weights[2];
  };
  EXPECT_EQ(undecidedWith(0.1), 0.0);
  EXPECT_NEAR(undecidedWith(0.05), std::hypot(0.25, 0.01), 1e-12) << "five sigma are no chance";
  EXPECT_NEAR(undecidedWith(0.3), std::hypot(0.25, 0.01), 1e-12) << "what knows next to nothing bears nobody out";
}

TEST(MeasurementFusion, OutnumberedCountsByWeight) {
  const Matrix6d P = diagonal(0.04, 0.1, 0.1), R = diagonal(1e-4, 0.1, 0.1);
  const auto at = [&](double x_m) { return measurementAt(vector6(x_m, 0, 0, 0, 0, 0), R); };
  const FusionResult far = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({at(0.0), at(0.01), at(0.4)}));
  EXPECT_NEAR(far.weights[2], 1.0 - 0.4 / std::sqrt(0.0401) / 3.0, 1e-9);
  EXPECT_NEAR(far.undecided_m, 0.4 * far.weights[2], 1e-12);
  EXPECT_FALSE(far.confirmed) << "it speaks against the others all the same";
  const FusionResult led_astray = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({at(0.4), at(0.41), at(0.0)}));
  EXPECT_NEAR(led_astray.undecided_m, 0.4, 1e-12) << "the prediction bears out the one";
  const FusionResult one_against_one = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({at(0.0), at(0.4)}));
  EXPECT_NEAR(one_against_one.undecided_m, 0.4, 1e-12);
}

TEST(MeasurementFusion, TheGatesEdge) {
  MeasurementFusion params;
  params.gate_sigma = 2.0;
  params.min_weight = 0.25;
  const Matrix6d half = diagonal(0.125, 1.0, 1.0);  // P + R = 0.25: sigma 0.5
  const auto weightAt = [&](double x) {
    return params.fuse(Vector6d::Zero(), half, inputsOf({measurementAt(vector6(0, x, 0, 0, 0, 0), half)})).weights[0];
  };
  EXPECT_NEAR(weightAt(0.5), 0.5, 1e-12);
  EXPECT_NEAR(weightAt(0.7499), 0.2501, 1e-12);
  EXPECT_EQ(weightAt(0.7501), 0.0);  // 1 - 1.5002/2 < min_weight
  params.min_weight = 0.0;
  EXPECT_NEAR(weightAt(0.999), 0.001, 1e-12);
  EXPECT_EQ(weightAt(1.0), 0.0);
}

TEST(MeasurementFusion, MeasurementsOfOneSweepDoNotShrinkR) {
  Matrix6d R = diagonal(0.01, 0.02, 0.001);
  R(0, 5) = R(5, 0) = 0.001;
  const Vector6d z = vector6(0.1, -0.1, 0.2, 0, 0, 0.05);
  const Measurement m = measurementAt(z, R);
  const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), diagonal(0.04, 0.04, 0.01), inputsOf({m, m, m}));
  ASSERT_TRUE(r.has_measurement);
  EXPECT_TRUE(r.z.isApprox(z, 1e-12));
  EXPECT_TRUE(r.R.isApprox(R, 1e-9));
}

TEST(MeasurementFusion, WhatKnowsNextToNothingGetsNoWeight) {
  const Matrix6d P = diagonal(0.01, 0.01, 1e-3);
  const Measurement sure = measurementAt(Vector6d::Zero(), diagonal(1e-4, 1e-4, 1e-6));
  const Measurement vague = measurementAt(vector6(0.1, 0, 0, 0, 0, 0), diagonal(100.0, 100.0, 1.0));
  const Measurement one_way = measurementAt(vector6(0.1, 0, 0, 0, 0, 0), vector6(100, 1e-4, 1, 1, 1, 1).asDiagonal());
  const FusionResult alone = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({sure}));
  const FusionResult both = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({sure, vague}));
  EXPECT_EQ(both.weights[1], 0.0);
  EXPECT_EQ(both.z, alone.z);
  EXPECT_EQ(both.R, alone.R);
  EXPECT_GT(defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({sure, one_way})).weights[1], 0.0);
  EXPECT_GT(defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({vague})).weights[0], 0.0) << "there is nothing better";
}

TEST(MeasurementFusion, BestMeasurementLimitsTrust) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Measurement> m;
    for (int i = 0; i < 3; ++i) {
      const Matrix6d A = Matrix6d::NullaryExpr([&]() { return 0.1 * normal(random); });
      m.push_back(measurementAt(Vector6d::Zero(), A * A.transpose() + 1e-4 * Matrix6d::Identity()));
    }
    const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), diagonal(0.1, 0.1, 0.1), inputsOf(m));
    ASSERT_TRUE(r.has_measurement);
    for (int i = 0; i < 20; ++i) {
      const Vector6d u = Vector6d::NullaryExpr([&]() { return normal(random); });
      double best = 0.0;
      for (const Measurement& each : m) best = std::max(best, u.dot(solutionOf(each.covariance, u)));
      EXPECT_LE(u.dot(solutionOf(r.R, u)), best * (1.0 + 1e-6));
    }
  }
}

TEST(MeasurementFusion, WhatDoesNotObserveHeightDoesNotPullIt) {
  const std::vector<Measurement> m = {
      measurementAt(vector6(0.02, 0, 0.5, 0, 0, 0), vector6(1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6).asDiagonal()),
      measurementAt(vector6(0.00, 0, 9.0, 0, 0, 0), vector6(1e-4, 1e-4, 1e6, 1e-6, 1e-6, 1e-6).asDiagonal())};
  const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), diagonal(1.0, 1.0, 0.1), inputsOf(m));
  ASSERT_TRUE(r.has_measurement);
  EXPECT_NEAR(r.z[2], 0.5, 1e-6);
  EXPECT_NEAR(r.z[0], 0.01, 1e-3);
  EXPECT_GT(r.R(2, 2), 1e-4);
  EXPECT_LT(r.R(2, 2), 3e-4);
}

TEST(MeasurementFusion, ObliqueTunnelIsStable) {
  // Only across the tunnel (30 deg to odom) is observed; along it one of three measurements knows something.
  Eigen::Matrix3d tunnel = Eigen::AngleAxisd(M_PI / 6.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto covariance = [&](double along) {
    return rotateCovariance(vector6(along, 1e-8, 1e-4, 1e-6, 1e-6, 1e-8).asDiagonal(), tunnel);
  };
  const auto at = [&](double along, double across) {
    const Eigen::Vector3d t = tunnel * Eigen::Vector3d(along, across, 0.0);
    return vector6(t.x(), t.y(), 0, 0, 0, 0);
  };
  const std::vector<Measurement> m = {measurementAt(at(40.0, 0.01), covariance(1e6)),
                                      measurementAt(at(-25.0, 0.01), covariance(1e6)),
                                      measurementAt(at(0.2, 0.01), covariance(1e-2))};
  const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), diagonal(0.25, 0.1, 0.1), inputsOf(m));
  ASSERT_TRUE(r.has_measurement);
  const Eigen::Vector3d z = tunnel.transpose() * r.z.head<3>();
  EXPECT_NEAR(z.x(), 0.2, 1e-3);
  EXPECT_NEAR(z.y(), 0.01, 1e-5);
  const Matrix6d R = rotateCovariance(r.R, tunnel.transpose());
  EXPECT_NEAR(R(1, 1), 1e-8, 1e-9);
  EXPECT_GT(R(0, 0), 1e-2);
  EXPECT_LT(R(0, 0), 4e-2);

  const FusionResult blind = defaultFusion().fuse(Vector6d::Zero(), diagonal(0.25, 0.1, 0.1), inputsOf({m[0], m[1]}));
  ASSERT_TRUE(blind.has_measurement);
  const Matrix6d R_blind = rotateCovariance(blind.R, tunnel.transpose());
  EXPECT_GT(R_blind(0, 0), 5e5);
  EXPECT_LT(R_blind(1, 1), 1e-7);
  EXPECT_NEAR((tunnel.transpose() * blind.z.head<3>()).y(), 0.01, 1e-5);
}

TEST(MeasurementFusion, ConvertsThePosesCovarianceToTheStates) {
  const Vector6d state = vector6(3, -2, 1, 0.2, 0.5, -1.0);
  Matrix6d C = diagonal(0.01, 0.02, 0.004);
  C(3, 5) = C(5, 3) = 0.002;
  C(1, 4) = C(4, 1) = -0.003;
  const Matrix6d P = diagonal(0.1, 0.1, 0.02);
  const Vector6d offset = vector6(0.05, -0.1, 0.2, 0.01, -0.02, 0.03);
  const FusionResult r = defaultFusion().fuse(state - offset, P, inputsOf({measurementAt(state, C)}));
  const Matrix6d J_inverse = inverseOf(poseFromStateJacobian(state.tail<3>()));
  const Matrix6d expected = J_inverse * C * J_inverse.transpose();
  ASSERT_TRUE(r.has_measurement);
  EXPECT_TRUE(r.z.isApprox(state, 1e-12));
  EXPECT_TRUE(r.R.isApprox(expected, 1e-12));
  EXPECT_NEAR(r.nis[0], offset.dot(inverseOf(P + expected) * offset), 1e-9);
}

TEST(MeasurementFusion, AgreeingMeasurementsOverruleThePrediction) {
  const Matrix6d P = diagonal(0.0025, 0.01, 1e-4);
  const Matrix6d R = diagonal(1e-4, 1e-4, 1e-6);
  const std::vector<Measurement> m = {measurementAt(vector6(2.0, 0, 0, 0, 0, 0.1), R),
                                      measurementAt(vector6(-3.0, 1, 0, 0, 0, 0.0), R),
                                      measurementAt(vector6(2.1, 0, 0, 0, 0, 0.11), R)};
  const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
  EXPECT_TRUE(r.has_measurement);
  EXPECT_TRUE(r.all_gated_out);
  EXPECT_TRUE(r.prediction_overruled);
  EXPECT_EQ(r.weights, (std::vector<double>{1.0, 0.0, 1.0}));
  EXPECT_NEAR(r.z[0], 2.05, 1e-9);
  EXPECT_NEAR(r.z[5], 0.105, 1e-9);
  EXPECT_GT(r.nis[0], 100.0);
}

TEST(MeasurementFusion, MostOfAGroupOutsideTheGateOverrules) {
  const Matrix6d P = diagonal(1e-4, 1e-4, 1e-6);
  const Matrix6d R = diagonal(1e-4, 1e-4, 1e-6), vague = diagonal(1e-3, 1e-3, 1e-5);
  const Measurement inside = measurementAt(vector6(0.08, 0, 0, 0, 0, 0), vague);
  const Measurement one = measurementAt(vector6(0.10, 0, 0, 0, 0, 0), R), other = one;
  const Measurement elsewhere = measurementAt(vector6(-0.15, 0, 0, 0, 0, 0), 4.0 * vague);
  const auto fused = [&](const std::vector<Measurement>& m) {
    return defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
  };
  const FusionResult r = fused({one, other, inside});
  EXPECT_TRUE(r.prediction_overruled);
  EXPECT_FALSE(r.all_gated_out);
  EXPECT_EQ(r.weights, (std::vector<double>{1.0, 1.0, 1.0}));
  EXPECT_FALSE(fused({one, inside}).prediction_overruled) << "one against one: the prediction decides";
  EXPECT_FALSE(fused({one, other, elsewhere}).prediction_overruled) << "one inside the gate stands by the prediction";
}

TEST(MeasurementFusion, GatedOutWithoutAgreementIsNoMeasurement) {
  const Matrix6d P = diagonal(0.0025, 0.01, 1e-4);
  const Matrix6d R = diagonal(1e-6, 1e-4, 1e-8);
  const Measurement here = measurementAt(vector6(2.0, 0, 0, 0, 0, 0), R);
  const Measurement apart = measurementAt(vector6(2.25, 0, 0, 0, 0, 0), R);
  const Measurement turned = measurementAt(vector6(2.0, 0, 0, 0, 0, 0.02), R);
  for (const std::vector<Measurement>& m : {std::vector<Measurement>{here}, {here, apart}, {here, turned}}) {
    const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf(m));
    EXPECT_FALSE(r.has_measurement);
    EXPECT_TRUE(r.all_gated_out);
    EXPECT_FALSE(r.prediction_overruled);
    EXPECT_TRUE(r.z.isZero());
    EXPECT_TRUE(r.R.isApprox(P));
    for (const double w : r.weights) EXPECT_EQ(w, 0.0);
  }
}

TEST(MeasurementFusion, OneInsideTheGateIsUsed) {
  const Matrix6d P = diagonal(0.0025, 0.01, 1e-4);
  const Matrix6d R = diagonal(1e-4, 1e-4, 1e-6);
  const Measurement inside = measurementAt(vector6(0.01, 0, 0, 0, 0, 0), R);
  const Measurement outside = measurementAt(vector6(2, 0, 0, 0, 0, 0), R);
  const FusionResult r = defaultFusion().fuse(Vector6d::Zero(), P, inputsOf({outside, inside, outside}));
  EXPECT_TRUE(r.has_measurement);
  EXPECT_FALSE(r.all_gated_out);
  EXPECT_NEAR(r.z[0], 0.01, 1e-12);
  EXPECT_TRUE(r.R.isApprox(R, 1e-12));
  EXPECT_NEAR(r.disagreement_m, 1.99, 1e-12);
}

TEST(MeasurementFusion, AbsentAndUnusableInputs) {
  const Matrix6d good = diagonal(0.01, 0.01, 0.01);
  Measurement failed = measurementAt(Vector6d::Zero(), good);
  failed.status = MeasurementStatus::kDegenerate;
  Measurement nan_pose = measurementAt(Vector6d::Zero(), good);
  nan_pose.T_odom_cog.translation().x() = kNan;
  Measurement nan_covariance = measurementAt(Vector6d::Zero(), good);
  nan_covariance.covariance(2, 3) = kNan;
  Measurement indefinite = measurementAt(Vector6d::Zero(), good);
  indefinite.covariance(0, 1) = indefinite.covariance(1, 0) = 0.02;
  const Measurement locked = measurementAt(vector6(0, 0, 0, 0, M_PI / 2, 0), good);
  const Measurement far_below = measurementAt(vector6(0, 0, -1.01 * kFarthestOff_m, 0, 0, 0), good);  // no gate there
  const Measurement ok = measurementAt(vector6(0.1, 0, 0, 0, 0, 0), good);

  std::vector<FusionInput> inputs = {
      {"absent", nullptr},         {"failed", &failed}, {"nan_pose", &nan_pose}, {"nan_covariance", &nan_covariance},
      {"indefinite", &indefinite}, {"locked", &locked}, {"far", &far_below}};
  const FusionResult none = defaultFusion().fuse(Vector6d::Zero(), good, inputs);
  EXPECT_FALSE(none.has_measurement);
  EXPECT_FALSE(none.all_gated_out);
  EXPECT_EQ(none.invalid_inputs, 5);
  EXPECT_EQ(none.valid_inputs, 0);
  for (const double nis : none.nis) EXPECT_EQ(nis, -1.0);

  inputs.push_back({"ok", &ok});
  const FusionResult one = defaultFusion().fuse(Vector6d::Zero(), good, inputs);
  EXPECT_TRUE(one.has_measurement);
  EXPECT_EQ(one.valid_inputs, 1);
  EXPECT_NEAR(one.z[0], 0.1, 1e-12);

  EXPECT_FALSE(defaultFusion().fuse(Vector6d::Zero(), good, {}).has_measurement);
}

// --- partial measurements

/// Observes x, with a sigma of 0.1 m.
Measurement alongAt(double x_m) {
  Matrix6d C = kUnobservedVariance * Matrix6d::Identity();
  C(0, 0) = 0.01;
  return measurementAt(vector6(x_m, 0, 0, 0, 0, 0), C);
}

constexpr auto kPartial = FusionInput::Kind::kPartial;

TEST(MeasurementFusionPartial, AddsWhatItObserves) {
  Matrix6d open = diagonal(1e-4, 1e-4, 1e-6);
  open(0, 0) = 1.0;
  const Measurement a = measurementAt(vector6(0.0, 0.02, 0, 0, 0, 0), open), along = alongAt(0.5);
  const Matrix6d P = diagonal(1.0, 0.01, 0.01);
  const FusionResult without = defaultFusion().fuse(Vector6d::Zero(), P, {{"a", &a}, {"b", &a}});
  const FusionResult with =
      defaultFusion().fuse(Vector6d::Zero(), P, {{"a", &a}, {"b", &a}, {"along", &along, kPartial}});
  EXPECT_NEAR(with.z[0], 0.5 / 1.01, 1e-6);
  EXPECT_NEAR(with.R(0, 0), 0.01 / 1.01, 1e-6);
  EXPECT_NEAR(with.z[1], without.z[1], 1e-6);
  EXPECT_NEAR(with.R(1, 1), without.R(1, 1), 1e-9);  // it does not dilute what the others observe
  EXPECT_GT(with.weights[2], 0.0);
}

TEST(MeasurementFusionMotion, CorrectsThePredictionAndIsNoPlace) {
  const Matrix6d P = diagonal(0.01, 0.01, 1e-3), Q = diagonal(0.0025, 0.0025, 1e-4);
  const Measurement pose = measurementAt(Vector6d::Zero(), diagonal(0.01, 1e-4, 1e-6));
  const Measurement along =
      measurementAt(0.05 * Vector6d::Unit(0), vector6(1e-4, 1e4, 1e4, 1e4, 1e4, 1e4).asDiagonal());
  const std::vector<FusionInput> inputs = {{"pose", &pose}, {"along", &along, FusionInput::Kind::kMotion}};
  const FusionResult motion = defaultFusion().fuseMotion(Vector6d::Zero(), Q, inputs);
  ASSERT_TRUE(motion.motion);
  EXPECT_NEAR(motion.motion->z[0], 0.05, 1e-6);
  EXPECT_NEAR(motion.motion->R(0, 0), 1e-4, 1e-8);
  const FusionResult fused = defaultFusion().fuse(Vector6d::Zero(), P, inputs, motion);
  EXPECT_NEAR(fused.R(0, 0), 0.01, 1e-9);
  EXPECT_GT(fused.weights[0], 0.0);
  EXPECT_EQ(fused.weights[1], motion.weights[1]);
  EXPECT_GT(fused.weights[1], 0.0);
}

TEST(MeasurementFusionMotion, BeyondItsGateIsNotUsed) {
  const Matrix6d Q = diagonal(1e-4, 1e-4, 1e-4);
  const Measurement along = measurementAt(0.5 * Vector6d::Unit(0), vector6(1e-4, 1e4, 1e4, 1e4, 1e4, 1e4).asDiagonal());
  const FusionResult motion =
      defaultFusion().fuseMotion(Vector6d::Zero(), Q, {{"along", &along, FusionInput::Kind::kMotion}});
  EXPECT_FALSE(motion.motion);
  EXPECT_EQ(motion.weights[0], 0.0);
  EXPECT_GT(motion.nis[0], 9.0);
}

TEST(MeasurementFusionPartial, IsNoAgreementAndNoDisagreement) {
  const Matrix6d good = diagonal(1e-4, 1e-4, 1e-6);
  const Measurement a = measurementAt(Vector6d::Zero(), good), along = alongAt(0.25);
  const FusionResult r =
      defaultFusion().fuse(Vector6d::Zero(), diagonal(0.1, 0.1, 0.1), {{"a", &a}, {"along", &along, kPartial}});
  EXPECT_FALSE(r.confirmed);
  EXPECT_EQ(r.disagreement_m, 0.0);
}

TEST(MeasurementFusionPartial, AloneIsNoMeasurement) {
  const Measurement along = alongAt(0.1);
  EXPECT_FALSE(
      defaultFusion().fuse(Vector6d::Zero(), diagonal(0.1, 0.1, 0.1), {{"along", &along, kPartial}}).has_measurement);
}

TEST(MeasurementFusionPartial, OutsideItsGateIsLeftOut) {
  const Matrix6d good = diagonal(1e-4, 1e-4, 1e-6);
  const Measurement a = measurementAt(Vector6d::Zero(), good);
  for (const auto& [x_m, used] : {std::pair{0.29, true}, std::pair{0.35, false}}) {
    const Measurement along = alongAt(x_m);
    const FusionResult r =
        defaultFusion().fuse(Vector6d::Zero(), diagonal(1e-6, 0.1, 0.1), {{"a", &a}, {"along", &along, kPartial}});
    EXPECT_EQ(r.weights[1] > 0.0, used) << x_m;
    EXPECT_EQ(r.z[0] > 0.0, used) << x_m;
  }
}

TEST(MeasurementFusion, AnUnusablePredictionGivesNoMeasurement) {
  const Matrix6d good = diagonal(0.01, 0.01, 0.01);
  Matrix6d bad = good;
  bad(0, 0) = kNan;
  const std::vector<Measurement> m = {measurementAt(Vector6d::Zero(), good)};
  for (const FusionResult& r : {defaultFusion().fuse(Vector6d::Zero(), bad, inputsOf(m)),
                                literalFusion().fuse(Vector6d::Constant(kNan), good, inputsOf(m))}) {
    EXPECT_TRUE(r.prediction_invalid);
    EXPECT_FALSE(r.has_measurement);
    EXPECT_TRUE(r.z.allFinite() && r.R.allFinite());
    EXPECT_EQ(r.weights.size(), 1u);
  }
}

TEST(MeasurementFusion, NeverNanAndAlwaysACovariance) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-4.0, 3.0);
  std::uniform_int_distribution<int> odd(0, 19);
  using Limits = std::numeric_limits<double>;
  const double strange[] = {kNan, Limits::infinity(), 0.0, Limits::max(), -1.0};
  int fused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<Measurement> m;
    for (int i = 0; i < 3; ++i) {
      const Matrix6d Q = randomOrthogonal(random);
      const Vector6d s = Vector6d::NullaryExpr([&]() { return std::pow(10.0, exponent(random)); });
      const Matrix6d half = Q * s.asDiagonal();
      const Vector6d state = Vector6d::NullaryExpr([&]() { return 0.3 * normal(random); });
      m.push_back(measurementAt(state, half * half.transpose()));
      if (odd(random) == 0) m.back().covariance(odd(random) % 6, odd(random) % 6) = strange[odd(random) % 5];
      if (odd(random) == 0) m.back().covariance(2, 2) = std::numeric_limits<double>::max();
      if (odd(random) == 0) m.back().T_odom_cog.translation()[odd(random) % 3] = strange[odd(random) % 5];
    }
    Matrix6d P = diagonal(0.1, 0.1, 0.1);
    if (odd(random) == 0) P(odd(random) % 6, odd(random) % 6) = strange[odd(random) % 5];
    for (const MeasurementFusion& fusion : {literalFusion(), defaultFusion()}) {
      const FusionResult r = fusion.fuse(Vector6d::Zero(), P, inputsOf(m));
      ASSERT_TRUE(r.z.allFinite() && r.R.allFinite());
      for (const double nis : r.nis) ASSERT_TRUE(nis == -1.0 || (std::isfinite(nis) && nis >= 0.0));
      for (const double w : r.weights) ASSERT_TRUE(w >= 0.0 && w <= 1.0);
      ASSERT_TRUE(std::isfinite(r.disagreement_m) && std::isfinite(r.disagreement_yaw_rad));
      if (!r.has_measurement) continue;
      ++fused;
      ASSERT_TRUE(r.R.isApprox(r.R.transpose(), 1e-12));
      const Vector6d scale = r.R.diagonal().cwiseSqrt().cwiseInverse();
      const Matrix6d correlation = scale.asDiagonal() * r.R * scale.asDiagonal();
      ASSERT_GT(symmetricEigenvalues(correlation)[0], -1e-12);
    }
  }
  EXPECT_GT(fused, 1500);
}

TEST(MeasurementFusion, ParametersAreChecked) {
  MeasurementFusion params;
  params.gate_sigma = 0.0;
  EXPECT_THROW(validate(params), ParameterError);
  params = MeasurementFusion();
  params.min_weight = 1.0;
  EXPECT_THROW(validate(params), ParameterError);
  params = MeasurementFusion();
  params.agreement_distance_m = kNan;
  EXPECT_THROW(validate(params), ParameterError);
}

}  // namespace
}  // namespace fail_aware::measurement_fusion_test
