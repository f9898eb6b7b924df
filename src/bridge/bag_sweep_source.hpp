// The clouds of one topic of a bag as a source of sweeps. Several bags can form one drive (rosbag record --split);
// their messages are read in the order of recording, whatever the order of the paths.
//
// Clouds are converted by bridge/point_cloud_conversion.hpp. A cloud whose frame differs from the first one's is of
// another lidar; one that cannot be read from the file is unreadable. The transform base -> lidar comes from /tf_static
// of all bags; if it is missing there, from /tf, where it must be constant.
// The constructor throws InputError with one line for: a file that cannot be opened, that is not a bag (a ROS 2 bag is
// named as such), that has no index (the recording was cut off), no message or no cloud; the same file twice; several
// cloud topics and none named; a topic that does not exist or has another type. Memory: one cloud, the indices.
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
    std::string why_not;  ///< reason if the transform is unknown; one line without the file
  };

  /// `topic` empty: the only topic of type sensor_msgs/PointCloud2. At least one path.
  explicit BagSweepSource(const std::vector<std::string>& paths, const std::string& topic = "");

  const std::string& topic() const { return topic_; }
  /// The identity if the frames are the same. If /tf_static does not connect them, this reads /tf in all bags, which
  /// means reading every part of each file.
  Mounting lidarInBase(const std::string& base_frame) const;

  std::size_t size() const override { return size_; }
  void skip(std::size_t count) override;
  ReadResult next(Sweep& sweep) override;
  std::string name() const override;

 private:
  struct Part {
    std::string path;
    rosbag::Bag bag;
    std::map<std::string, std::string> types;  ///< type of each topic
    rosbag::View view;                         ///< of the chosen topic
    rosbag::View::iterator at;
    std::size_t next = 0;
  };

  /// The part with the earliest unread cloud. Must not be called beyond the end.
  Part& earliest();

  double stamp_minus_recorded_s_ = 0.0;  ///< of the last readable cloud: gives one that cannot be read its stamp
  std::string topic_;
  std::string lidar_frame_;                   ///< of the first cloud, without a leading slash
  std::vector<std::unique_ptr<Part>> parts_;  ///< in order of their first cloud
  std::size_t size_ = 0;
  const Part* last_ = nullptr;  ///< the part of the last sweep read
};

}  // namespace fail_aware
