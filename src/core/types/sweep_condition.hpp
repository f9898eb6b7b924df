// The condition of a sweep: input of the fail-aware monitor (integrity/monitor.hpp) in addition to the filter's state.
#pragma once

#include <string>

#include "core/types/information_ahead.hpp"
#include "core/types/measurement.hpp"

namespace fail_aware {

struct SweepCondition {
  bool empty = false;       ///< no usable point
  bool incomplete = false;  ///< part of the revolution is missing
  bool low_visibility = false;
  bool frozen = false;                    ///< the sensor repeats the same cloud
  bool time_jump = false;                 ///< the stamps jumped, back or ahead
  bool time_field_refused = false;        ///< the points' times are a guess
  bool point_times_contradicted = false;  ///< the clouds contradict the settings that time their points
  bool no_answer = false;                 ///< a stage of the live graph missed the deadline
  int dropped_before = 0;                 ///< sweeps lost since the last one
  bool point_missing = false;             ///< the source is used but gave no usable measurement; likewise the next two
  bool plane_missing = false;
  bool corners_missing = false;
  double min_information_ratio = 1.0;  ///< weakest horizontal direction, point-to-plane ICP; 1: not known
  InformationAhead ahead;

  /// A source that is used; `ok`: its measurement is usable.
  void add(const std::string& source, bool ok, double information_ratio) {
    if (source == kIcpPointToPoint) point_missing = !ok;
    if (source == kIcpPointToPlane) plane_missing = !ok;
    if (source == kCornerSvd) corners_missing = !ok;
    if (source == kIcpPointToPlane && ok) min_information_ratio = information_ratio;
  }
};

}  // namespace fail_aware
