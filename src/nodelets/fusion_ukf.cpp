// The filter in the live graph (core/filter/pose_filter.hpp).
// In: points (only header and frame matter), measurement/*. Out: sweep/prediction, filter_state, odometry, path, tf.
// Service: ~reset.
//
// One sweep is open at a time: predicted when its cloud comes, closed when every source has answered or at its
// deadline; sweeps that come meanwhile wait in a short queue. A source that missed some sweeps in a row is no longer
// waited for until it is heard again. Every opened sweep gives exactly one filter_state and one odometry; every other
// cloud is counted in a diagnostic by its cause.
#include <diagnostic_updater/diagnostic_updater.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/odometry_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"
#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

struct FusionUkfNodeletParams {
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  bool publish_tf = true;                   ///< odom_frame -> base_frame
  std::string lidar_in_base_source = "tf";  ///< tf: looked up once; parameter: sensor/lidar_in_base
  double deadline_s = 0.25;                 ///< from prediction to closing a sweep
  double first_deadline_s = 2.0;            ///< while no motion is known: the search for it takes longer
  int queue_size = 3;                       ///< sweeps that may wait for the open one
  double max_reorder_s = 0.5;               ///< a stamp further back than this is a jump in time: reset
  int absent_after_sweeps = 3;              ///< misses in a row until a source is no longer waited for
  int path_max_poses = 2000;
  double path_spacing_m = 0.5;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("odom_frame", self.odom_frame);
    v("base_frame", self.base_frame);
    v("publish_tf", self.publish_tf);
    v("lidar_in_base_source", self.lidar_in_base_source);
    v("deadline_s", self.deadline_s);
    v("first_deadline_s", self.first_deadline_s);
    v("queue_size", self.queue_size);
    v("max_reorder_s", self.max_reorder_s);
    v("absent_after_sweeps", self.absent_after_sweeps);
    v("path_max_poses", self.path_max_poses);
    v("path_spacing_m", self.path_spacing_m);
  }
  void validate() const {
    if (odom_frame.empty() || base_frame.empty()) throw ParameterError("odom_frame, base_frame: must not be empty");
    if (lidar_in_base_source != "tf" && lidar_in_base_source != "parameter") {
      throw ParameterError("lidar_in_base_source: must be tf or parameter, not " + lidar_in_base_source);
    }
    requirePositive("deadline_s", deadline_s);
    requirePositive("first_deadline_s", first_deadline_s);
    requireWithin("queue_size", queue_size, 1, 100);
    requireNotNegative("max_reorder_s", max_reorder_s);
    requireWithin("absent_after_sweeps", absent_after_sweeps, 1, 1000);
    requireWithin("path_max_poses", path_max_poses, 1, 100000);
    requireNotNegative("path_spacing_m", path_spacing_m);
  }
};

class FusionUkfNodelet : public nodelet::Nodelet {
 private:
  static constexpr std::uint32_t kQueue = 8;
  static constexpr double kDeadlineCheck_s = 0.01;

  struct Source {
    std::string name;
    ros::Subscriber subscriber;
    std::optional<Measurement> measurement;  ///< of the open sweep
    int missed = 0;                          ///< sweeps in a row
    std::size_t late = 0;
  };

  struct Counts {
    std::size_t sweeps = 0, predicted_only = 0, overload = 0, duplicate = 0, reordered = 0, refused_stamp = 0,
                wrong_frame = 0, no_transform = 0, resets = 0;
  };

  void onInit() override {
    ros::NodeHandle& node = getNodeHandle();
    ros::NodeHandle& private_node = getPrivateNodeHandle();
    readParameters(private_node, "", params_, MissingKeys::kKeep);
    params_.validate();
    const PipelineParameters pipeline = readPipelineParameters(node);
    const ProfileParameters& profile = pipeline.profile;
    T_base_cog_ = pipeline.vehicle.T_base_cog();
    start_sigmas_ << Eigen::Vector3d::Constant(profile.filter.initial_sigma_m),
        Eigen::Vector3d::Constant(profile.filter.initial_sigma_deg * M_PI / 180.0);
    filter_ = std::make_unique<PoseFilter>(profile.filter, profile.ukf,
                                           VehicleModel(pipeline.vehicle.dynamics, profile.model), profile.history,
                                           profile.road, profile.fusion);
    reset();
    if (params_.lidar_in_base_source == "parameter") {
      T_base_lidar_ = pipeline.sensor.T_base_lidar();
    } else {
      tf_buffer_ = std::make_unique<tf2_ros::Buffer>();
      tf_listener_ = std::make_unique<tf2_ros::TransformListener>(*tf_buffer_);
    }
    if (params_.publish_tf) tf_broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>();

    updater_ = std::make_unique<diagnostic_updater::Updater>(node, private_node, getName());
    updater_->setHardwareID("none");
    updater_->add("odometry", this, &FusionUkfNodelet::diagnose);
    prediction_publisher_ = node.advertise<messages::SweepPrediction>("sweep/prediction", kQueue);
    state_publisher_ = node.advertise<messages::FilterState>("filter_state", kQueue);
    odometry_publisher_ = node.advertise<nav_msgs::Odometry>("odometry", kQueue);
    path_publisher_ = node.advertise<nav_msgs::Path>("path", 1);
    reset_service_ = private_node.advertiseService("reset", &FusionUkfNodelet::onReset, this);
    deadline_timer_ = node.createSteadyTimer(ros::WallDuration(kDeadlineCheck_s),
                                             [this](const ros::SteadyTimerEvent&) { checkDeadline(); });
    const RegistrationParameters& use = profile.registration;
    if (use.use_point) sources_.push_back({kIcpPointToPoint, {}, {}, 0, 0});
    if (use.use_plane) sources_.push_back({kIcpPointToPlane, {}, {}, 0, 0});
    if (use.use_corners) sources_.push_back({kCornerSvd, {}, {}, 0, 0});
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      sources_[i].subscriber = node.subscribe<messages::PoseMeasurement>(
          "measurement/" + sources_[i].name, kQueue,
          [this, i](const messages::PoseMeasurementConstPtr& message) { onMeasurement(sources_[i], *message); });
    }
    cloud_subscriber_ = node.subscribe("points", kQueue, &FusionUkfNodelet::onCloud, this);
  }

  // ---- clouds: which sweeps are accepted ----------------------------------------------------------------------------

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    const std_msgs::Header& header = cloud->header;
    if (!lidarKnown(header.frame_id)) return;
    if (header.stamp.isZero()) {
      lose(counts_.refused_stamp);
      return;
    }
    if (!newest_stamp_.isZero() && header.stamp <= newest_stamp_) {
      const double back_s = (newest_stamp_ - header.stamp).toSec();
      if (back_s <= params_.max_reorder_s) {
        lose(back_s > 0.0 ? counts_.reordered : counts_.duplicate);
        return;
      }
      NODELET_WARN("stamps jumped back by %.3f s: starting anew", back_s);
      reset();
    }
    newest_stamp_ = header.stamp;
    waiting_.push_back(header);
    if (static_cast<int>(waiting_.size()) > params_.queue_size) {
      waiting_.pop_front();
      lose(counts_.overload);
    }
    openNext();
  }

  void lose(std::size_t& cause) {
    ++cause;
    ++dropped_before_;
  }

  bool lidarKnown(std::string frame) {
    if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);
    if (T_base_lidar_) {
      if (lidar_frame_.empty()) lidar_frame_ = frame;
      if (frame == lidar_frame_) return true;
      ++counts_.wrong_frame;
      return false;
    }
    if (frame == params_.base_frame) {
      T_base_lidar_ = Pose::Identity();
    } else {
      try {
        T_base_lidar_ =
            fromMessage(tf_buffer_->lookupTransform(params_.base_frame, frame, ros::Time(0)).transform);
      } catch (const tf2::TransformException& error) {
        transform_error_ = error.what();
      }
    }
    lidar_frame_ = frame;
    if (!T_base_lidar_) {
      ++counts_.no_transform;
      return false;
    }
    tf_listener_.reset();
    return true;
  }

  // ---- one sweep ----------------------------------------------------------------------------------------------------

  void openNext() {
    while (!open_ && !waiting_.empty()) {
      std_msgs::Header header = waiting_.front();
      waiting_.pop_front();
      SweepTask task;
      if (!filter_->predict(header.stamp.toSec(), task.prediction)) {
        lose(counts_.refused_stamp);
        continue;
      }
      task.T_cog_lidar = T_base_cog_.inverse() * *T_base_lidar_;
      header.frame_id = params_.odom_frame;
      open_ = header;
      sweep_points_ = -1;
      for (Source& source : sources_) source.measurement.reset();
      const double deadline_s = task.prediction.motion_known ? params_.deadline_s : params_.first_deadline_s;
      deadline_at_ = ros::SteadyTime::now() + ros::WallDuration(deadline_s);
      prediction_publisher_.publish(messages::SweepPredictionConstPtr(
          boost::make_shared<messages::SweepPrediction>(toMessage(task, header, last_stamp_))));
      if (allAnswered()) close();
    }
  }

  void onMeasurement(Source& source, const messages::PoseMeasurement& message) {
    source.missed = 0;
    if (!open_ || message.header.stamp != open_->stamp) {
      ++source.late;
      return;
    }
    source.measurement = fromMessage(message);
    sweep_points_ = std::max(sweep_points_, static_cast<int>(message.sweep_points));
    if (!allAnswered()) return;
    close();
    openNext();
  }

  void checkDeadline() {
    if (!open_ || ros::SteadyTime::now() < deadline_at_) return;
    close();
    openNext();
  }

  bool allAnswered() const {
    return std::all_of(sources_.begin(), sources_.end(), [&](const Source& source) {
      return source.measurement || source.missed >= params_.absent_after_sweeps;
    });
  }

  void close() {
    const std_msgs::Header header = *open_;
    open_.reset();
    SweepAccount account;
    account.sweep_points = sweep_points_;
    account.dropped_before = dropped_before_;
    std::vector<FusionInput> inputs;
    for (Source& source : sources_) {
      if (!source.measurement) ++source.missed;
      account.sources.push_back({source.name, source.measurement});
      inputs.push_back({source.name, source.measurement ? &*source.measurement : nullptr});
    }
    const Pose T_odom_cog_previous = filter_->state().T_odom_cog;
    const FilterState& state = filter_->correct(inputs);
    if (state.dt_s > 0.0) {
      odometry_covariance_.propagate(T_odom_cog_previous, state.T_odom_cog, state.increment_covariance);
    }
    ++counts_.sweeps;
    if (!state.corrected && state.dt_s > 0.0) ++counts_.predicted_only;
    last_corrected_ = state.corrected;
    dropped_before_ = 0;
    last_stamp_ = header.stamp;
    publish(state, account, header);
  }

  void publish(const FilterState& state, const SweepAccount& account, const std_msgs::Header& header) {
    state_publisher_.publish(messages::FilterStateConstPtr(
        boost::make_shared<messages::FilterState>(toMessage(state, account, header))));
    const auto odometry = boost::make_shared<nav_msgs::Odometry>(toOdometryMessage(
        state, odometry_covariance_.covariance(), T_base_cog_, params_.odom_frame, params_.base_frame));
    odometry->header.stamp = header.stamp;
    odometry_publisher_.publish(nav_msgs::OdometryConstPtr(odometry));
    const Pose T_odom_base = state.T_odom_cog * T_base_cog_.inverse();
    if (tf_broadcaster_) {
      geometry_msgs::TransformStamped transform;
      transform.header = header;
      transform.child_frame_id = params_.base_frame;
      transform.transform = toTransformMessage(T_odom_base);
      tf_broadcaster_->sendTransform(transform);
    }
    extendPath(T_odom_base, header);
  }

  void extendPath(const Pose& T_odom_base, const std_msgs::Header& header) {
    const Eigen::Vector3d position = T_odom_base.translation();
    if (!path_.empty() && (position - path_end_odom_).norm() < params_.path_spacing_m) return;
    path_end_odom_ = position;
    geometry_msgs::PoseStamped pose;
    pose.header = header;
    pose.pose = toPoseMessage(T_odom_base);
    path_.push_back(pose);
    if (static_cast<int>(path_.size()) > params_.path_max_poses) path_.pop_front();
    if (path_publisher_.getNumSubscribers() == 0) return;
    const auto message = boost::make_shared<nav_msgs::Path>();
    message->header = header;
    message->poses.assign(path_.begin(), path_.end());
    path_publisher_.publish(nav_msgs::PathConstPtr(message));
  }

  // ---- the rest -----------------------------------------------------------------------------------------------------

  /// The next sweep is the first; it tells the other nodelets so by its dt of 0.
  void reset() {
    filter_->reset(T_base_cog_);  // odom begins at base_link
    odometry_covariance_.reset(start_sigmas_.cwiseAbs2().asDiagonal());
    open_.reset();
    waiting_.clear();
    path_.clear();
    last_stamp_ = newest_stamp_ = ros::Time();
    dropped_before_ = 0;
    if (counts_.sweeps > 0) ++counts_.resets;
  }

  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    reset();
    response.success = true;
    response.message = "the next sweep is the first";
    return true;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    std::string absent;
    for (const Source& source : sources_) {
      if (source.missed >= params_.absent_after_sweeps) absent += ' ' + source.name;
    }
    if (!T_base_lidar_ && counts_.no_transform > 0) {
      status.summary(Level::ERROR,
                     "no transform " + params_.base_frame + " -> " + lidar_frame_ + ": " + transform_error_);
    } else if (counts_.sweeps == 0) {
      status.summary(Level::WARN, "no cloud yet");
    } else if (!absent.empty()) {
      status.summary(Level::WARN, "no answer from" + absent);
    } else if (!last_corrected_ && counts_.sweeps > 1) {
      status.summary(Level::WARN, "prediction only");
    } else {
      status.summary(Level::OK, "running");
    }
    status.add("sweeps", counts_.sweeps);
    status.add("sweeps without a usable measurement", counts_.predicted_only);
    status.add("dropped: overload", counts_.overload);
    status.add("dropped: duplicate stamp", counts_.duplicate);
    status.add("dropped: stamp out of order", counts_.reordered);
    status.add("dropped: stamp not usable", counts_.refused_stamp);
    status.add("dropped: frame is not " + lidar_frame_, counts_.wrong_frame);
    status.add("dropped: no transform", counts_.no_transform);
    status.add("resets", counts_.resets);
    for (const Source& source : sources_) status.add("late: " + source.name, source.late);
  }

  FusionUkfNodeletParams params_;
  Pose T_base_cog_ = Pose::Identity();
  Vector6d start_sigmas_ = Vector6d::Zero();  ///< m, rad
  std::unique_ptr<PoseFilter> filter_;
  OdometryCovariance odometry_covariance_;
  std::vector<Source> sources_;

  std::optional<Pose> T_base_lidar_;
  std::string lidar_frame_;
  std::string transform_error_;
  std::unique_ptr<tf2_ros::Buffer> tf_buffer_;
  std::unique_ptr<tf2_ros::TransformListener> tf_listener_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_broadcaster_;

  std::deque<std_msgs::Header> waiting_;
  std::optional<std_msgs::Header> open_;  ///< frame: odom
  int sweep_points_ = -1;                 ///< of the open sweep
  int dropped_before_ = 0;
  bool last_corrected_ = false;
  ros::Time newest_stamp_;                ///< accepted
  ros::Time last_stamp_;                  ///< closed
  ros::SteadyTime deadline_at_;
  std::deque<geometry_msgs::PoseStamped> path_;
  Eigen::Vector3d path_end_odom_ = Eigen::Vector3d::Zero();
  Counts counts_;

  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::Publisher prediction_publisher_, state_publisher_, odometry_publisher_, path_publisher_;
  ros::Subscriber cloud_subscriber_;
  ros::ServiceServer reset_service_;
  ros::SteadyTimer deadline_timer_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::FusionUkfNodelet, nodelet::Nodelet)
