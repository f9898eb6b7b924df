// The clouds of one topic of a bag as a source of sweeps.
//
// Clouds are read as bridge/point_cloud_conversion.hpp reads them; one of another frame than the first one's, or one
// that the file does not give back, is unreadable. The transform base -> lidar comes from the bag's /tf_static.
// The constructor throws InputError, one line: a file that cannot be opened, that is no bag, that has no index (the
// recording was cut off), without a message, without a cloud; several cloud topics and none named; a topic that is not
// there or not of clouds. Memory: one cloud and the bag's index.
#pragma once

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <memory>
#include <optional>
#include <string>

#include "fail_aware_lidar_odometry/core/geometry/pose.hpp"
#include "fail_aware_lidar_odometry/core/io/sweep_source.hpp"

namespace fail_aware {

class BagSweepSource : public SweepSource {
 public:
  /// `topic` empty: the only one of type sensor_msgs/PointCloud2.
  explicit BagSweepSource(const std::string& path, const std::string& topic = "");

  const std::string& topic() const { return topic_; }
  /// Of the first cloud, without a leading slash.
  const std::string& lidarFrame() const { return lidar_frame_; }
  /// T_base_lidar; the identity if the frames are the same; nothing if /tf_static does not connect them.
  std::optional<Pose> lidarInBase(const std::string& base_frame) const;

  std::size_t size() const override { return view_->size(); }
  void skip(std::size_t count) override;
  ReadResult next(Sweep& sweep) override;
  std::string name() const override;

 private:
  std::string path_;
  std::string topic_;
  std::string lidar_frame_;
  rosbag::Bag bag_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator at_;
  std::size_t next_ = 0;
};

}  // namespace fail_aware
