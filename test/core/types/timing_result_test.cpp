#include "core/types/timing_result.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace fail_aware::timing_result_test {
namespace {

TEST(TimingResult, EveryValueHasItsOwnName) {
  std::set<std::string> names;
  const auto add = [&](const auto value) { names.insert(toString(value)); };
  for (const TimingSource source :
       {TimingSource::kNone, TimingSource::kField, TimingSource::kAzimuth, TimingSource::kHeld}) {
    add(source);
  }
  for (const StampReference reference : {StampReference::kStart, StampReference::kMid, StampReference::kEnd}) {
    add(reference);
  }
  for (const TimeField field : {TimeField::kNotRead, TimeField::kUsed, TimeField::kAbsent, TimeField::kNotFinite,
                                TimeField::kNoSpread, TimeField::kBadScale, TimeField::kBackward}) {
    add(field);
  }
  EXPECT_EQ(names.size(), 14u);
  EXPECT_EQ(names.count("unknown"), 0u);
}

TEST(TimingResult, IsAGuessWhereTheFieldIsRefusedAndNothingWasHeld) {
  TimingResult timing;
  EXPECT_FALSE(timing.guessed());
  timing.refusal = "time in no unit";
  timing.source = TimingSource::kAzimuth;
  EXPECT_TRUE(timing.guessed());
  timing.source = TimingSource::kHeld;
  EXPECT_FALSE(timing.guessed());
}

}  // namespace
}  // namespace fail_aware::timing_result_test
