// Matches SweepCorrection's inputs for one sweep by exact stamp: the cloud and the prediction, in either order of
// arrival. If the prediction names the lidar's frame, a cloud of another frame does not match.
// Bounded: the oldest message is dropped. Failure: none; a cloud without a prediction is counted when a later cloud
// gets its prediction.
#pragma once

#include "fail_aware_lidar_odometry/SweepPrediction.h"
#include <sensor_msgs/PointCloud2.h>

#include <cstddef>
#include <optional>
#include <string>

#include "exact_stamp_buffer.hpp"
#include "topics.hpp"

namespace fail_aware {

class PredictedClouds {
 public:
  using Cloud = sensor_msgs::PointCloud2ConstPtr;
  using Prediction = ::fail_aware_lidar_odometry::SweepPredictionConstPtr;

  struct Pair {
    Cloud cloud;
    Prediction prediction;
  };

  /// The sweep that this message completes; none: the other message is missing.
  std::optional<Pair> add(const Cloud& cloud) {
    clouds_.push(cloud->header.stamp, cloud);
    return take(cloud->header.stamp);
  }
  std::optional<Pair> add(const Prediction& prediction) {
    predictions_.push(prediction->header.stamp, prediction);
    return take(prediction->header.stamp);
  }

  /// Number of clouds without a prediction.
  std::size_t unmatched() const { return unmatched_; }

 private:
  std::optional<Pair> take(const ros::Time& stamp) {
    const Prediction* prediction = predictions_.find(stamp);
    if (prediction == nullptr) return std::nullopt;
    const std::string& frame = (*prediction)->lidar_frame;
    const Cloud* cloud =
        clouds_.find(stamp, [&](const Cloud& c) { return frame.empty() || c->header.frame_id == frame; });
    if (cloud == nullptr) return std::nullopt;
    const Pair pair{*cloud, *prediction};
    unmatched_ += clouds_.popThrough(stamp);
    predictions_.popThrough(stamp);
    return pair;
  }

  ExactStampBuffer<Cloud> clouds_{topics::kQueue};
  ExactStampBuffer<Prediction> predictions_{topics::kQueue};
  std::size_t unmatched_ = 0;
};

}  // namespace fail_aware
