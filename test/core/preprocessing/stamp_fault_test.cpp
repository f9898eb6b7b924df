#include "core/preprocessing/stamp_fault.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fail_aware::stamp_fault_test {
namespace {

TimingResult azimuthTiming(StampReference reference) {
  TimingResult timing;
  timing.source = TimingSource::kAzimuth;
  timing.reference = reference;
  timing.period_s = 0.05;
  timing.period_known = true;
  return timing;
}

TEST(StampFault, AnAssumedEndThatIsAPeriodOldIsDoubted) {
  const TimingResult timing = azimuthTiming(StampReference::kEnd);
  const std::string said = stampFault({}, timing, 0.055);
  EXPECT_NE(said.find("stamp_reference to start"), std::string::npos) << said;
  for (const double age_s : {0.0, 0.02, 0.044, 0.09, -0.05, std::nan("")}) {
    EXPECT_EQ(stampFault({}, timing, age_s), "") << age_s;
  }
}

TEST(StampFault, WhatTheParameterSaysIsBelieved) {
  SweepTimingParams params;
  params.stamp_reference = "end";
  EXPECT_EQ(stampFault(params, azimuthTiming(StampReference::kEnd), 0.055), "");
  params.stamp_reference = "start";
  EXPECT_EQ(stampFault(params, azimuthTiming(StampReference::kStart), 0.055), "");
}

TEST(StampFault, AFieldAgainstTheParameterIsNamed) {
  SweepTimingParams params;
  TimingResult timing = azimuthTiming(StampReference::kEnd);
  timing.source = TimingSource::kField;
  timing.field_reference = StampReference::kStart;
  params.stamp_reference = "end";
  const std::string said = stampFault(params, timing, 0.01);
  EXPECT_NE(said.find("the sweep's start"), std::string::npos) << said;
  EXPECT_NE(said.find("says end"), std::string::npos) << said;
  timing.field_reference = StampReference::kEnd;
  EXPECT_EQ(stampFault(params, timing, 0.01), "");
  params.stamp_reference = "auto";
  EXPECT_EQ(stampFault(params, timing, 0.06), "") << "times of a field need no assumption";
}

}  // namespace
}  // namespace fail_aware::stamp_fault_test
