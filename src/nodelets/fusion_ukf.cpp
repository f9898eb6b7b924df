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
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bounded_path.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/odometry_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"
#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"
#include "fusion_ukf_params.hpp"
#include "lidar_place.hpp"
#include "sweep_intake.hpp"

namespace fail_aware {

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
    std::size_t sweeps = 0, predicted_only = 0, no_transform = 0, resets = 0, time_jumps = 0;
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
    path_ = std::make_unique<BoundedPath>(static_cast<std::size_t>(params_.path_max_poses), params_.path_spacing_m);
    intake_.setLimits(static_cast<std::size_t>(params_.queue_size), params_.max_reorder_s);
    reset();
    if (params_.lidar_in_base_source == "parameter") {
      lidar_.use(pipeline.sensor.T_base_lidar());
    } else {
      lidar_.useTransforms(params_.base_frame);
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
    switch (lidar_.find(header.frame_id)) {
      case LidarPlace::Answer::kKnown: break;
      case LidarPlace::Answer::kNoTransform: ++counts_.no_transform; return;
      case LidarPlace::Answer::kOtherFrame: intake_.refuseFrame(); return;
    }
    if (intake_.offer(header) == SweepIntake::Verdict::kJumpedBack) {
      NODELET_WARN("stamps jumped back by %.3f s: starting anew", intake_.behind_s(header.stamp));
      ++counts_.time_jumps;
      reset();
      intake_.offer(header);
    }
    openNext();
  }

  // ---- one sweep ----------------------------------------------------------------------------------------------------

  void openNext() {
    while (!open_) {
      std::optional<std_msgs::Header> next = intake_.next();
      if (!next) return;
      std_msgs::Header& header = *next;
      SweepTask task;
      if (!filter_->predict(header.stamp.toSec(), task.prediction)) {
        intake_.refuseStamp();
        continue;
      }
      task.T_cog_lidar = T_base_cog_.inverse() * lidar_.T_base_lidar();
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
    account.dropped_before = intake_.takeDropped();
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
    if (path_->add(T_odom_base, header) && path_publisher_.getNumSubscribers() > 0) {
      path_publisher_.publish(path_->message());
    }
  }

  // ---- the rest -----------------------------------------------------------------------------------------------------

  /// The next sweep is the first; it tells the other nodelets so by its dt of 0.
  void reset() {
    filter_->reset(T_base_cog_);  // odom begins at base_link
    odometry_covariance_.reset(start_sigmas_.cwiseAbs2().asDiagonal());
    open_.reset();
    intake_.clear();
    path_->clear();
    last_stamp_ = ros::Time();
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
    if (!lidar_.known() && counts_.no_transform > 0) {
      status.summary(Level::ERROR,
                     "no transform " + params_.base_frame + " -> " + lidar_.lidarFrame() + ": " + lidar_.error());
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
    const SweepIntake::Counts& dropped = intake_.counts();
    status.add("dropped: overload", dropped.overload);
    status.add("dropped: duplicate stamp", dropped.duplicate);
    status.add("dropped: stamp out of order", dropped.reordered);
    status.add("dropped: stamp not usable", dropped.unusable_stamp);
    status.add("dropped: frame is not " + lidar_.lidarFrame(), dropped.wrong_frame);
    status.add("dropped: no transform", counts_.no_transform);
    status.add("resets", counts_.resets);
    status.add("resets because stamps jumped back", counts_.time_jumps);
    for (const Source& source : sources_) status.add("late: " + source.name, source.late);
  }

  FusionUkfNodeletParams params_;
  Pose T_base_cog_ = Pose::Identity();
  Vector6d start_sigmas_ = Vector6d::Zero();  ///< m, rad
  std::unique_ptr<PoseFilter> filter_;
  OdometryCovariance odometry_covariance_;
  std::vector<Source> sources_;

  LidarPlace lidar_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_broadcaster_;

  SweepIntake intake_;
  std::optional<std_msgs::Header> open_;  ///< frame: odom
  int sweep_points_ = -1;                 ///< of the open sweep
  bool last_corrected_ = false;
  ros::Time last_stamp_;                  ///< closed
  ros::SteadyTime deadline_at_;
  std::unique_ptr<BoundedPath> path_;
  Counts counts_;

  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::Publisher prediction_publisher_, state_publisher_, odometry_publisher_, path_publisher_;
  ros::Subscriber cloud_subscriber_;
  ros::ServiceServer reset_service_;
  ros::SteadyTimer deadline_timer_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::FusionUkfNodelet, nodelet::Nodelet)
