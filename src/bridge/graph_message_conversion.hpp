// The package's own messages <-> the core's structs, so that each stage can run in its own nodelet.
// The conversion keeps everything that the stages need, except for a pose's last bits (rotation matrix <-> quaternion).
// A quality that is not finite becomes 0. Poses and covariances pass unchanged; the receiver checks them. Messages get
// their stamps exactly from the sweep's header; the core's stamp_s is the stamp's toSec().
#pragma once

#include "fail_aware_lidar_odometry/FilterState.h"
#include "fail_aware_lidar_odometry/PoseMeasurement.h"
#include "fail_aware_lidar_odometry/SweepCheck.h"
#include "fail_aware_lidar_odometry/SweepPrediction.h"
#include <std_msgs/Header.h>

#include <optional>
#include <string>
#include <vector>

#include "core/types/filter_state.hpp"
#include "core/types/fusion_input.hpp"
#include "core/types/measurement.hpp"
#include "core/types/sweep_findings.hpp"
#include "core/types/sweep_prediction.hpp"

namespace fail_aware {

namespace messages = ::fail_aware_lidar_odometry;

/// The input of a measurement nodelet for one sweep.
struct SweepTask {
  SweepPrediction prediction;
  Pose T_cog_lidar = Pose::Identity();
  std::string lidar_frame;  ///< frame of the sweep's cloud; empty: any

  bool first() const { return prediction.isFirst(); }
};

/// `header`: stamp of the sweep, frame of the odometry.
messages::SweepPrediction toMessage(const SweepTask& task, const std_msgs::Header& header,
                                    const ros::Time& previous_stamp);
/// Nothing if a pose is not valid.
std::optional<SweepTask> fromMessage(const messages::SweepPrediction& message);

messages::PoseMeasurement toMessage(const Measurement& measurement, const std::string& source,
                                    const std_msgs::Header& header);
/// A pose that is not valid becomes not finite, and the fusion counts it as invalid. An unknown status: kNoReference.
Measurement fromMessage(const messages::PoseMeasurement& message);

/// Of a message's two fields. Not known if one is not a number in its range; a distance of 0: the fields were not
/// filled.
InformationAhead aheadOf(double ratio, double distance_m);

/// `points`: number of usable points.
messages::SweepCheck toMessage(const SweepFindings& findings, std::size_t points, const std_msgs::Header& header);
SweepFindings fromMessage(const messages::SweepCheck& message);

/// The parts of a filter state message that the core's FilterState does not hold.
struct SweepAccount {
  struct Source {
    std::string name;
    std::optional<Measurement> measurement;  ///< nothing: not arrived by the deadline
    bool awaited = true;                     ///< false: it may come at any time, so its absence means nothing
    FusionInput::Kind kind = FusionInput::Kind::kPose;
  };
  std::vector<Source> sources;            ///< in the order of the fusion's inputs
  int sweep_points = -1;                  ///< -1: not known
  std::optional<SweepFindings> findings;  ///< nothing: not arrived by the deadline
  int dropped_before = 0;
};

messages::FilterState toMessage(const FilterState& state, const SweepAccount& account, const std_msgs::Header& header);
/// Nothing if a pose is not valid.
std::optional<FilterState> fromMessage(const messages::FilterState& message);

}  // namespace fail_aware
