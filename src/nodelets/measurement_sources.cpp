#include "measurement_sources.hpp"

#include <algorithm>
#include <utility>

#include "bridge/parameter_server.hpp"
#include "core/parameters/validate.hpp"
#include "fail_aware_lidar_odometry/bridge/frame_name.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "pose_message.hpp"
#include "topics.hpp"

namespace fail_aware {

namespace {

constexpr std::size_t kSweepsKept = 100;
constexpr const char* kPoseMeasurement = "PoseMeasurement";
constexpr const char* kPoseWithCovariance = "PoseWithCovarianceStamped";

}  // namespace

void ExtraSourceParams::checkRules() const {
  if (topic.empty()) throw ParameterError("topic: must name a topic");
  if (type != kPoseMeasurement && type != kPoseWithCovariance) {
    throw ParameterError("type = " + type + ": must be " + kPoseMeasurement + " or " + kPoseWithCovariance);
  }
}

std::map<std::string, ExtraSourceParams> readExtraSources(const ros::NodeHandle& private_node) {
  std::map<std::string, ParameterMap> groups;
  for (const auto& [key, value] : readParameterMap(private_node, "extra_sources")) {
    const std::size_t dot = key.find('.');
    if (dot == std::string::npos) throw ParameterError("extra_sources: " + key + " must be a group: topic, type");
    groups[key.substr(0, dot)][key.substr(dot + 1)] = value;
  }
  std::map<std::string, ExtraSourceParams> sources;
  for (const auto& [name, values] : groups) {
    try {
      if (std::any_of(kBuiltInSources.begin(), kBuiltInSources.end(),
                      [&](const auto& own) { return own.name == name; })) {
        throw ParameterError("is the name of one of the package's own measurements");
      }
      fromMap(sources[name], values, MissingKeys::kKeep);
      validate(sources[name]);
    } catch (const ParameterError& error) {
      throw ParameterError("extra_sources/" + name + ": " + error.what());
    }
  }
  return sources;
}

MeasurementSources::MeasurementSources(const ros::NodeHandle& node,
                                       const std::map<std::string, ExtraSourceParams>& extra,
                                       const std::string& odom_frame, Estimator& estimator,
                                       std::function<void()> answered)
    : node_(node), odom_frame_(withoutSlash(odom_frame)), estimator_(estimator), answered_(std::move(answered)) {
  for (const BuiltInSource& own : kBuiltInSources) {
    Source& source = add(own.name);
    source.built_in = true;
    source.kind = own.kind;
    source.params.topic = topics::ofMeasurement(own.name);
  }
  for (const auto& [name, params] : extra) {
    Source& source = add(name);
    source.params = params;
    source.exact = params.type == kPoseMeasurement;
    if (!source.exact) estimator_.addSource(name, params.tolerance_s);
  }
}

void MeasurementSources::listen() {
  check_subscriber_ = node_.subscribe<messages::SweepCheck>(
      topics::kSweepCheck, topics::kQueue, [this](const messages::SweepCheckConstPtr& message) { onCheck(*message); });
  for (Source& source : sources_) {  // the sources do not move in memory
    if (source.exact) {
      source.subscriber = node_.subscribe<messages::PoseMeasurement>(
          source.params.topic, topics::kQueue,
          [this, &source](const messages::PoseMeasurementConstPtr& message) { onMeasurement(source, *message); });
    } else {
      source.subscriber = node_.subscribe<geometry_msgs::PoseWithCovarianceStamped>(
          source.params.topic, 100, [this, &source](const geometry_msgs::PoseWithCovarianceStampedConstPtr& message) {
            onPose(source, *message);
          });
    }
  }
}

MeasurementSources::~MeasurementSources() { stopListening(); }

// Each shutdown() waits for a running callback, which needs all the members.
void MeasurementSources::stopListening() {
  check_subscriber_.shutdown();
  for (Source& source : sources_) source.subscriber.shutdown();
}

MeasurementSources::Source& MeasurementSources::add(const std::string& name) {
  sources_.emplace_back();
  sources_.back().name = name;
  return sources_.back();
}

void MeasurementSources::use(const std::string& name, bool used) {
  for (Source& source : sources_) {
    if (source.name == name) source.used = used;
  }
}

void MeasurementSources::open(const ros::Time& stamp, double longest_s) {
  clear();
  open_ = stamp;
  latest_.push_back({stamp, ros::SteadyTime::now() + ros::WallDuration(longest_s)});
  if (latest_.size() > kSweepsKept) latest_.pop_front();
}

void MeasurementSources::clear() {
  open_ = ros::Time();
  findings_.reset();
  check_points_ = sweep_points_ = -1;
  for (Source& source : sources_) source.measurement.reset();
}

bool MeasurementSources::awaited(const Source& source) const {
  if (!source.used || !source.exact) return false;
  const bool has_points = !source.built_in || findings_ || checkAwaited();
  return has_points && canAnswer(source.subscriber, source.record);
}

bool MeasurementSources::allAnswered() const {
  return !checkAwaited() && std::all_of(sources_.begin(), sources_.end(), [this](const Source& source) {
    return source.measurement || !awaited(source);
  });
}

bool MeasurementSources::isAtWork(bool late_only) const {
  const auto patience = [&](const SourceHealth& record) {
    return record.isAtWork() && (record.isLate() || !late_only);
  };
  if (checkAwaited()) return patience(check_record_);  // the other sources wait for the check, too
  return std::any_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    return !source.measurement && awaited(source) && patience(source.record);
  });
}

bool MeasurementSources::isInVain(const ros::Time& stamp) const {
  const auto sweep = std::find_if(latest_.rbegin(), latest_.rend(), [&](const Latest& l) { return l.stamp == stamp; });
  return sweep == latest_.rend() || ros::SteadyTime::now() > sweep->at;
}

void MeasurementSources::onCheck(const messages::SweepCheck& message) {
  if (message.header.stamp != open_) {
    check_record_.late(isInVain(message.header.stamp));
    return;
  }
  check_record_.inTime();
  findings_ = fromMessage(message);
  check_points_ = message.points;
  answered_();
}

void MeasurementSources::onMeasurement(Source& source, const messages::PoseMeasurement& message) {
  if (message.header.stamp != open_ || open_.isZero()) {
    source.record.late(isInVain(message.header.stamp));
    ++source.late;
    return;
  }
  source.record.inTime();
  if (source.built_in) {
    source.measurement = fromMessage(message);
  } else {
    std::string reason;
    source.measurement = measurementInOdom(message, odom_frame_, reason);
    if (!reason.empty()) refuse(source, reason);  // still an answer: no further waiting
  }
  source.last_status = toString(source.measurement->status);
  source.last_duration_s = message.duration;
  ++source.answers;
  if (source.built_in) sweep_points_ = std::max(sweep_points_, static_cast<int>(message.sweep_points));
  answered_();
}

void MeasurementSources::onPose(Source& source, const geometry_msgs::PoseWithCovarianceStamped& message) {
  if (message.header.stamp.isZero()) return refuse(source, "its stamp is 0, must be the time of the pose");
  std::string reason;
  const std::optional<Pose> T_odom_frame = odomFrom(message.header.frame_id, reason);
  const std::optional<Pose> T_frame_base = fromMessage(message.pose.pose);
  if (T_odom_frame) {
    ExternalPose pose;
    pose.stamp_s = message.header.stamp.toSec();
    pose.covariance = rotateCovariance(fromMessage(message.pose.covariance), T_odom_frame->linear());
    if (T_frame_base) pose.T_odom_base = *T_odom_frame * *T_frame_base;
    reason = T_frame_base ? estimator_.offer(source.name, pose)
                          : "the pose is not valid (orientation must be a unit quaternion)";
    if (reason.empty()) return;
  }
  refuse(source, reason);
}

void MeasurementSources::refuse(Source& source, const std::string& reason) {
  if (source.refused++ == 0 || reason != source.refused_because) {
    ROS_WARN("extra source %s refused: %s", source.name.c_str(), reason.c_str());
  }
  source.refused_because = reason;
}

std::optional<Pose> MeasurementSources::odomFrom(const std::string& frame_id, std::string& reason) {
  const std::string frame = withoutSlash(frame_id);
  if (frame == odom_frame_) return Pose::Identity();
  if (!tf_buffer_) {
    tf_buffer_ = std::make_unique<tf2_ros::Buffer>();
    tf_listener_ = std::make_unique<tf2_ros::TransformListener>(*tf_buffer_);
  }
  try {
    std::optional<Pose> T_odom_frame =
        fromMessage(tf_buffer_->lookupTransform(odom_frame_, frame, ros::Time(0)).transform);
    if (!T_odom_frame) reason = "tf's transform from its frame " + frame + " to " + odom_frame_ + " is not valid";
    return T_odom_frame;
  } catch (const tf2::TransformException& error) {
    reason = "its frame is " + frame + ", not " + odom_frame_ + ", and tf does not know it: " + error.what();
    return std::nullopt;
  }
}

SweepAccount MeasurementSources::close() {
  SweepAccount account;
  account.findings = findings_;
  account.sweep_points = sweep_points_ >= 0 ? sweep_points_ : check_points_ == 0 ? 0 : -1;
  if (!findings_) check_record_.miss();
  for (Source& source : sources_) {
    if (!source.used || !source.exact) continue;
    if (!source.measurement) source.record.miss();
    // The nodelet of a partial measurement has a full one, too. If the nodelet is absent, the full one reports it.
    const bool expected = !FusionInput::isPartial(source.kind) || source.subscriber.getNumPublishers() > 0;
    account.sources.push_back({source.name, source.measurement, expected, source.kind});
  }
  open_ = ros::Time();
  return account;
}

void MeasurementSources::addPoses(const std::vector<ExternalMeasurement>& poses, SweepAccount& account) {
  for (const ExternalMeasurement& pose : poses) {
    account.sources.push_back({pose.source, pose.measurement, false, FusionInput::Kind::kExternal});
    const auto source = std::find_if(sources_.begin(), sources_.end(),
                                     [&](const Source& candidate) { return candidate.name == pose.source; });
    if (source == sources_.end() || !pose.measurement) continue;
    source->last_status = toString(pose.measurement->status);
    ++source->answers;
  }
}

std::string MeasurementSources::absent() const {
  std::string names;
  const auto add = [&](const std::string& name, const ros::Subscriber& subscriber, const SourceHealth& record) {
    if (canAnswer(subscriber, record)) return;
    names += ' ' + name;
    if (record.isTooLate(absent_after_sweeps_)) names += " (too late)";
  };
  add("sweep_correction", check_subscriber_, check_record_);
  for (const Source& source : sources_) {
    if (source.used && source.exact) add(source.name, source.subscriber, source.record);
  }
  return names;
}

void MeasurementSources::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  status.add("sweep_correction: publishers", check_subscriber_.getNumPublishers());
  for (const Source& source : sources_) {
    if (!source.used) {
      status.add(source.name, "not used");
      continue;
    }
    status.add(source.name + ": publishers", source.subscriber.getNumPublishers());
    status.add(source.name + ": last", source.last_status);
    status.add(source.name + ": answers", source.answers);
    if (source.exact) {
      status.add(source.name + ": late", source.late);
      status.addf(source.name + ": ms", "%.1f", 1e3 * source.last_duration_s);
    }
    if (!source.built_in) {
      status.add(source.name + ": refused", source.refused);
      if (source.refused > 0) status.add(source.name + ": refused because", source.refused_because);
    }
  }
}

}  // namespace fail_aware
