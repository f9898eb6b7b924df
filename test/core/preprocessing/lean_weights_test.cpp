#include "core/preprocessing/lean_weights.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "core/geometry/degree.hpp"

namespace fail_aware::lean_weights_test {
namespace {

/// Profiles along y, 10 m ahead, each with a lean of its own, as seen from an upright sensor without errors.
class Scenery {
 public:
  Scenery() : x_(Eigen::VectorXd::Zero(VerticalState::kBeams + kBeams)) {}

  void add(UprightProfile::Kind kind, float top_m, double lean_deg) {
    UprightProfile profile{kind, Eigen::Vector2d::UnitY(), Eigen::Vector2d::UnitX(), beams_.size(), kBeams, top_m};
    for (int beam = 0; beam < kBeams; ++beam) {
      const float height_m = top_m - 0.15f * static_cast<float>(kBeams - 1 - beam);
      const auto offset_m = static_cast<float>(lean_deg * kDegree) * height_m;
      beams_.push_back({static_cast<std::uint16_t>(beam), 20.0f, offset_m, height_m, 0.0f});
    }
    profiles_.push_back(profile);
  }

  LeanWeights weights(const Eigen::MatrixXd* P_predicted = nullptr) const {
    const Eigen::MatrixXd P = Eigen::MatrixXd::Zero(x_.size(), x_.size());
    std::vector<ProfileEquations> equations;
    for (const UprightProfile& profile : profiles_) {
      equations.emplace_back(profile, beams_, std::vector<BeamRange>(), P);
    }
    return leanWeights(profiles_, equations, x_, P_predicted);
  }

  Eigen::MatrixXd unsure() const { return 0.01 * Eigen::MatrixXd::Identity(x_.size(), x_.size()); }

 private:
  static constexpr int kBeams = 8;
  Eigen::VectorXd x_;
  std::vector<UprightProfile> profiles_;
  std::vector<UprightProfile::Beam> beams_;
};

constexpr auto kSurface = UprightProfile::Kind::kSurface;
constexpr float kHigh_m = 0.6f, kLow_m = -0.2f;

TEST(LeanWeights, WhatStandsUprightCountsInFull) {
  Scenery town;
  for (int wall = 0; wall < 8; ++wall) town.add(kSurface, kHigh_m, 0.05 * (wall - 3.5));
  for (const double weight : town.weights().lean) EXPECT_GT(weight, 0.7);
}

TEST(LeanWeights, HedgesTakeNothingFromWalls) {
  Scenery town;
  for (int wall = 0; wall < 8; ++wall) town.add(kSurface, kHigh_m, 0.05 * (wall - 3.5));
  const std::vector<double> alone = town.weights().lean;
  for (int hedge = 0; hedge < 20; ++hedge) town.add(kSurface, kLow_m, 0.35 + 0.02 * hedge);
  const std::vector<double> beside = town.weights().lean;
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_DOUBLE_EQ(beside[i], alone[i]);
}

TEST(LeanWeights, AFewThatAgreeByChanceCountLittle) {
  Scenery hedges;
  hedges.add(kSurface, kLow_m, 0.0);
  hedges.add(kSurface, kLow_m, 0.05);
  for (int hedge = 0; hedge < 18; ++hedge) hedges.add(kSurface, kLow_m, 3.0 + 0.5 * hedge);
  const LeanWeights weights = hedges.weights();
  EXPECT_GT(weights.kernel[0], 0.9);
  EXPECT_LT(weights.lean[0], 0.01);
}

TEST(LeanWeights, WhatEndsBelowTheSensorWaitsForTheRest) {
  Scenery scenery;
  for (int pole = 0; pole < 3; ++pole) {
    scenery.add(UprightProfile::Kind::kLineAcross, kHigh_m, 0.1);
    scenery.add(UprightProfile::Kind::kLineAway, kHigh_m, 0.1);
  }
  for (int hedge = 0; hedge < 10; ++hedge) scenery.add(kSurface, kLow_m, 4.0);
  const Eigen::MatrixXd P = scenery.unsure();
  const LeanWeights predicted = scenery.weights(&P);
  EXPECT_GT(predicted.lean[0], 0.5);
  EXPECT_EQ(predicted.lean[6], 0.0);
  EXPECT_GT(predicted.kernel[6], 0.1) << "its straightness counts";
}

TEST(LeanWeights, WhatEndsBelowTheSensorCountsWhereItIsAll) {
  Scenery barriers;
  for (int barrier = 0; barrier < 10; ++barrier) barriers.add(kSurface, kLow_m, 0.1);
  const Eigen::MatrixXd P = barriers.unsure();
  for (const double weight : barriers.weights(&P).lean) EXPECT_GT(weight, 0.7);
}

}  // namespace
}  // namespace fail_aware::lean_weights_test
