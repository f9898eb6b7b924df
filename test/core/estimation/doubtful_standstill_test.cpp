#include "core/estimation/doubtful_standstill.hpp"

#include <gtest/gtest.h>

namespace fail_aware::doubtful_standstill_test {
namespace {

Measurement measured(double min_information_ratio, int degenerate_directions) {
  Measurement measurement;
  measurement.status = MeasurementStatus::kOk;
  measurement.min_information_ratio = min_information_ratio;
  measurement.degenerate_directions = degenerate_directions;
  return measurement;
}

TEST(DoubtfulStandstill, CornersCountUnlessBothIcpsLeaveTheWayOpen) {
  const Measurement open = measured(0.0, 1), sure = measured(0.2, 0), corners = measured(0.5, 0), none;
  const struct {
    const Measurement *point, *plane;
    bool corners_count;
  } cases[] = {{&open, &open, false}, {&open, &sure, true},     {&sure, &sure, true}, {&open, nullptr, false},
               {&open, &none, false}, {nullptr, nullptr, true}, {&none, &none, true}};
  for (const auto& c : cases) {
    std::vector<FusionInput> inputs = {
        {kIcpPointToPoint, c.point}, {kIcpPointToPlane, c.plane}, {kCornerSvd, &corners}};
    leaveOutCornersOfConvoys(inputs);
    EXPECT_EQ(inputs[2].measurement != nullptr, c.corners_count) << (&c - cases);
    EXPECT_EQ(inputs[0].measurement, c.point);
  }
}

}  // namespace
}  // namespace fail_aware::doubtful_standstill_test
