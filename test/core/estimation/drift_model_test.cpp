#include "core/estimation/drift_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "../../support/independent_drift.hpp"
#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::drift_model_test {
namespace {

Matrix6d diagonal(double position, double rotation) {
  Vector6d d;
  d << position, position, position, rotation, rotation, rotation;
  return d.asDiagonal();
}

TEST(DriftModel, IndependentErrorsReplaceTheMapEachSweep) {
  const DriftModel model(independentDrift());
  EXPECT_EQ(model.mapReplaced(0.0), 1.0);
  EXPECT_EQ(model.registration_ratio, 1.0);
  EXPECT_TRUE(model.walkVariances(12.0).isZero());
  EXPECT_TRUE(model.transient(diagonal(1e-4, 1e-7)).isZero());
  EXPECT_TRUE(model.biasVariances().isZero());
}

TEST(DriftModel, TheWayReplacesTheMap) {
  DriftModel params;
  params.map_length_m = 50.0;
  const DriftModel model(params);
  EXPECT_EQ(model.mapReplaced(0.0), 0.0) << "standing still";
  EXPECT_NEAR(model.mapReplaced(2.0), 0.04, 1e-12);
  EXPECT_EQ(model.mapReplaced(80.0), 1.0);
}

TEST(DriftModel, AShortViewIsComparedWithAShortMap) {
  DriftModel params;
  params.map_length_m = 50.0;
  const DriftModel model(params);
  EXPECT_EQ(model.mapReplaced(2.0, 80.0), model.mapReplaced(2.0)) << "a usual view";
  EXPECT_GT(model.mapReplaced(2.0, 10.0), 3.0 * model.mapReplaced(2.0)) << "fog";
  EXPECT_EQ(model.mapReplaced(0.0, 10.0), 0.0) << "standing still";
  EXPECT_EQ(DriftModel(independentDrift()).mapReplaced(2.0, 10.0), 1.0);
}

TEST(DriftModel, WalksGrowWithTheRootOfTheWay) {
  DriftModel params;
  params.position_per_root_metre_m = 0.01;
  params.tilt_per_root_metre_deg = 0.03;
  params.heading_per_root_metre_deg = 0.02;
  params.transient_ratio = 0.6;
  params.transient_rotation_ratio = 0.1;
  const DriftModel model(params);
  const Vector6d walk = model.walkVariances(4.0);
  EXPECT_NEAR(walk[0], 4.0 * 1e-4, 1e-15);
  EXPECT_NEAR(walk[3], 4.0 * std::pow(0.03 * kDegree, 2), 1e-15);
  EXPECT_NEAR(walk[5], 4.0 * std::pow(0.02 * kDegree, 2), 1e-15);
  const Matrix6d transient = model.transient(diagonal(4e-4, 4e-6));
  EXPECT_NEAR(transient(1, 1), 0.6 * 4e-4, 1e-15);
  EXPECT_NEAR(transient(5, 5), 0.1 * 4e-6, 1e-15);
}

TEST(DriftModel, BiasesAreGivenAsStandardDeviations) {
  DriftModel params;
  params.heading_bias_deg_per_m = 0.001;
  params.scale_bias = 0.002;
  const DriftModel model(params);
  EXPECT_NEAR(model.biasVariances()[0], std::pow(0.001 * kDegree, 2), 1e-20);
  EXPECT_NEAR(model.biasVariances()[1], 4e-6, 1e-18);
}

TEST(DriftModel, ParametersAreChecked) {
  const auto refused = [](const std::function<void(DriftModel&)>& change) {
    DriftModel params;
    change(params);
    EXPECT_THROW(validate(params), ParameterError);
  };
  EXPECT_NO_THROW(validate(DriftModel()));
  refused([](DriftModel& p) { p.map_length_m = -1.0; });
  refused([](DriftModel& p) { p.registration_ratio = -0.1; });
  refused([](DriftModel& p) { p.position_per_root_metre_m = -1.0; });
  refused([](DriftModel& p) { p.tilt_per_root_metre_deg = -1.0; });
  refused([](DriftModel& p) { p.heading_per_root_metre_deg = std::numeric_limits<double>::quiet_NaN(); });
  refused([](DriftModel& p) { p.heading_bias_deg_per_m = -1.0; });
  refused([](DriftModel& p) { p.scale_bias = -1.0; });
}

}  // namespace
}  // namespace fail_aware::drift_model_test
