// The clouds of one topic of a bag as a source of sweeps; or of several bags that are one drive (rosbag record --split), in
// the order in which their messages were recorded, whatever the order in which they are named.
//
// Clouds are read as bridge/point_cloud_conversion.hpp reads them; one of another frame than the first one's, or one
// that the file does not give back, is unreadable. The transform base -> lidar comes from /tf_static of all bags or, if
// it is not there and constant, from /tf.
// The constructor throws InputError, one line: a file that cannot be opened, that is no bag (a ROS 2 bag is named as
// that), that has no index (the recording was cut off), without a message, without a cloud; the same file twice; several
// cloud topics and none named; a topic that is not there or not of clouds. Memory: one cloud and the bags' indices.
#pragma once

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.hpp"
#include "core/io/sweep_source.hpp"

namespace fail_aware {

class BagSweepSource : public SweepSource {
 public:
  struct Mounting {
    std::optional<Pose> T_base_lidar;
    std::string why_not;  ///< where it is not known; one line without the file
  };

  /// `topic` empty: the only one of type sensor_msgs/PointCloud2. At least one path.
  explicit BagSweepSource(const std::vector<std::string>& paths, const std::string& topic = "");
  explicit BagSweepSource(const std::string& path, const std::string& topic = "")
      : BagSweepSource(std::vector<std::string>{path}, topic) {}

  const std::string& topic() const { return topic_; }
  /// Of the first cloud, without a leading slash.
  const std::string& lidarFrame() const { return lidar_frame_; }
  /// The identity if the frames are the same. Where /tf_static does not connect them, /tf is read through all bags (of
  /// which that reads every part).
  Mounting lidarInBase(const std::string& base_frame) const;

  std::size_t size() const override { return size_; }
  void skip(std::size_t count) override;
  ReadResult next(Sweep& sweep) override;
  std::string name() const override;

 private:
  struct Part {
    std::string path;
    rosbag::Bag bag;
    std::map<std::string, std::string> types;  ///< of its topics
    rosbag::View view;                         ///< of the topic
    rosbag::View::iterator at;
    std::size_t next = 0;
  };

  /// The one with the earliest cloud that was not read yet. Not beyond the end.
  Part& earliest();

  std::string topic_;
  std::string lidar_frame_;
  std::vector<std::unique_ptr<Part>> parts_;  ///< in order of their first cloud
  std::size_t size_ = 0;
  const Part* last_ = nullptr;  ///< of the sweep read last
};

}  // namespace fail_aware
