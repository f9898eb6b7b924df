#include "evaluation/kaplan_meier.hpp"

#include <gtest/gtest.h>

namespace fail_aware::kaplan_meier_test {
namespace {

TEST(KaplanMeier, WithoutCensoringItIsTheOrdinaryQuantile) {
  const std::vector<CensoredValue> values = {{4.0, true}, {1.0, true}, {3.0, true}, {2.0, true}};
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile(values, 0.25).value(), 1.0);
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile(values, 0.5).value(), 2.0);
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile(values, 1.0).value(), 4.0);
}

TEST(KaplanMeier, TheTextbooksProduct) {
  // S: 6 -> 6/7, 7 (after the loss at 6.5) -> 6/7 * 4/5, 10 -> * 2/3 (loss at 9); losses move the median from 7 to 10
  const std::vector<CensoredValue> values = {{6.0, true},  {6.5, false},  {7.0, true},  {9.0, false},
                                             {10.0, true}, {11.0, false}, {12.0, false}};
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile(values, 0.31).value(), 7.0);   // 1 - 24/35 = 0.314
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile(values, 0.32).value(), 10.0);  // 1 - 48/105 = 0.543
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile(values, 0.54).value(), 10.0);
  EXPECT_FALSE(kaplanMeierQuantile(values, 0.55));
}

TEST(KaplanMeier, CensoredWhereAnotherFailedWasAtRiskThere) {
  EXPECT_DOUBLE_EQ(kaplanMeierQuantile({{2.0, false}, {2.0, true}}, 0.5).value(), 2.0);
  EXPECT_FALSE(kaplanMeierQuantile({{2.0, false}, {2.0, true}}, 0.6));
  EXPECT_FALSE(kaplanMeierQuantile({}, 0.5));
}

}  // namespace
}  // namespace fail_aware::kaplan_meier_test
