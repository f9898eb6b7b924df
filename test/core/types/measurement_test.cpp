#include "core/types/measurement.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fail_aware::measurement_test {
namespace {

TEST(Measurement, EveryStatusHasItsOwnName) {
  std::set<std::string> names;
  for (const MeasurementStatus status :
       {MeasurementStatus::kOk, MeasurementStatus::kNoReference, MeasurementStatus::kTooFewPoints,
        MeasurementStatus::kNotConverged, MeasurementStatus::kDegenerate, MeasurementStatus::kTooFewCorners}) {
    names.insert(toString(status));
  }
  EXPECT_EQ(names.size(), 6u);
  EXPECT_EQ(names.count("unknown"), 0u);
  EXPECT_STREQ(toString(static_cast<MeasurementStatus>(99)), "unknown");
}

TEST(Measurement, IsNotUsableUntilSomethingSaysSo) {
  Measurement measurement;
  EXPECT_FALSE(measurement.ok());
  EXPECT_TRUE(isFinite(measurement.T_odom_cog));
  for (const MeasurementStatus status : {MeasurementStatus::kNotConverged, MeasurementStatus::kDegenerate,
                                         MeasurementStatus::kTooFewPoints, MeasurementStatus::kTooFewCorners}) {
    measurement.status = status;
    EXPECT_FALSE(measurement.ok());
  }
  measurement.status = MeasurementStatus::kOk;
  EXPECT_TRUE(measurement.ok());
}

}  // namespace
}  // namespace fail_aware::measurement_test
