#include "simulation/fault.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parameters/check.hpp"

namespace fail_aware::fault_test {
namespace {

TEST(Fault, EveryKindParsesWithItsDefaults) {
  for (const FaultTraits& traits : faultTraits()) {
    const Fault fault = Fault::parse(traits.name);
    EXPECT_EQ(fault.kind, traits.kind);
    EXPECT_EQ(fault.start_s, 10.0);
    EXPECT_EQ(fault.duration_s, traits.duration_s);
    EXPECT_EQ(fault.severity, traits.severity);
    EXPECT_NE(faultHelp().find(traits.name), std::string::npos);
  }
}

TEST(Fault, PartsOfTheText) {
  const Fault fault = Fault::parse("range_cap:3.5:2:25");
  EXPECT_EQ(fault.start_s, 3.5);
  EXPECT_EQ(fault.duration_s, 2.0);
  EXPECT_EQ(fault.severity, 25.0);
  EXPECT_FALSE(fault.active(3.4));
  EXPECT_TRUE(fault.active(3.5));
  EXPECT_TRUE(fault.active(5.4));
  EXPECT_FALSE(fault.active(5.5));
  EXPECT_TRUE(std::isinf(Fault::parse("noise:1:inf").duration_s));
  EXPECT_EQ(Fault::parse("stamp_jump:1::-3").severity, -3.0);
  EXPECT_TRUE(std::isinf(Fault::parse("stamp_jump:1:0:-3").duration_s));
}

TEST(Fault, RefusesNonsense) {
  for (const char* text : {"", "fog", "noise:x", "noise:1:x", "noise:1:2:x", "noise:-1", "noise:1:-2", "noise:1:2:-0.1",
                           "noise:1:2:3:4", "noise:nan", "noise:inf", "lost_rings:1:1:1.5", "range_cap:1:1:nan"}) {
    EXPECT_THROW(Fault::parse(text), ParameterError) << text;
  }
}

TEST(Fault, VehiclesAroundOnlyInTheirTime) {
  const std::vector<Fault> faults = {Fault::parse("dense_traffic:2:3:8"), Fault::parse("noise:0:9")};
  EXPECT_EQ(vehiclesAround(faults, 1.0), 0);
  EXPECT_EQ(vehiclesAround(faults, 2.0), 8);
  EXPECT_EQ(vehiclesAround(faults, 5.0), 0);
}

}  // namespace
}  // namespace fail_aware::fault_test
