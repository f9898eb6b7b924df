// What a message keeps of the numbers that stages exchange: it holds a rotation as a quaternion. Offline the stages
// exchange rounded data, as if by message. A different number of roundings would change some of the registration's
// decisions and finally give another trajectory than the live graph.
#pragma once

#include "core/geometry/pose.hpp"
#include "core/types/filter_state.hpp"
#include "core/types/measurement.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

inline SweepPrediction exchanged(SweepPrediction prediction) {
  prediction.T_odom_cog_previous = quaternionRoundTrip(prediction.T_odom_cog_previous);
  prediction.T_odom_cog = quaternionRoundTrip(prediction.T_odom_cog);
  return prediction;
}

inline Measurement exchanged(Measurement measurement) {
  measurement.T_odom_cog = quaternionRoundTrip(measurement.T_odom_cog);
  return measurement;
}

inline FilterState exchanged(FilterState state) {
  state.T_odom_cog = quaternionRoundTrip(state.T_odom_cog);
  state.T_previous_now = quaternionRoundTrip(state.T_previous_now);
  return state;
}

}  // namespace fail_aware
