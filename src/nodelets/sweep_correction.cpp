// Sweep correction in the live graph (core/sweep/sweep_corrector.hpp).
// In: points (any PointCloud2), sweep/prediction of the same stamp. Out: sweep/points, one for every prediction whose
// cloud is there; without points where the cloud could not be read, so that the sweep still closes.
#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <memory>

#include "exact_stamp_buffer.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_corrector.hpp"

namespace fail_aware {

class SweepCorrectionNodelet : public nodelet::Nodelet {
 private:
  static constexpr std::uint32_t kQueue = 8;

  void onInit() override {
    ros::NodeHandle& node = getNodeHandle();
    const PipelineParameters params = readPipelineParameters(node);
    corrector_ = std::make_unique<SweepCorrector>(params.sensor.vertical_angle, params.sensor.timing,
                                                  params.profile.sweep_correction,
                                                  params.profile.level_keeping);
    updater_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    updater_->setHardwareID("none");
    updater_->add("sweep_correction", this, &SweepCorrectionNodelet::diagnose);
    publisher_ = node.advertise<sensor_msgs::PointCloud2>("sweep/points", kQueue);
    prediction_subscriber_ = node.subscribe("sweep/prediction", kQueue, &SweepCorrectionNodelet::onPrediction, this);
    cloud_subscriber_ = node.subscribe("points", kQueue, &SweepCorrectionNodelet::onCloud, this);
  }

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    clouds_.push(cloud->header.stamp, cloud);
    advance(cloud->header.stamp);
  }

  void onPrediction(const messages::SweepPredictionConstPtr& prediction) {
    predictions_.push(prediction->header.stamp, prediction);
    advance(prediction->header.stamp);
  }

  void advance(const ros::Time& stamp) {
    const sensor_msgs::PointCloud2ConstPtr* cloud = clouds_.find(stamp);
    const messages::SweepPredictionConstPtr* prediction = predictions_.find(stamp);
    if (cloud == nullptr || prediction == nullptr) return;
    if (const std::optional<SweepTask> task = fromMessage(**prediction)) correct(**cloud, *task);
    unmatched_ += clouds_.popThrough(stamp);
    predictions_.popThrough(stamp);
  }

  void correct(const sensor_msgs::PointCloud2& cloud, const SweepTask& task) {
    if (task.first()) corrector_->reset();
    const CloudReadResult read = readCloud(cloud, sweep_);
    if (!read.ok()) {
      ++refused_;
      last_reason_ = read.reason;
    }
    report_ = corrector_->correct(sweep_, task.prediction, task.T_cog_lidar, corrected_);
    const auto message = boost::make_shared<sensor_msgs::PointCloud2>();
    writeCloud(corrected_, sweep_.intensities, *message);
    message->header = cloud.header;
    publisher_.publish(sensor_msgs::PointCloud2ConstPtr(message));
    ++sweeps_;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    if (refused_ > refused_reported_) {
      status.summary(Level::WARN, "clouds without usable points: " + last_reason_);
    } else {
      status.summary(Level::OK, sweeps_ == 0 ? "no sweep yet" : "correcting");
    }
    refused_reported_ = refused_;
    status.add("sweeps", sweeps_);
    status.add("clouds without usable points", refused_);
    status.add("clouds without a prediction", unmatched_);
    status.add("timing source", toString(report_.timing.source));
    status.add("stamp reference", toString(report_.timing.reference));
    status.add("time field", toString(report_.timing.field));
    status.add("correction", toString(report_.correction.status));
  }

  std::unique_ptr<SweepCorrector> corrector_;
  std::unique_ptr<diagnostic_updater::Updater> updater_;
  ros::Publisher publisher_;
  ros::Subscriber cloud_subscriber_, prediction_subscriber_;
  ExactStampBuffer<sensor_msgs::PointCloud2ConstPtr> clouds_{kQueue};
  ExactStampBuffer<messages::SweepPredictionConstPtr> predictions_{kQueue};
  Sweep sweep_;
  CorrectedSweep corrected_;
  SweepCorrectorReport report_;
  std::string last_reason_;
  std::size_t sweeps_ = 0, refused_ = 0, refused_reported_ = 0, unmatched_ = 0;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::SweepCorrectionNodelet, nodelet::Nodelet)
