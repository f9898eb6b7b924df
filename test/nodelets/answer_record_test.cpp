#include "../../src/nodelets/answer_record.hpp"

#include <gtest/gtest.h>

namespace fail_aware {
namespace {

TEST(AnswerRecord, SilentAfterMissesInARowUntilHeardAgain) {
  AnswerRecord record;
  EXPECT_TRUE(record.isAtWork()) << "nothing is known against it";
  record.miss();
  EXPECT_FALSE(record.isAtWork());
  EXPECT_FALSE(record.isSilent(2));
  record.miss();
  EXPECT_TRUE(record.isSilent(2));
  record.inTime();
  EXPECT_FALSE(record.isSilent(1));
}

TEST(AnswerRecord, WhoAnswersLateIsAtWorkAndLateUntilInTimeAgain) {
  AnswerRecord record;
  record.miss();
  record.late();
  EXPECT_TRUE(record.isAtWork());
  EXPECT_TRUE(record.isLate());
  record.miss();
  EXPECT_TRUE(record.isLate()) << "still the last that was heard";
  record.inTime();
  EXPECT_FALSE(record.isLate());
}

}  // namespace
}  // namespace fail_aware
