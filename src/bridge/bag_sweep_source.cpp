#include "bridge/bag_sweep_source.hpp"

#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "bridge/constant_transforms.hpp"
#include "core/io/input_error.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

namespace {

const std::string kCloudType = ros::message_traits::datatype<sensor_msgs::PointCloud2>();
const std::vector<std::string> kTransformTopics = {"/tf_static", "tf_static", "/tf", "tf"};

/// What a file or folder is that users mistake for a ROS 1 bag; empty: nothing of that kind.
std::string otherRecording(const std::string& path, const std::string& begin) {
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::path(path) / "metadata.yaml", error)) return "a ROS 2 bag";
  const std::string extension = std::filesystem::path(path).extension().string();
  if (begin.rfind("SQLite format 3", 0) == 0 || extension == ".db3") return "a ROS 2 bag (sqlite3)";
  if (begin.rfind("\x89MCAP", 0) == 0 || extension == ".mcap") return "an MCAP file (ROS 2 bag)";
  return {};
}

/// The first bytes; fewer, or none, where there are no more.
std::string beginOf(const std::string& path) {
  std::string begin(15, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return begin;
}

void open(rosbag::Bag& bag, const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path + ": no such file");
  const std::string begin = beginOf(path);
  if (const std::string other = otherRecording(path, begin); !other.empty()) {
    throw InputError(
        path + ": is " + other +
        ", not a ROS 1 bag; convert its folder: pip install rosbags; rosbags-convert --src FOLDER --dst FILE.bag");
  }
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, not a file; give a folder of KITTI with --kitti");
  }
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path + ": not a file");
  if (begin.empty()) throw InputError(path + ": cannot be read, or is empty");
  if (begin.rfind("#ROSBAG", 0) != 0) throw InputError(path + ": not a ROS 1 bag: it does not begin with #ROSBAG");
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

/// Topics and their types.
std::map<std::string, std::string> topicsOf(const rosbag::Bag& bag, const std::string& path) {
  rosbag::View all(bag);
  if (all.size() == 0) throw InputError(path + ": the bag has no messages");
  std::map<std::string, std::string> types;
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    types[connection->topic] = connection->datatype;
  }
  return types;
}

/// The topics with clouds, or the named one; the bags' other topics appear in the error message.
std::string chooseTopic(const std::map<std::string, std::string>& types, const std::string& path,
                        const std::string& wanted) {
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

/// Null: the file does not contain a readable cloud there.
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

}  // namespace

BagSweepSource::BagSweepSource(const std::vector<std::string>& paths, const std::string& topic) {
  std::map<std::string, std::string> types;
  std::string names;
  for (const std::string& path : paths) {
    std::error_code error;
    for (const auto& part : parts_) {
      if (std::filesystem::equivalent(part->path, path, error)) throw InputError(path + ": given twice");
    }
    parts_.push_back(std::make_unique<Part>());
    parts_.back()->path = path;
    open(parts_.back()->bag, path);
    parts_.back()->types = topicsOf(parts_.back()->bag, path);
    for (const auto& [name, type] : parts_.back()->types) {
      const std::string& known = types.emplace(name, type).first->second;
      if (known != type)
        throw InputError(path + ": " + name + " is of type " + type + ", in the bags before it of " + known);
    }
    names += (names.empty() ? "" : ", ") + path;
  }
  topic_ = chooseTopic(types, names, topic);
  for (const auto& part : parts_) {
    if (part->types.count(topic_) == 0 &&
        !std::any_of(kTransformTopics.begin(), kTransformTopics.end(),
                     [&](const auto& name) { return part->types.count(name) != 0; })) {
      throw InputError(part->path + ": neither clouds on " + topic_ + " nor transforms in it");
    }
    try {
      part->view.addQuery(part->bag, rosbag::TopicQuery(topic_));
      part->at = part->view.begin();
      size_ += part->view.size();
    } catch (const ros::Exception& error) {
      throw InputError(part->path + ": damaged (" + error.what() + ")");
    }
  }
  if (size_ == 0) throw InputError(names + ": no message on " + topic_);
  const auto first = [](const std::unique_ptr<Part>& part) {
    return part->view.size() == 0 ? ros::TIME_MAX : part->view.getBeginTime();
  };
  std::sort(parts_.begin(), parts_.end(), [&](const auto& a, const auto& b) {
    return std::make_pair(first(a), a->path) < std::make_pair(first(b), b->path);
  });
  std::string reason;
  bool is_readable = false;
  for (const auto& part : parts_) {
    for (rosbag::View::iterator at = part->view.begin(); at != part->view.end(); ++at) {
      const sensor_msgs::PointCloud2ConstPtr cloud = cloudAt(at, reason);
      if (!cloud) continue;
      is_readable = true;
      lidar_frame_ = withoutSlash(cloud->header.frame_id);  // the first that is not empty: as in the live graph
      if (!lidar_frame_.empty()) return;
    }
  }
  if (!is_readable) throw InputError(names + ": no message on " + topic_ + " can be read (" + reason + ")");
}

BagSweepSource::Mounting BagSweepSource::lidarInBase(const std::string& base_frame) const {
  const std::string base = withoutSlash(base_frame);
  if (lidar_frame_.empty()) return {std::nullopt, "the clouds on " + topic_ + " have an empty header.frame_id"};
  if (base == lidar_frame_) return {Pose::Identity(), {}};
  ConstantTransforms transforms;
  ConstantTransforms::Result found;
  for (const std::string topic : {"tf_static", "tf"}) {
    for (const auto& part : parts_) {
      try {
        rosbag::View view(part->bag, rosbag::TopicQuery(std::vector<std::string>{'/' + topic, topic}));
        for (const rosbag::MessageInstance& instance : view) {
          if (const tf2_msgs::TFMessageConstPtr message = instance.instantiate<tf2_msgs::TFMessage>()) {
            transforms.add(*message);
          }
        }
      } catch (const ros::Exception& error) {
        throw InputError(part->path + ": damaged (" + error.what() + ")");
      }
    }
    found = transforms.between(base, lidar_frame_);
    if (found.T_target_source) break;
  }
  return {found.T_target_source, found.why_not};
}

BagSweepSource::Part& BagSweepSource::earliest() {
  Part* found = nullptr;
  for (const auto& part : parts_) {
    if (part->next == part->view.size()) continue;
    if (found == nullptr || part->at->getTime() < found->at->getTime()) found = part.get();
  }
  return *found;
}

void BagSweepSource::skip(std::size_t count) {
  for (; count > 0; --count) {
    Part& part = earliest();
    ++part.at;
    ++part.next;
  }
}

ReadResult BagSweepSource::next(Sweep& sweep) {
  Part& part = earliest();
  last_ = &part;
  ++part.next;
  std::string reason;
  const ros::Time recorded = part.at->getTime();
  const sensor_msgs::PointCloud2ConstPtr cloud = cloudAt(part.at, reason);
  ++part.at;
  if (!cloud) {
    sweep = Sweep();
    sweep.stamp_s = recorded.toSec() + stamp_minus_recorded_s_;
    return {ReadStatus::kNoPoints, name() + ": cannot be read: " + reason};
  }
  stamp_minus_recorded_s_ = cloud->header.stamp.toSec() - recorded.toSec();
  if (withoutSlash(cloud->header.frame_id) != lidar_frame_) {
    sweep = Sweep();
    sweep.stamp_s = cloud->header.stamp.toSec();
    return {ReadStatus::kOtherFrame,
            name() + ": its frame is '" + cloud->header.frame_id + "', the first one's '" + lidar_frame_ + "'"};
  }
  const CloudReadResult read = readCloud(*cloud, sweep);
  if (read.ok()) return {};
  return {ReadStatus::kNoPoints, name() + ": " + read.reason};
}

std::string BagSweepSource::name() const {
  return last_->path + ", cloud " + std::to_string(last_->next - 1) + " of " + topic_;
}

}  // namespace fail_aware
