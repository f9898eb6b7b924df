#include "fail_aware_lidar_odometry/bridge/bag_sweep_source.hpp"

#include <sensor_msgs/PointCloud2.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <filesystem>
#include <map>

#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/core/io/input_error.hpp"

namespace fail_aware {

namespace {

const std::string kCloudType = ros::message_traits::datatype<sensor_msgs::PointCloud2>();

void open(rosbag::Bag& bag, const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path + ": not a file");
  try {
    bag.open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(path + ": the bag has no index, its recording was cut off; `rosbag reindex " + path +
                     "` makes one from what is there");
  } catch (const ros::Exception& reason) {
    throw InputError(path + ": not a complete bag (" + reason.what() + "); `rosbag reindex " + path +
                     "` may save what is there");
  }
}

/// The topics that hold clouds, or the named one; the bag's other topics are for the error's text.
std::string chooseTopic(const rosbag::Bag& bag, const std::string& path, const std::string& wanted) {
  rosbag::View all(bag);
  if (all.size() == 0) throw InputError(path + ": the bag has no messages");
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    types[connection->topic] = connection->datatype;
  }
  std::string clouds;
  std::size_t cloud_topics = 0;
  std::string only;
  for (const auto& [topic, type] : types) {
    if (type != kCloudType) continue;
    clouds += (clouds.empty() ? "" : ", ") + topic;
    only = topic;
    ++cloud_topics;
  }
  const std::string has = cloud_topics == 0 ? "no topic of type " + kCloudType : "clouds on " + clouds;
  if (!wanted.empty()) {
    const auto found = types.find(wanted);
    if (found == types.end()) throw InputError(path + ": no topic " + wanted + "; the bag has " + has);
    if (found->second != kCloudType) {
      throw InputError(path + ": " + wanted + " is of type " + found->second + ", not " + kCloudType +
                       "; the bag has " + has);
    }
    return wanted;
  }
  if (cloud_topics == 0) throw InputError(path + ": the bag has " + has);
  if (cloud_topics > 1) throw InputError(path + ": the bag has " + has + "; name one with --topic");
  return only;
}

/// Null: the file does not give it back.
sensor_msgs::PointCloud2ConstPtr cloudAt(const rosbag::View::iterator& at, std::string& reason) {
  try {
    sensor_msgs::PointCloud2ConstPtr cloud = (*at).instantiate<sensor_msgs::PointCloud2>();
    if (!cloud) reason = "its definition is not that of " + kCloudType;
    return cloud;
  } catch (const std::exception& error) {
    reason = error.what();
    return nullptr;
  }
}

ReadStatus toReadStatus(CloudStatus status) {
  switch (status) {
    case CloudStatus::kOk: return ReadStatus::kOk;
    case CloudStatus::kEmpty: return ReadStatus::kNoFinitePoint;
    default: return ReadStatus::kUnreadable;
  }
}

}  // namespace

BagSweepSource::BagSweepSource(const std::string& path, const std::string& topic) : path_(path) {
  open(bag_, path);
  try {
    topic_ = chooseTopic(bag_, path, topic);
    view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(topic_));
    if (view_->size() == 0) throw InputError(path + ": no message on " + topic_);
    at_ = view_->begin();
  } catch (const ros::Exception& error) {
    throw InputError(path + ": damaged (" + error.what() + ")");
  }
  std::string reason;
  for (rosbag::View::iterator at = view_->begin(); at != view_->end(); ++at) {
    const sensor_msgs::PointCloud2ConstPtr cloud = cloudAt(at, reason);
    if (!cloud) continue;
    lidar_frame_ = withoutSlash(cloud->header.frame_id);
    return;
  }
  throw InputError(path + ": no message on " + topic_ + " can be read (" + reason + ")");
}

std::optional<Pose> BagSweepSource::lidarInBase(const std::string& base_frame) const {
  const std::string base = withoutSlash(base_frame);
  if (base == lidar_frame_) return Pose::Identity();
  tf2::BufferCore transforms;
  rosbag::View view(bag_, rosbag::TopicQuery(std::vector<std::string>{"/tf_static", "tf_static"}));
  try {
    for (const rosbag::MessageInstance& instance : view) {
      const tf2_msgs::TFMessageConstPtr message = instance.instantiate<tf2_msgs::TFMessage>();
      if (!message) continue;
      for (const geometry_msgs::TransformStamped& transform : message->transforms) {
        transforms.setTransform(transform, path_, true);
      }
      if (!transforms.canTransform(base, lidar_frame_, ros::Time(0))) continue;
      return fromMessage(transforms.lookupTransform(base, lidar_frame_, ros::Time(0)).transform);
    }
  } catch (const rosbag::BagException& error) {
    throw InputError(path_ + ": damaged (" + error.what() + ")");
  }
  return std::nullopt;
}

void BagSweepSource::skip(std::size_t count) {
  next_ += count;
  for (; count > 0; --count) ++at_;
}

ReadResult BagSweepSource::next(Sweep& sweep) {
  ++next_;
  std::string reason;
  const ros::Time recorded = at_->getTime();
  const sensor_msgs::PointCloud2ConstPtr cloud = cloudAt(at_, reason);
  ++at_;
  ReadResult result;
  if (!cloud) {
    sweep = Sweep();
    sweep.stamp_s = recorded.toSec();
    return {ReadStatus::kUnreadable, name() + ": cannot be read: " + reason};
  }
  if (withoutSlash(cloud->header.frame_id) != lidar_frame_) {
    sweep = Sweep();
    sweep.stamp_s = cloud->header.stamp.toSec();
    return {ReadStatus::kUnreadable,
            name() + ": its frame is '" + cloud->header.frame_id + "', the first one's '" + lidar_frame_ + "'"};
  }
  const CloudReadResult read = readCloud(*cloud, sweep);
  if (read.ok()) return {};
  return {toReadStatus(read.status), name() + ": " + read.reason};
}

std::string BagSweepSource::name() const { return path_ + ", cloud " + std::to_string(next_ - 1) + " of " + topic_; }

}  // namespace fail_aware
