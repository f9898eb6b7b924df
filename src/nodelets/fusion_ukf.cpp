// The filter in the live graph (core/filter/pose_filter.hpp).
// In: points (only header and frame matter), sweep/check, measurement/*, extra sources, set_pose. Out:
// sweep/prediction, filter_state, odometry, path, tf. Services: ~reset, ~save_trajectory.
//
// One sweep is open at a time: predicted when its cloud comes, closed when every source that can answer has answered or
// at its deadline; sweeps that come meanwhile wait in a short queue. Every opened sweep gives exactly one filter_state
// and one odometry; every other cloud is counted in a diagnostic by its cause.
#include <fail_aware_lidar_odometry/FusionUkfConfig.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clock_check.hpp"
#include "deferred_call.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/core/filter/pose_filter.hpp"
#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"
#include "fail_aware_lidar_odometry/core/geometry/degree.hpp"
#include "fusion_ukf_params.hpp"
#include "health.hpp"
#include "lidar_place.hpp"
#include "load_or_say_why.hpp"
#include "measurement_sources.hpp"
#include "odometry_output.hpp"
#include "open_queue.hpp"
#include "pose_setting.hpp"
#include "private_parameters.hpp"
#include "published_type.hpp"
#include "rate_meter.hpp"
#include "reconfiguration.hpp"
#include "spoken_faults.hpp"
#include "stamps.hpp"
#include "sweep_intake.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class FusionUkfNodelet : public nodelet::Nodelet {
 public:
  ~FusionUkfNodelet() override {
    if (sources_) sources_->stopListening();  // they call opening_, which calls them
  }

 private:
  using Config = fail_aware_lidar_odometry::FusionUkfConfig;

  static constexpr std::uint32_t kCloudQueue = 50;  ///< roscpp drops without a word; here it is counted
  static constexpr double kDeadlineCheck_s = 0.01;
  static constexpr double kSilent_s = 2.0;  ///< without a sweep: worth a diagnostic
  static constexpr double kStarts_s = 8.0;  ///< until all the others are there: no line in the log before
  static constexpr std::size_t kHeld = 3;   ///< fewer than the correction keeps clouds

  struct Counts {
    std::size_t sweeps = 0, predicted_only = 0, no_transform = 0, resets = 0, time_jumps = 0, poses_set = 0,
                poses_refused = 0;
  };

  void onInit() override {
    openQueue(getSTCallbackQueue());
    loadOrSayWhy(getName(), [this] { load(); });
  }

  void load() {
    ros::NodeHandle& node = getNodeHandle();
    ros::NodeHandle& private_node = getPrivateNodeHandle();
    readPrivateParameters(private_node, params_, FusionUkfTuning(), {"extra_sources."});
    params_.validate();
    const PipelineParameters pipeline = readPipelineParameters(node);
    const ProfileParameters& profile = pipeline.profile;
    T_base_cog_ = pipeline.vehicle.T_base_cog();
    start_sigmas_ << Eigen::Vector3d::Constant(profile.filter.initial_sigma_m),
        Eigen::Vector3d::Constant(profile.filter.initial_sigma_deg * kDegree);
    loaded_at_ = ros::SteadyTime::now();
    filter_ = std::make_unique<PoseFilter>(profile.filter, profile.ukf,
                                           VehicleModel(pipeline.vehicle.dynamics, profile.model), profile.history,
                                           profile.road, profile.fusion);
    odometry_covariance_ = OdometryCovariance(profile.monitor.drift);
    sources_ = std::make_unique<MeasurementSources>(node, readExtraSources(private_node), params_.odom_frame,
                                                    [this] { onAnswer(); });
    const FusionUkfTuning tuning{params_, profile.registration, profile.fusion};
    warnOfOtherValues(private_node, params_, tuning);
    tune(tuning);
    output_ = std::make_unique<OdometryOutput>(node, private_node, params_, T_base_cog_);
    sweep_clock_ = SweepClock(pipeline.sensor.timing.sweep_period_s);
    reset();
    if (params_.lidar_in_base_source == "parameter") {
      lidar_.use(pipeline.sensor.T_base_lidar());
    } else {
      lidar_.useTransforms(params_.base_frame);
    }

    prediction_publisher_ = node.advertise<messages::SweepPrediction>(topics::kSweepPrediction, topics::kQueue);
    state_publisher_ = node.advertise<messages::FilterState>(topics::kFilterState, topics::kQueue);
    // From here on others may call, in another thread: all that they use is there.
    opening_ = std::make_unique<DeferredCall>(node, [this] { openNext(); });
    reconfiguration_ = std::make_unique<Reconfiguration<Config, FusionUkfTuning>>(
        private_node, tuning, [this](const FusionUkfTuning& changed) { tune(changed); });
    sources_->listen();
    reset_service_ = private_node.advertiseService("reset", &FusionUkfNodelet::onReset, this);
    deadline_timer_ =
        node.createSteadyTimer(ros::WallDuration(kDeadlineCheck_s), [this](const ros::SteadyTimerEvent&) { onTick(); });
    set_pose_subscriber_ = node.subscribe(topics::kSetPose, 1, &FusionUkfNodelet::onSetPose, this);
    cloud_subscriber_ = node.subscribe(topics::kClouds, kCloudQueue, &FusionUkfNodelet::onCloud, this);
    health_ =
        std::make_unique<Health>(node, private_node, getName(), "odometry",
                                 [this](diagnostic_updater::DiagnosticStatusWrapper& status) { diagnose(status); });
  }

  void tune(const FusionUkfTuning& tuning) {
    params_ = tuning.node;
    filter_->setFusion(tuning.fusion);
    intake_.setLimits(static_cast<std::size_t>(params_.queue_size), params_.max_reorder_s);
    sources_->setAbsentAfter(params_.absent_after_sweeps);
    sources_->use(kIcpPointToPoint, tuning.registration.use_point);
    sources_->use(kIcpPointToPlane, tuning.registration.use_plane);
    sources_->use(kCornerSvd, tuning.registration.use_corners);
  }

  // ---- clouds: which sweeps are accepted ----------------------------------------------------------------------------

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    const std_msgs::Header& header = cloud->header;
    heard_at_ = ros::SteadyTime::now();
    clock_.heard(header.stamp);
    switch (lidar_.find(header.frame_id)) {
      case LidarPlace::Answer::kKnown: break;
      case LidarPlace::Answer::kNoTransform: hold(header); return;
      case LidarPlace::Answer::kOtherFrame: intake_.refuseFrame(); return;
    }
    releaseHeld();
    accept(header);
  }

  /// The transform may be on its way: a bag has it at the stamp of the first cloud. The last few clouds wait for it.
  void hold(const std_msgs::Header& header) {
    missing_transform_ = true;
    held_.push_back(header);
    if (held_.size() <= kHeld) return;
    held_.pop_front();
    ++counts_.no_transform;
  }

  void releaseHeld() {
    std::deque<std_msgs::Header> held;
    held.swap(held_);
    for (const std_msgs::Header& header : held) {
      if (lidar_.find(header.frame_id) == LidarPlace::Answer::kKnown) {
        accept(header);
      } else {
        intake_.refuseFrame();
      }
    }
  }

  void accept(const std_msgs::Header& header) {
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (intake_.offer(header, now) == SweepIntake::Verdict::kNewDrive) {
      faults_.say("jump",
                  "stamps jumped by " + std::to_string(intake_.since_newest_s(header.stamp)) + " s: starting anew");
      ++counts_.time_jumps;
      reset();
      intake_.offer(header, now);
    }
    opening_->request();  // once all the clouds that are here were offered
  }

  // ---- one sweep ----------------------------------------------------------------------------------------------------

  void openNext() {
    while (!open_) {
      std::optional<SweepIntake::Waiting> next = intake_.next();
      if (!next) return;
      std_msgs::Header& header = next->header;
      SweepTask task;
      if (!filter_->predict(sweep_clock_.next(header.stamp.toSec(), next->set_back_s), task.prediction)) {
        intake_.refuseStamp();
        continue;
      }
      task.T_cog_lidar = T_base_cog_.inverse() * lidar_.T_base_lidar();
      task.lidar_frame = header.frame_id;
      header.frame_id = params_.odom_frame;
      open_ = header;
      arrived_at_ = next->arrived;
      opened_at_ = ros::SteadyTime::now();
      prediction_ = task.prediction;
      // the first sweep has nothing to search a motion with
      searches_ = !task.prediction.motion_known && !task.first();
      sources_->open(header.stamp, longest_s());
      prediction_publisher_.publish(messages::SweepPredictionConstPtr(
          boost::make_shared<messages::SweepPrediction>(toMessage(task, header, last_stamp_))));
      if (sources_->allAnswered()) close();
    }
  }

  void onAnswer() {
    if (!open_ || !sources_->allAnswered()) return;
    close();
    opening_->request();
  }

  void onTick() {
    if (!held_.empty() && lidar_.find(held_.back().frame_id) == LidarPlace::Answer::kKnown) releaseHeld();
    checkDeadline();
  }

  void checkDeadline() {
    if (!open_ || !(isOverdue() || sources_->allAnswered())) return;
    close();
    opening_->request();
  }

  /// More patience with those that are at work: a late estimate is better than none. But what a sweep has waited for its
  /// turn is taken off it, or under load each would be later by that.
  bool isOverdue() const {
    const ros::SteadyTime now = ros::SteadyTime::now();
    const double open_s = (now - opened_at_).toSec();
    if (open_s < params_.deadline_s) return false;
    if (!sources_->isAtWork(!searches_)) return true;
    return searches_ ? open_s >= params_.first_deadline_s : (now - arrived_at_).toSec() >= params_.late_deadline_s;
  }

  /// The open sweep's if nothing came before it: an answer that takes longer than this gains nothing.
  double longest_s() const {
    return std::max(params_.deadline_s, searches_ ? params_.first_deadline_s : params_.late_deadline_s);
  }

  void close() {
    const std_msgs::Header header = *open_;
    open_.reset();
    SweepAccount account = sources_->close(prediction_, T_base_cog_);
    account.dropped_before = intake_.takeDropped();
    std::vector<FusionInput> inputs;
    for (const SweepAccount::Source& source : account.sources) {
      inputs.push_back({source.name, source.measurement ? &*source.measurement : nullptr, source.external});
    }
    const Pose T_odom_cog_previous = filter_->state().T_odom_cog;
    const FilterState& state = filter_->correct(inputs, account.findings ? account.findings->middle_s : 0.0);
    if (account.findings) sweep_clock_.observeRevolution(account.findings->revolution_s);
    if (state.dt_s > 0.0 &&
        !odometry_covariance_.propagate(T_odom_cog_previous, state.T_odom_cog, incrementOf(state))) {
      NODELET_ERROR_THROTTLE(1.0, "increment or its covariance not finite: odometry's covariance goes without it");
    }
    if (pose_setting_.pending() && (state.dt_s <= 0.0 || prediction_.motion_known)) setPose();
    ++counts_.sweeps;
    if (!state.corrected && state.dt_s > 0.0) ++counts_.predicted_only;
    last_corrected_ = state.corrected;
    last_stamp_ = header.stamp;
    publish(state, account, header);
    rate_.tick();
    latency_s_ = (ros::SteadyTime::now() - arrived_at_).toSec();
  }

  void publish(const FilterState& state, const SweepAccount& account, const std_msgs::Header& header) {
    output_->record(state);  // before anybody hears of it, and asks for it
    state_publisher_.publish(
        messages::FilterStateConstPtr(boost::make_shared<messages::FilterState>(toMessage(state, account, header))));
    output_->publish(filter_->stateAsDriven(), odometry_covariance_.covariance(), header);
  }

  // ---- set_pose -----------------------------------------------------------------------------------------------------

  void onSetPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& message) {
    refusePose(pose_setting_.offer(*message, params_.odom_frame, last_stamp_));
  }

  void refusePose(const std::string& reason) {
    if (reason.empty()) return;
    ++counts_.poses_refused;
    NODELET_WARN("set_pose refused: %s", reason.c_str());
  }

  void setPose() {
    const std::string outdated = pose_setting_.outdated(filter_->state());
    if (!outdated.empty()) return refusePose(outdated);
    const PoseSetting::AtEstimate set = pose_setting_.take(filter_->stateAsDriven(), T_base_cog_);
    if (!filter_->setPose(set.T_odom_cog)) return refusePose("the filter cannot stand there");
    odometry_covariance_.reset(set.covariance + startCovariance());
    sources_->forgetPoses();
    ++counts_.poses_set;
    const Eigen::Vector3d position = (set.T_odom_cog * T_base_cog_.inverse()).translation();
    NODELET_INFO("pose set to x %.3f y %.3f z %.3f m", position.x(), position.y(), position.z());
  }

  // ---- the rest -----------------------------------------------------------------------------------------------------

  /// No pose is known better: a covariance that is published is positive definite, whatever set_pose says.
  Matrix6d startCovariance() const { return start_sigmas_.cwiseAbs2().asDiagonal(); }

  /// The next sweep is the first; it tells the other nodelets so by its dt of 0.
  void reset() {
    filter_->reset(T_base_cog_);  // odom begins at base_link
    odometry_covariance_.reset(startCovariance());
    intake_.clear(open_.has_value());
    sweep_clock_.reset();
    open_.reset();
    counts_.no_transform += held_.size();
    held_.clear();
    if (pose_setting_.pending()) refusePose("a new drive began before it could be set");
    pose_setting_.clear();
    sources_->reset();
    output_->clear();
    last_stamp_ = ros::Time();
    if (counts_.sweeps > 0) ++counts_.resets;
  }

  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    reset();
    response.success = true;
    response.message = "the next sweep is the first";
    return true;
  }

  static double secondsSince(const ros::SteadyTime& then) { return (ros::SteadyTime::now() - then).toSec(); }

  std::string noUsableCloud() const { return "no cloud that can be used: " + intake_.lastRefused(); }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const std::string absent = sources_->absent();
    const std::string clock_fault = clock_.fault();
    if (secondsSince(loaded_at_) > kStarts_s) faults_.say("clock", clock_fault);
    if (!lidar_.known() && missing_transform_) {
      status.summary(Level::ERROR, lidar_.fault());
      faults_.say("transform", lidar_.fault());
    } else if (heard_at_.isZero()) {
      const std::string topic = cloud_subscriber_.getTopic(), type = publishedType(topic);
      status.summary(Level::WARN, whyNoCloud(topic, type));
      if (isAnotherType(type) && secondsSince(loaded_at_) > kStarts_s) faults_.say("no cloud", status.message);
    } else if (counts_.sweeps == 0) {
      status.summary(Level::WARN, intake_.lastRefused().empty() ? "no sweep yet" : noUsableCloud());
    } else if (const double silent_s = secondsSince(heard_at_); silent_s > kSilent_s) {
      status.summaryf(Level::WARN, "no cloud for %.0f s", silent_s);
    } else if (!open_ && secondsSince(arrived_at_) > kSilent_s) {
      status.summary(Level::WARN, noUsableCloud());
    } else if (!absent.empty()) {
      status.summary(Level::WARN, "no answer from" + absent);
    } else if (!clock_fault.empty()) {
      status.summary(Level::WARN, clock_fault);
    } else if (!last_corrected_ && counts_.sweeps > 1) {
      status.summary(Level::WARN, "prediction only");
    } else {
      status.summary(Level::OK, "running");
    }
    status.addf("rate (Hz)", "%.2f", rate_.take_hz());
    status.addf("from cloud to estimate (ms)", "%.1f", 1e3 * latency_s_);
    if (!last_stamp_.isZero()) {
      status.addf("age of the last estimate (s)", "%.3f", secondsFrom(last_stamp_, ros::Time::now()));
    }
    status.add("sweeps", counts_.sweeps);
    status.add("sweeps without a usable measurement", counts_.predicted_only);
    status.addf("period of the head (ms)", "%.3f", 1e3 * sweep_clock_.period_s().value_or(0.0));
    status.addf("jitter of the stamps (ms)", "%.3f", 1e3 * sweep_clock_.jitter_s().value_or(0.0));
    status.add("stamps that the period contradicts", sweep_clock_.outliers());
    const SweepIntake::Counts& dropped = intake_.counts();
    const std::pair<std::string, std::size_t> causes[] = {{"overload", dropped.overload},
                                                          {"duplicate stamp", dropped.duplicate},
                                                          {"stamp out of order", dropped.reordered},
                                                          {"stamp far ahead", dropped.far_ahead},
                                                          {"stamp not usable", dropped.unusable_stamp},
                                                          {"frame is not " + lidar_.lidarFrame(), dropped.wrong_frame},
                                                          {"no transform", counts_.no_transform}};
    for (const auto& [cause, count] : causes) {
      status.add("dropped: " + cause, count);
      faults_.count("clouds dropped: " + cause, count);
    }
    status.add("dropped: by a reset", dropped.reset);
    status.add("resets", counts_.resets);
    status.add("resets because stamps jumped", counts_.time_jumps);
    status.add("poses set", counts_.poses_set);
    status.add("poses refused (set_pose)", counts_.poses_refused);
    sources_->diagnose(status);
    if (!reconfiguration_->refused().empty()) status.add("reconfiguration refused", reconfiguration_->refused());
  }

  FusionUkfNodeletParams params_;
  Pose T_base_cog_ = Pose::Identity();
  Vector6d start_sigmas_ = Vector6d::Zero();  ///< m, rad
  std::unique_ptr<PoseFilter> filter_;
  OdometryCovariance odometry_covariance_;

  LidarPlace lidar_;

  SweepIntake intake_;
  SweepClock sweep_clock_;
  std::deque<std_msgs::Header> held_;     ///< clouds that wait for the lidar's place
  bool missing_transform_ = false;        ///< some cloud did
  std::optional<std_msgs::Header> open_;  ///< frame: odom
  SweepPrediction prediction_;            ///< of the open sweep
  PoseSetting pose_setting_;
  bool last_corrected_ = false;
  ros::Time last_stamp_;             ///< closed
  bool searches_ = false;            ///< the open sweep, for the first motion
  ClockCheck clock_;                 ///< of the clouds
  SpokenFaults faults_{"odometry"};  ///< in the log
  ros::SteadyTime loaded_at_;
  ros::SteadyTime heard_at_;                ///< the last cloud, whatever became of it
  ros::SteadyTime arrived_at_, opened_at_;  ///< the open sweep's cloud, itself
  double latency_s_ = 0.0;                  ///< of the last estimate
  RateMeter rate_;
  std::unique_ptr<OdometryOutput> output_;
  Counts counts_;

  ros::Publisher prediction_publisher_, state_publisher_;
  // What calls back is destroyed first, and waits for a call that is under way.
  std::unique_ptr<MeasurementSources> sources_;
  std::unique_ptr<Reconfiguration<Config, FusionUkfTuning>> reconfiguration_;
  std::unique_ptr<DeferredCall> opening_;
  ros::Subscriber cloud_subscriber_, set_pose_subscriber_;
  ros::ServiceServer reset_service_;
  ros::SteadyTimer deadline_timer_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::FusionUkfNodelet, nodelet::Nodelet)
