#include "core/estimation/drift_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {
namespace {

Matrix6d diagonal(double position, double rotation) {
  Vector6d d;
  d << position, position, position, rotation, rotation, rotation;
  return d.asDiagonal();
}

TEST(DriftModel, IndependentErrorsStayAsAWhole) {
  const DriftModel model(DriftModel::Params::independent());
  const Matrix6d C = diagonal(1e-4, 1e-7), U = diagonal(3e-5, 2e-8);
  EXPECT_TRUE(model.accumulated(C, U, 12.0).isApprox(C, 1e-12));
  EXPECT_TRUE(model.transient(C, U).isZero());
  EXPECT_TRUE(model.biasVariances().isZero());
}

TEST(DriftModel, WhatIsObservedPassesAndTheRoadLeavesItsMark) {
  DriftModel::Params params;
  params.measured_ratio = 0.25;
  params.unobserved_ratio = 1.0;
  params.position_per_root_metre_m = 0.01;
  params.tilt_per_root_metre_deg = 0.03;
  params.heading_per_root_metre_deg = 0.02;
  params.transient_ratio = 0.6;
  params.transient_rotation_ratio = 0.1;
  const DriftModel model(params);
  const Matrix6d C = diagonal(5e-4, 5e-6), U = diagonal(1e-4, 1e-6);
  const Matrix6d accumulated = model.accumulated(C, U, 4.0);
  EXPECT_NEAR(accumulated(0, 0), 1e-4 + 0.25 * 4e-4 + 4.0 * 1e-4, 1e-15);
  EXPECT_NEAR(accumulated(3, 3), 1e-6 + 0.25 * 4e-6 + 4.0 * std::pow(0.03 * kDegree, 2), 1e-15);
  EXPECT_NEAR(accumulated(5, 5), 1e-6 + 0.25 * 4e-6 + 4.0 * std::pow(0.02 * kDegree, 2), 1e-15);
  EXPECT_NEAR(model.transient(C, U)(1, 1), 0.6 * 0.5 * 0.75 * 4e-4, 1e-15);
  EXPECT_NEAR(model.transient(C, U)(5, 5), 0.1 * 0.5 * 0.75 * 4e-6, 1e-15);
  EXPECT_NEAR(model.accumulated(C, Matrix6d::Zero(), 0.0)(5, 5), 0.25 * 5e-6, 1e-15)
      << "standing still there is no drift";
}

// One blinded sweep on a road must not leave the jitter of its measurement in the pose for good.
TEST(DriftModel, TheJitterPassesHoweverLittleIsObserved) {
  DriftModel::Params params;
  params.measured_ratio = 0.01;
  params.unobserved_ratio = 1.0;
  params.position_per_root_metre_m = params.tilt_per_root_metre_deg = params.heading_per_root_metre_deg = 0.0;
  params.transient_ratio = params.transient_rotation_ratio = 1.0;
  const DriftModel model(params);
  const Matrix6d C = diagonal(4e-4, 4e-6);
  for (const double u : {0.2, 0.8, 1.0}) {
    const Matrix6d U = diagonal(u * 4e-4, 1e-6);
    EXPECT_NEAR(model.accumulated(C, U, 5.0)(5, 5), 1e-6 + 0.01 * 3e-6, 1e-15) << u;
    EXPECT_NEAR(model.transient(C, U)(5, 5), 0.5 * 0.99 * 3e-6, 1e-15) << u;
  }
}

TEST(DriftModel, WhatStaysOpenAddsUpInPartWhereTheRoadIsObserved) {
  DriftModel::Params params;
  params.measured_ratio = 0.0;
  params.unobserved_ratio = 0.6;
  params.heading_per_root_metre_deg = 0.0;
  const DriftModel model(params);
  const Matrix6d C = diagonal(4e-4, 4e-6);
  const auto kept = [&](double u) {
    const Matrix6d U = diagonal(u * 4e-4, 1e-6);
    return model.accumulated(C, U, 5.0)(5, 5) / 1e-6;
  };
  EXPECT_NEAR(kept(1e-6), 0.6, 1e-6);
  EXPECT_NEAR(kept(0.2), 0.6 + 0.4 * 0.25, 1e-9);
  EXPECT_NEAR(kept(0.4), 1.0, 1e-9);
  EXPECT_NEAR(kept(0.8), 1.0, 1e-9);
}

TEST(DriftModel, BiasesAreGivenAsStandardDeviations) {
  DriftModel::Params params;
  params.heading_bias_deg_per_m = 0.001;
  params.scale_bias = 0.002;
  const DriftModel model(params);
  EXPECT_NEAR(model.biasVariances()[0], std::pow(0.001 * kDegree, 2), 1e-20);
  EXPECT_NEAR(model.biasVariances()[1], 4e-6, 1e-18);
}

TEST(DriftModel, FasterTheWalksGrowWithTheSpeed) {
  DriftModel::Params params;
  params.slow_mps = 10.0;
  params.heading_per_root_metre_deg = 0.02;
  const DriftModel model(params);
  EXPECT_EQ(model.pace(0.5, 0.1), 1.0);
  EXPECT_DOUBLE_EQ(model.pace(3.0, 0.1), 3.0);
  EXPECT_EQ(model.pace(30.0, 0.1), 5.0) << "stamps that are wrong";
  EXPECT_EQ(model.pace(3.0, 0.0), 1.0) << "no time given";
  const Matrix6d none = Matrix6d::Zero();
  EXPECT_NEAR(model.accumulated(none, none, 3.0, 3.0)(5, 5), 27.0 * std::pow(0.02 * kDegree, 2), 1e-15);
}

TEST(DriftModel, HowLittleOfTheSpeedIsObserved) {
  const DriftModel model{DriftModel::Params()};
  EXPECT_DOUBLE_EQ(model.unobservedAlong(diagonal(4.0, 1.0), diagonal(1.0, 1.0)), 0.25);
  EXPECT_EQ(model.unobservedAlong(diagonal(4.0, 1.0), diagonal(5.0, 1.0)), 1.0);
  EXPECT_EQ(model.unobservedAlong(Matrix6d::Zero(), Matrix6d::Zero()), 0.0);
}

TEST(DriftModel, ParametersAreChecked) {
  const auto refused = [](const std::function<void(DriftModel::Params&)>& change) {
    DriftModel::Params params;
    change(params);
    EXPECT_THROW(DriftModel{params}, ParameterError);
  };
  EXPECT_NO_THROW(DriftModel{DriftModel::Params()});
  refused([](DriftModel::Params& p) { p.measured_ratio = 1.1; });
  refused([](DriftModel::Params& p) { p.position_per_root_metre_m = -1.0; });
  refused([](DriftModel::Params& p) { p.tilt_per_root_metre_deg = -1.0; });
  refused([](DriftModel::Params& p) { p.heading_per_root_metre_deg = std::numeric_limits<double>::quiet_NaN(); });
  refused([](DriftModel::Params& p) { p.heading_bias_deg_per_m = -1.0; });
  refused([](DriftModel::Params& p) { p.scale_bias = -1.0; });
  refused([](DriftModel::Params& p) { p.slow_mps = 0.0; });
}

}  // namespace
}  // namespace fail_aware
