// The estimator in the live graph (core/estimator.hpp).
// In: points (it uses only header and frame), sweep/check, measurement/*, extra sources, set_pose. Out:
// sweep/prediction, filter_state, odometry, path, tf. Services: ~reset, ~save_trajectory.
//
// One sweep is open at a time. It is predicted when its cloud arrives, and closed when every expected source has
// answered or at its deadline. Sweeps that arrive meanwhile wait in a short queue. Every opened sweep gives exactly one
// filter_state and one odometry; every other cloud is counted in a diagnostic by its cause.
#include "fail_aware_lidar_odometry/FusionUkfConfig.h"
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/graph_message_conversion.hpp"
#include "bridge/parameter_server.hpp"
#include "cloud_intake.hpp"
#include "core/estimation/sweep_scheduler.hpp"
#include "core/estimator.hpp"
#include "core/parameters/mounting.hpp"
#include "deferred_call.hpp"
#include "fusion_diagnosis.hpp"
#include "fusion_output.hpp"
#include "fusion_ukf_params.hpp"
#include "graph_nodelet.hpp"
#include "measurement_sources.hpp"
#include "private_parameters.hpp"
#include "reconfiguration.hpp"
#include "set_pose_input.hpp"
#include "stamps.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class FusionUkfNodelet : public GraphNodelet {
 public:
  ~FusionUkfNodelet() override {
    if (sources_) sources_->stopListening();  // sources_ and opening_ call each other
  }

 private:
  using Config = fail_aware_lidar_odometry::FusionUkfConfig;
  using Cause = SweepScheduler::Cause;

  static constexpr std::uint32_t kCloudQueue = 50;  ///< large, because roscpp drops silently; the scheduler counts
  static constexpr double kDeadlineCheck_s = 0.01;

  void load() override {
    ros::NodeHandle& node = getNodeHandle();
    ros::NodeHandle& private_node = getPrivateNodeHandle();
    FusionUkfNodeletParams params;
    readPrivateParameters(private_node, params, FusionUkfTuning(), {"extra_sources."});
    validate(params);
    const PipelineParameters pipeline = readPipelineParameters(node);
    const FusionUkfTuning tuning{params, pipeline.profile.registration, pipeline.profile.fusion};
    T_base_cog_ = pipeline.vehicle.T_base_cog();
    if (params.lidar_in_base_source == "parameter") {
      clouds_.lidar().use(pipeline.sensor.T_base_lidar());
      const std::string fault = placeholderFault(pipeline.sensor.lidar_in_base);
      if (!fault.empty()) ROS_WARN("fusion_ukf: %s", fault.c_str());
    } else {
      clouds_.lidar().useTransforms(params.base_frame);
    }
    estimator_ = std::make_unique<Estimator>(pipeline);
    sources_ = std::make_unique<MeasurementSources>(node, readExtraSources(private_node), params.odom_frame,
                                                    *estimator_, [this] { onAnswer(); });
    warnOfOtherValues(private_node, params, tuning);
    diagnosis_ = std::make_unique<FusionDiagnosis>(node.resolveName(topics::kClouds), clouds_, scheduler_, *sources_,
                                                   *estimator_);
    output_ = std::make_unique<FusionOutput>(node, private_node, params, T_base_cog_);
    tune(tuning);
    // From here on other threads may call; everything that they use exists.
    opening_ = std::make_unique<DeferredCall>(node, [this] { openNext(); });
    set_pose_ = std::make_unique<SetPoseInput>(node, getName(), params.odom_frame, T_base_cog_, *estimator_);
    reconfiguration_ = std::make_unique<Reconfiguration<Config, FusionUkfTuning>>(
        private_node, tuning, [this](const FusionUkfTuning& changed) { tune(changed); });
    sources_->listen();
    reset_service_ = private_node.advertiseService("reset", &FusionUkfNodelet::onReset, this);
    deadline_timer_ =
        node.createSteadyTimer(ros::WallDuration(kDeadlineCheck_s), [this](const ros::SteadyTimerEvent&) { onTick(); });
    cloud_subscriber_ = node.subscribe(topics::kClouds, kCloudQueue, &FusionUkfNodelet::onCloud, this);
    health_ = reportHealth("odometry");
  }

  void tune(const FusionUkfTuning& tuning) {
    estimator_->setFusion(tuning.fusion);
    estimator_->setMaxReorder(tuning.node.max_reorder_s);
    scheduler_.setParams({static_cast<std::size_t>(tuning.node.queue_size), tuning.node.deadline_s,
                          tuning.node.late_deadline_s, tuning.node.first_deadline_s});
    sources_->setAbsentAfter(tuning.node.absent_after_sweeps);
    sources_->use(kIcpPointToPoint, tuning.registration.use_icp_point_to_point);
    sources_->use(kIcpPointToPlane, tuning.registration.use_icp_point_to_plane);
    sources_->use(kCornerSvd, tuning.registration.use_corner_svd);
  }

  // ---- selection of clouds ------------------------------------------------------------------------------------------

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) { clouds_.take(cloud->header); }

  void accept(const std_msgs::Header& header) {
    if (!isUsableStamp(header.stamp)) return scheduler_.refuse(Cause::kUnusableStamp);
    const double stamp_s = header.stamp.toSec(), since_newest_s = estimator_->sinceNewest_s(stamp_s);
    const Estimator::Accepted accepted = estimator_->accept(stamp_s);
    switch (accepted.order) {
      case StampOrder::kAdvances: break;
      case StampOrder::kSame: return scheduler_.refuse(Cause::kDuplicate);
      case StampOrder::kReordered:
      case StampOrder::kFarBack: return scheduler_.refuse(Cause::kReordered);
      case StampOrder::kFarAhead: return scheduler_.refuse(Cause::kFarAhead);
      case StampOrder::kJumpedBack:
      case StampOrder::kJumpedAhead: diagnosis_->jumped(since_newest_s); beginDrive();
    }
    scheduler_.offer({header.stamp.toNSec(), header.frame_id, steadySeconds(), accepted.set_back_s});
    opening_->request();  // after all waiting clouds were offered
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
      task.T_cog_lidar = T_base_cog_.inverse() * clouds_.lidar().T_base_lidar();
      task.lidar_frame = sweep->frame;
      // the first sweep has no reference to search a motion with
      scheduler_.setSearches(!task.prediction.motionKnown() && !task.first());
      sources_->open(stamp, scheduler_.longest_s());
      output_->publishPrediction(task, stamp);
      if (sources_->allAnswered()) close();
    }
  }

  void onAnswer() {
    if (scheduler_.current() && sources_->allAnswered()) closeAndGoOn();
  }

  void onTick() {
    clouds_.retry();
    if (!scheduler_.current()) return;
    const bool is_at_work = sources_->isAtWork(!scheduler_.searches());
    if (scheduler_.isOverdue(steadySeconds(), is_at_work) || sources_->allAnswered()) closeAndGoOn();
  }

  void closeAndGoOn() {
    close();
    opening_->request();
  }

  void close() {
    const SweepScheduler::Sweep sweep = *scheduler_.current();
    scheduler_.close();
    SweepAccount account = sources_->close();
    account.dropped_before = scheduler_.takeDropped();
    std::vector<FusionInput> inputs;
    for (const SweepAccount::Source& source : account.sources) {
      inputs.push_back({source.name, source.measurement ? &*source.measurement : nullptr, source.kind});
    }
    estimator_->update(inputs, account.findings.value_or(SweepFindings()));
    sources_->addPoses(estimator_->externalMeasurements(), account);
    if (!estimator_->covarianceIsWhole()) {
      NODELET_ERROR_THROTTLE(1.0, "increment or its covariance not finite: the odometry's covariance leaves it out");
    }
    set_pose_->report();
    const ros::Time stamp = ros::Time().fromNSec(sweep.stamp_ns);
    output_->publishEstimate(*estimator_, account, stamp);
    diagnosis_->closed(stamp, sweep.arrived_s);
  }

  // ---- a new drive --------------------------------------------------------------------------------------------------

  /// Clears what belongs to the last drive; the estimator has already begun a new one.
  void beginDrive() {
    set_pose_->report();
    scheduler_.clear();
    clouds_.clear();
    sources_->reset();
    output_->clear();
    diagnosis_->newDrive();
  }

  /// The next sweep is the first, at odom's origin; its dt of 0 tells the other nodelets.
  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    estimator_->reset();
    beginDrive();
    response.success = true;
    response.message = "the next sweep is the first";
    return true;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    diagnosis_->diagnose(status);
    set_pose_->diagnose(status);
    sources_->diagnose(status);
    reconfiguration_->diagnose(status);
  }

  static double steadySeconds() { return ros::SteadyTime::now().toSec(); }

  Pose T_base_cog_ = Pose::Identity();
  SweepScheduler scheduler_;
  CloudIntake clouds_{scheduler_, [this](const std_msgs::Header& header) { accept(header); }};
  std::unique_ptr<Estimator> estimator_;
  std::unique_ptr<FusionOutput> output_;
  std::unique_ptr<FusionDiagnosis> diagnosis_;
  // Members with callbacks come last: they are destroyed first, and their destructors wait for running callbacks.
  std::unique_ptr<SetPoseInput> set_pose_;
  std::unique_ptr<MeasurementSources> sources_;
  std::unique_ptr<Reconfiguration<Config, FusionUkfTuning>> reconfiguration_;
  std::unique_ptr<DeferredCall> opening_;
  ros::Subscriber cloud_subscriber_;
  ros::ServiceServer reset_service_;
  ros::SteadyTimer deadline_timer_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::FusionUkfNodelet, nodelet::Nodelet)
