#include "../../src/nodelets/source_health.hpp"

#include <gtest/gtest.h>

namespace fail_aware::source_health_test {
namespace {

TEST(SourceHealth, SilentAfterMissesInARowUntilHeardAgain) {
  SourceHealth record;
  EXPECT_TRUE(record.isAtWork()) << "nothing is known against it";
  record.miss();
  EXPECT_FALSE(record.isAtWork());
  EXPECT_FALSE(record.isSilent(2));
  record.miss();
  EXPECT_TRUE(record.isSilent(2));
  record.inTime();
  EXPECT_FALSE(record.isSilent(1));
}

TEST(SourceHealth, WhoAnswersLateIsAtWorkAndLateUntilInTimeAgain) {
  SourceHealth record;
  record.miss();
  record.late(false);
  EXPECT_TRUE(record.isAtWork());
  EXPECT_TRUE(record.isLate());
  record.miss();
  EXPECT_TRUE(record.isLate()) << "still the last that was heard";
  record.inTime();
  EXPECT_FALSE(record.isLate());
}

TEST(SourceHealth, TooLateAfterAnswersInVainInARowUntilOneIsNot) {
  SourceHealth record;
  const auto answerInVain = [&](int times) {
    for (int i = 0; i < times; ++i) {
      record.miss();
      record.late(true);
    }
  };
  answerInVain(2);
  EXPECT_FALSE(record.isTooLate(3));
  answerInVain(1);
  EXPECT_TRUE(record.isTooLate(3));
  EXPECT_FALSE(record.isSilent(1)) << "it speaks";
  record.late(false);
  EXPECT_FALSE(record.isTooLate(3)) << "the next may come in time";
  EXPECT_TRUE(record.isLate());
  answerInVain(2);
  record.inTime();
  answerInVain(2);
  EXPECT_FALSE(record.isTooLate(3));
}

}  // namespace
}  // namespace fail_aware::source_health_test
