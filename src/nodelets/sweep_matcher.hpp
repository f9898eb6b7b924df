// Matches a measurement nodelet's inputs for one sweep by exact stamp: its points, its prediction, and the filter state
// of the previously measured sweep, which updates the reference. The filter states of the sweeps dropped between the
// two come with it.
//
// Only the newest predicted sweep is measured: an overloaded nodelet drops sweeps, since the filter has already closed
// the older ones.
#pragma once

#include "fail_aware_lidar_odometry/FilterState.h"
#include "fail_aware_lidar_odometry/SweepPrediction.h"
#include <sensor_msgs/PointCloud2.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "exact_stamp_buffer.hpp"

namespace fail_aware {

class SweepMatcher {
 public:
  using State = ::fail_aware_lidar_odometry::FilterStateConstPtr;
  using Prediction = ::fail_aware_lidar_odometry::SweepPredictionConstPtr;

  struct Job {
    Prediction prediction;
    sensor_msgs::PointCloud2ConstPtr cloud;
    bool begins = false;           ///< a drive began with this sweep, or with one dropped before it
    std::vector<State> skipped{};  ///< filter states of the sweeps since the last measured one
  };

  void add(const sensor_msgs::PointCloud2ConstPtr& cloud) { clouds_.push(cloud->header.stamp, cloud); }

  void add(const Prediction& prediction) {
    if (prediction->dt <= 0.0) {  // a drive begins; its stamps may repeat the last drive's
      states_.clear();
      measured_ = ros::Time();
      begins_ = true;
    }
    if (newest_) ++skipped_;
    newest_ = prediction;
  }

  void add(const State& state) { states_.push(state->header.stamp, state); }

  /// The filter state of the last measured sweep; null: not arrived yet, or already taken.
  State takePlace() {
    if (measured_.isZero()) return nullptr;
    const State* found = states_.find(measured_);
    if (found == nullptr) return nullptr;
    State state = *found;
    states_.popThrough(measured_);
    measured_ = ros::Time();
    return state;
  }

  /// The sweep to measure now; it then counts as measured. Nothing while its points, or the filter state of the
  /// previously measured sweep, are missing.
  std::optional<Job> next() {
    if (!newest_) return std::nullopt;
    const ros::Time stamp = newest_->header.stamp;
    const sensor_msgs::PointCloud2ConstPtr* cloud = clouds_.find(stamp);
    if (cloud == nullptr) return std::nullopt;
    if (!measured_.isZero() && measured_ == newest_->previous_stamp) return std::nullopt;
    const Job job{newest_, *cloud, begins_, states_.takeBefore(stamp)};
    begins_ = false;
    clouds_.popThrough(stamp);
    newest_ = nullptr;
    measured_ = stamp;
    return job;
  }

  std::size_t skipped() const { return skipped_; }

 private:
  static constexpr std::size_t kKept = 8;

  ExactStampBuffer<sensor_msgs::PointCloud2ConstPtr> clouds_{kKept};
  ExactStampBuffer<State> states_{kKept};
  Prediction newest_;
  bool begins_ = false;
  ros::Time measured_;  ///< stamp of the sweep that waits for its filter state; zero: none
  std::size_t skipped_ = 0;
};

}  // namespace fail_aware
