#include "core/registration/information_support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::information_support_test {
namespace {

InformationSupport::Params testParams() {
  InformationSupport::Params params;
  params.cell_m = 5.0;
  params.max_place_ratio = 0.2;
  return params;
}

Eigen::Vector3d place(int k) { return {5.0 * k + 1.0, -3.0, 0.0}; }

TEST(InformationSupport, AllCountsWhereItIsSpreadEvenly) {
  InformationSupport support(testParams());
  for (int k = 0; k < 5; ++k) {
    for (int i = 0; i < 10; ++i) support.add(place(k), 0.3);
  }
  EXPECT_NEAR(support.countedRatio(), 1.0, 1e-9);
}

TEST(InformationSupport, OnePlaceCountsForNoMoreThanItsRatio) {
  InformationSupport support(testParams());
  support.add(place(0), 1000.0);
  for (int k = 1; k < 9; ++k) support.add(place(k), 1.0);
  // 8 of the others, and at most a fifth of all that counts: 8 / 0.8
  EXPECT_NEAR(support.countedRatio(), 10.0 / 1008.0, 1e-9);
}

TEST(InformationSupport, TwoPlacesLikewise) {
  InformationSupport support(testParams());
  support.add(place(0), 500.0);
  support.add(place(1), 700.0);
  for (int k = 2; k < 14; ++k) support.add(place(k), 1.0);
  EXPECT_NEAR(support.countedRatio(), 12.0 / 0.6 / 1212.0, 1e-9);
}

TEST(InformationSupport, FewPlacesAreNoSupport) {
  InformationSupport support(testParams());
  EXPECT_EQ(support.countedRatio(), 0.0);
  for (int k = 0; k < 4; ++k) support.add(place(k), 1.0);
  EXPECT_EQ(support.countedRatio(), 0.0) << "a vehicle ahead lies in up to four cells";
}

TEST(InformationSupport, WhatErrorsOfTheNormalMakeDoesNotCount) {
  InformationSupport half(testParams()), none(testParams());
  for (int k = 0; k < 10; ++k) {
    half.add(place(k), 0.3, 0.15);
    none.add(place(k), 0.3, 0.4);
  }
  EXPECT_NEAR(half.countedRatio(), 0.5, 1e-9);
  EXPECT_EQ(none.countedRatio(), 0.0) << "less than by chance is nothing, and takes nothing from other places";
}

TEST(InformationSupport, FindsTheWeakestHorizontalDirection) {
  const Eigen::Vector2d along(std::cos(0.3), std::sin(0.3)), across(-along.y(), along.x());
  const Eigen::Matrix2d information = 0.01 * along * along.transpose() + across * across.transpose();
  const std::optional<Eigen::Vector2d> weakest = weakDirection(information, 1.0, 0.02);
  ASSERT_TRUE(weakest);
  EXPECT_NEAR(std::abs(weakest->dot(along)), 1.0, 1e-9);
  EXPECT_FALSE(weakDirection(information, 1.0, 0.005)) << "well observed";
}

TEST(InformationSupport, ParametersAreChecked) {
  InformationSupport::Params params;
  params.max_place_ratio = 0.0;
  EXPECT_THROW(validate(params), ParameterError);
}

}  // namespace
}  // namespace fail_aware::information_support_test
