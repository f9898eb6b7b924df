#include "core/registration/beam_offsets.hpp"

#include <gtest/gtest.h>

namespace fail_aware::beam_offsets_test {
namespace {

constexpr double kSigma = 0.03;
const BeamOffsets::Params kParams = {kSigma, 0.002, 0.1, 0.0, 0.2};

/// Beams that are missed by `residual_m` at a sensitivity of 1, each by `points` points.
std::vector<BeamEvidence> evidenceOf(const std::vector<double>& residual_m, int points) {
  std::vector<BeamEvidence> evidence(residual_m.size());
  for (std::size_t ring = 0; ring < residual_m.size(); ++ring) {
    for (int i = 0; i < points; ++i) evidence[ring].add(1.0, 1.0, residual_m[ring], 10.0);
  }
  return evidence;
}

Eigen::VectorXd constant(const std::vector<BeamEvidence>& evidence) {
  return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(evidence.size()));
}

TEST(BeamOffsets, MovesByTheKalmanGain) {
  BeamOffsets offsets(kParams);
  const auto evidence = evidenceOf({0.02, -0.02}, 10);
  offsets.update(evidence, constant(evidence));
  const double gain = kSigma * kSigma / (kSigma * kSigma + 0.1 * 0.1 / 10);
  ASSERT_EQ(offsets.values().size(), 2u);
  EXPECT_NEAR(static_cast<double>(offsets.values()[0]), 0.02 * gain, 1e-7);
  EXPECT_NEAR(static_cast<double>(offsets.values()[1]), -0.02 * gain, 1e-7);
}

TEST(BeamOffsets, WhatThePatternsExplainIsNotSought) {
  BeamOffsets offsets(kParams);
  const auto evidence = evidenceOf({0.01, 0.03, 0.05, 0.07}, 10);
  Eigen::MatrixXd patterns(4, 2);
  patterns << 1, 0, 1, 1, 1, 2, 1, 3;
  offsets.update(evidence, patterns);
  for (const float value : offsets.values()) EXPECT_NEAR(static_cast<double>(value), 0.0, 1e-6);
}

TEST(BeamOffsets, AsManyPatternsAsBeamsTellNothing) {
  BeamOffsets offsets(kParams);
  auto evidence = evidenceOf({0.02, -0.02}, 10);
  evidence[1] = {};
  offsets.update(evidence, constant(evidence));
  EXPECT_EQ(offsets.values(), std::vector<float>({0.0f, 0.0f}));
}

TEST(BeamOffsets, StaysWithinTheLimit) {
  BeamOffsets offsets(kParams);
  const auto evidence = evidenceOf({2.0, -2.0}, 10000);
  offsets.update(evidence, constant(evidence));
  EXPECT_EQ(offsets.values(), std::vector<float>({0.2f, -0.2f}));
}

TEST(BeamOffsets, ForgetsAPartAtEachObservation) {
  BeamOffsets::Params params = kParams;
  params.forget = 0.5;
  BeamOffsets offsets(params);
  const auto first = evidenceOf({0.02, -0.02}, 100000), still = evidenceOf({0.0, 0.0}, 100000);
  offsets.update(first, constant(first));
  const double before = static_cast<double>(offsets.values()[0]);
  offsets.update(still, constant(still));
  EXPECT_LT(static_cast<double>(offsets.values()[0]), 0.9 * before);
  EXPECT_GT(static_cast<double>(offsets.values()[0]), 0.4 * before);
}

TEST(BeamOffsets, IsForgottenWithReset) {
  BeamOffsets offsets(kParams);
  const auto evidence = evidenceOf({0.02, -0.02}, 10);
  offsets.update(evidence, constant(evidence));
  offsets.reset();
  EXPECT_TRUE(offsets.values().empty());
}

}  // namespace
}  // namespace fail_aware::beam_offsets_test
