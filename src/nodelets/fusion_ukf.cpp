// The estimator in the live graph (core/estimator.hpp).
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
#include "fail_aware_lidar_odometry/core/estimator.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_clock.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_scheduler.hpp"
#include "fusion_ukf_params.hpp"
#include "health.hpp"
#include "lidar_place.hpp"
#include "load_or_say_why.hpp"
#include "measurement_sources.hpp"
#include "odometry_output.hpp"
#include "open_queue.hpp"
#include "pose_message.hpp"
#include "private_parameters.hpp"
#include "published_type.hpp"
#include "rate_meter.hpp"
#include "reconfiguration.hpp"
#include "spoken_faults.hpp"
#include "stamps.hpp"
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
  using Cause = SweepScheduler::Cause;

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
    T_base_cog_ = pipeline.vehicle.T_base_cog();
    loaded_at_ = ros::SteadyTime::now();
    estimator_ = std::make_unique<Estimator>(pipeline);
    sources_ = std::make_unique<MeasurementSources>(node, readExtraSources(private_node), params_.odom_frame,
                                                    *estimator_, [this] { onAnswer(); });
    const FusionUkfTuning tuning{params_, pipeline.profile.registration, pipeline.profile.fusion};
    warnOfOtherValues(private_node, params_, tuning);
    tune(tuning);
    output_ = std::make_unique<OdometryOutput>(node, private_node, params_, T_base_cog_);
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
    estimator_->setFusion(tuning.fusion);
    estimator_->setMaxReorder(params_.max_reorder_s);
    scheduler_.setParams({static_cast<std::size_t>(params_.queue_size), params_.deadline_s, params_.late_deadline_s,
                          params_.first_deadline_s});
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
      case LidarPlace::Answer::kOtherFrame: scheduler_.refuse(Cause::kWrongFrame); return;
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
        scheduler_.refuse(Cause::kWrongFrame);
      }
    }
  }

  void accept(const std_msgs::Header& header) {
    if (!isUsable(header.stamp)) return scheduler_.refuse(Cause::kUnusableStamp);
    const double stamp_s = header.stamp.toSec(), since_newest_s = estimator_->sinceNewest_s(stamp_s);
    const Estimator::Accepted accepted = estimator_->accept(stamp_s);
    switch (accepted.order) {
      case StampOrder::kAdvances: break;
      case StampOrder::kSame: return scheduler_.refuse(Cause::kDuplicate);
      case StampOrder::kReordered: return scheduler_.refuse(Cause::kReordered);
      case StampOrder::kFarAhead: return scheduler_.refuse(Cause::kFarAhead);
      case StampOrder::kJumpedBack:
      case StampOrder::kJumpedAhead:
        faults_.say("jump", "stamps jumped by " + std::to_string(since_newest_s) + " s: a new drive begins");
        ++counts_.time_jumps;
        beginDrive();
    }
    scheduler_.offer({header.stamp.toNSec(), header.frame_id, steadySeconds(), accepted.set_back_s});
    opening_->request();  // once all the clouds that are here were offered
  }

  // ---- one sweep ----------------------------------------------------------------------------------------------------

  void openNext() {
    while (const std::optional<SweepScheduler::Sweep> sweep = scheduler_.open(steadySeconds())) {
      SweepTask task;
      const ros::Time stamp = ros::Time().fromNSec(sweep->stamp_ns);
      if (!estimator_->predict(stamp.toSec(), sweep->set_back_s, task.prediction)) {
        scheduler_.close();
        scheduler_.refuse(Cause::kUnusableStamp);
        continue;
      }
      task.T_cog_lidar = T_base_cog_.inverse() * lidar_.T_base_lidar();
      task.lidar_frame = sweep->frame;
      prediction_ = task.prediction;
      // the first sweep has nothing to search a motion with
      scheduler_.setSearches(!task.prediction.motionKnown() && !task.first());
      sources_->open(stamp, scheduler_.longest_s());
      prediction_publisher_.publish(messages::SweepPredictionConstPtr(
          boost::make_shared<messages::SweepPrediction>(toMessage(task, odomHeader(stamp), last_stamp_))));
      if (sources_->allAnswered()) close();
    }
  }

  void onAnswer() {
    if (!scheduler_.current() || !sources_->allAnswered()) return;
    close();
    opening_->request();
  }

  void onTick() {
    if (!held_.empty() && lidar_.find(held_.back().frame_id) == LidarPlace::Answer::kKnown) releaseHeld();
    const bool is_at_work = sources_->isAtWork(!scheduler_.searches());
    if (!scheduler_.current() || !(scheduler_.isOverdue(steadySeconds(), is_at_work) || sources_->allAnswered()))
      return;
    close();
    opening_->request();
  }

  void close() {
    const SweepScheduler::Sweep sweep = *scheduler_.current();
    scheduler_.close();
    const std_msgs::Header header = odomHeader(ros::Time().fromNSec(sweep.stamp_ns));
    SweepAccount account = sources_->close();
    account.dropped_before = scheduler_.takeDropped();
    std::vector<FusionInput> inputs;
    for (const SweepAccount::Source& source : account.sources) {
      inputs.push_back({source.name, source.measurement ? &*source.measurement : nullptr, source.external});
    }
    const SweepFindings found = account.findings.value_or(SweepFindings());
    const FilterState& state = estimator_->update(inputs, found.middle_s, found.revolution_s);
    sources_->addPoses(estimator_->externalMeasurements(), account);
    if (!estimator_->covarianceIsWhole()) {
      NODELET_ERROR_THROTTLE(1.0, "increment or its covariance not finite: odometry's covariance goes without it");
    }
    reportSetPose(state);
    ++counts_.sweeps;
    if (!state.corrected && state.dt_s > 0.0) ++counts_.predicted_only;
    last_corrected_ = state.corrected;
    last_stamp_ = header.stamp;
    arrived_s_ = sweep.arrived_s;
    publish(state, account, header);
    rate_.tick();
    latency_s_ = steadySeconds() - arrived_s_;
  }

  void publish(const FilterState& state, const SweepAccount& account, const std_msgs::Header& header) {
    output_->record(state);  // before anybody hears of it, and asks for it
    state_publisher_.publish(
        messages::FilterStateConstPtr(boost::make_shared<messages::FilterState>(toMessage(state, account, header))));
    output_->publish(estimator_->stateAsDriven(), estimator_->odometryCovariance(), header);
  }

  std_msgs::Header odomHeader(const ros::Time& stamp) const {
    std_msgs::Header header;
    header.stamp = stamp;
    header.frame_id = params_.odom_frame;
    return header;
  }

  // ---- set_pose -----------------------------------------------------------------------------------------------------

  void onSetPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& message) {
    std::string reason;
    const std::optional<ExternalPose> pose = poseInOdom(*message, params_.odom_frame, reason);
    refusePose(pose ? estimator_->setPose(*pose) : reason);
  }

  void refusePose(const std::string& reason) {
    if (reason.empty()) return;
    ++counts_.poses_refused;
    NODELET_WARN("set_pose refused: %s", reason.c_str());
  }

  void reportSetPose(const FilterState& state) {
    refusePose(estimator_->poseSet().refused);
    if (!estimator_->poseSet().done) return;
    ++counts_.poses_set;
    const Eigen::Vector3d position = (state.T_odom_cog * T_base_cog_.inverse()).translation();
    NODELET_INFO("pose set to x %.3f y %.3f z %.3f m", position.x(), position.y(), position.z());
  }

  // ---- the rest -----------------------------------------------------------------------------------------------------

  /// What belongs to the last drive goes; the estimator has begun another.
  void beginDrive() {
    refusePose(estimator_->poseSet().refused);
    scheduler_.clear();
    counts_.no_transform += held_.size();
    held_.clear();
    sources_->reset();
    output_->clear();
    last_stamp_ = ros::Time();
    if (counts_.sweeps > 0) ++counts_.resets;
  }

  /// The next sweep is the first, at odom's origin; it tells the other nodelets so by its dt of 0.
  void reset() {
    estimator_->reset();
    beginDrive();
  }

  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    reset();
    response.success = true;
    response.message = "the next sweep is the first";
    return true;
  }

  static double secondsSince(const ros::SteadyTime& then) { return (ros::SteadyTime::now() - then).toSec(); }
  static double steadySeconds() { return ros::SteadyTime::now().toSec(); }

  /// Not at the end of time: others add to stamps (tf2: 10 s), which throws there.
  static bool isUsable(const ros::Time& stamp) {
    constexpr std::uint32_t kHour_s = 3600;
    return !stamp.isZero() && stamp.nsec < 1000000000u && stamp.sec < ros::TIME_MAX.sec - kHour_s;
  }

  std::string noUsableCloud() const { return "no cloud that can be used: " + scheduler_.lastRefused(); }

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
      status.summary(Level::WARN, scheduler_.lastRefused().empty() ? "no sweep yet" : noUsableCloud());
    } else if (const double silent_s = secondsSince(heard_at_); silent_s > kSilent_s) {
      status.summaryf(Level::WARN, "no cloud for %.0f s", silent_s);
    } else if (!scheduler_.current() && steadySeconds() - arrived_s_ > kSilent_s) {
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
    const SweepClock& clock = estimator_->sweepClock();
    status.addf("period of the head (ms)", "%.3f", 1e3 * clock.period_s().value_or(0.0));
    status.addf("jitter of the stamps (ms)", "%.3f", 1e3 * clock.jitter_s().value_or(0.0));
    status.add("stamps that the period contradicts", clock.outliers());
    const SweepScheduler::Counts& dropped = scheduler_.counts();
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
  std::unique_ptr<Estimator> estimator_;

  LidarPlace lidar_;

  SweepScheduler scheduler_;
  std::deque<std_msgs::Header> held_;  ///< clouds that wait for the lidar's place
  bool missing_transform_ = false;     ///< some cloud did
  SweepPrediction prediction_;         ///< of the open sweep
  bool last_corrected_ = false;
  ros::Time last_stamp_;             ///< closed
  ClockCheck clock_;                 ///< of the clouds
  SpokenFaults faults_{"odometry"};  ///< in the log
  ros::SteadyTime loaded_at_;
  ros::SteadyTime heard_at_;  ///< the last cloud, whatever became of it
  double arrived_s_ = 0.0;    ///< the last estimate's cloud, by the steady clock
  double latency_s_ = 0.0;    ///< of the last estimate
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
