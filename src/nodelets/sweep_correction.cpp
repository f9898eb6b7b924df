// Sweep correction in the live graph (core/preprocessing/sweep_corrector.hpp).
// In: points (any PointCloud2), sweep/prediction of the same stamp. Out: sweep/points, one per prediction whose cloud
// arrived, without points if the cloud was not readable, so that the sweep still closes; and sweep/check, the findings
// about the raw sweep (core/preprocessing/sweep_check.hpp).
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <boost/make_shared.hpp>
#include <memory>
#include <optional>
#include <utility>

#include "bridge/graph_message_conversion.hpp"
#include "bridge/parameter_server.hpp"
#include "core/preprocessing/sweep_check.hpp"
#include "core/preprocessing/sweep_corrector.hpp"
#include "core/types/corrected_sweep.hpp"
#include "correction_diagnosis.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "graph_nodelet.hpp"
#include "predicted_clouds.hpp"
#include "private_parameters.hpp"
#include "topics.hpp"

namespace fail_aware {

class SweepCorrectionNodelet : public GraphNodelet {
 private:
  void load() override {
    ros::NodeHandle& node = getNodeHandle();
    NoOwnParams none;
    readPrivateParameters(getPrivateNodeHandle(), none, NoTuning());
    const PipelineParameters params = readPipelineParameters(node);
    corrector_ = std::make_unique<SweepCorrector>(params.sensor.vertical_angle, params.sensor.azimuth,
                                                  params.sensor.correctedTiming(), params.profile.sweep_correction,
                                                  params.profile.vertical_reference);
    check_ = std::make_unique<SweepCheck>(params.sensor.check);
    diagnosis_ = std::make_unique<CorrectionDiagnosis>(params.sensor.timing);
    publisher_ = node.advertise<sensor_msgs::PointCloud2>(topics::kSweepPoints, topics::kQueue);
    check_publisher_ = node.advertise<messages::SweepCheck>(topics::kSweepCheck, topics::kQueue);
    prediction_subscriber_ =
        node.subscribe(topics::kSweepPrediction, topics::kQueue, &SweepCorrectionNodelet::onPrediction, this);
    cloud_subscriber_ = node.subscribe(topics::kClouds, topics::kQueue, &SweepCorrectionNodelet::onCloud, this);
    health_ = reportHealth("sweep_correction");
  }

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    diagnosis_->heard(cloud->header.stamp);
    correct(inputs_.add(cloud));
  }

  void onPrediction(const messages::SweepPredictionConstPtr& prediction) {
    const bool begins = !(prediction->dt > 0.0);  // a drive, even if this sweep's cloud does not arrive
    if (begins) corrector_->reset();
    if (begins && std::exchange(drives_, false)) check_->beginDrive();  // not for each sweep before a drive's first
    drives_ = !begins;
    diagnosis_->predicted();
    correct(inputs_.add(prediction));
  }

  void correct(const std::optional<PredictedClouds::Pair>& pair) {
    const std::optional<SweepTask> task = pair ? fromMessage(*pair->prediction) : std::nullopt;
    if (task) correct(*pair->cloud, *task);
  }

  void correct(const sensor_msgs::PointCloud2& cloud, const SweepTask& task) {
    const CloudReadResult read = readCloud(cloud, sweep_);
    SweepFindings findings = check_->check(sweep_);
    const SweepCorrectorReport report = corrector_->correct(sweep_, task.prediction, task.T_cog_lidar, corrected_);
    report.addTo(findings);
    check_publisher_.publish(messages::SweepCheckConstPtr(
        boost::make_shared<messages::SweepCheck>(toMessage(findings, sweep_.size(), cloud.header))));
    if (isLeftOut(findings, task.first())) corrected_.clear();
    const auto message = boost::make_shared<sensor_msgs::PointCloud2>();
    writeCloud(corrected_, sweep_.intensities, *message);
    message->header = cloud.header;
    publisher_.publish(sensor_msgs::PointCloud2ConstPtr(message));
    diagnosis_->add(cloud.header.stamp, read, sweep_, findings, report);
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    diagnosis_->diagnose(status, corrector_->seamContradiction(), inputs_.unmatched());
  }

  PredictedClouds inputs_;
  std::unique_ptr<SweepCheck> check_;
  std::unique_ptr<SweepCorrector> corrector_;
  std::unique_ptr<CorrectionDiagnosis> diagnosis_;
  bool drives_ = false;
  Sweep sweep_;  ///< this and corrected_: reuse their memory
  CorrectedSweep corrected_;
  ros::Publisher publisher_, check_publisher_;
  // Members with callbacks come last: they are destroyed first, and their destructors wait for running callbacks.
  ros::Subscriber cloud_subscriber_, prediction_subscriber_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::SweepCorrectionNodelet, nodelet::Nodelet)
