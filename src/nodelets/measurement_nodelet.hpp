// Base of the three measurement nodelets. In: sweep/points, sweep/prediction, filter_state (exactly the same stamps).
// Out: measurement/NAME, at most one message a sweep; likewise the algorithm's partial measurements.
//
// A sweep is measured when its points and its prediction are there and the reference contains the previous sweep at its
// filter state. The filter state of a measured sweep updates the reference, even if the measurement was late. An
// overloaded nodelet drops sweeps and continues with the newest.
// Algorithm: Algorithm(node, const PipelineParameters&), static name(), Config and Tuning (reconfiguration.hpp) with
// tuning() and tune(tuning), measure(corrected, task), partials() of the measured sweep, place(state), skip(state),
// reset(), and show(prediction), which publishes its rviz data after the measurement is published.
#pragma once

#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bridge/graph_message_conversion.hpp"
#include "bridge/parameter_server.hpp"
#include "core/types/corrected_sweep.hpp"
#include "deferred_call.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "graph_nodelet.hpp"
#include "measurement_record.hpp"
#include "private_parameters.hpp"
#include "reconfiguration.hpp"
#include "sweep_matcher.hpp"
#include "topics.hpp"

namespace fail_aware {

template <class Algorithm>
class MeasurementNodelet : public GraphNodelet {
 private:
  void load() override {
    ros::NodeHandle& node = getNodeHandle();
    NoOwnParams none;
    readPrivateParameters(getPrivateNodeHandle(), none, typename Algorithm::Tuning());
    algorithm_ = std::make_unique<Algorithm>(node, readPipelineParameters(node));
    warnOfOtherValues(getPrivateNodeHandle(), none, algorithm_->tuning());
    const auto advertise = [&](const std::string& source) {
      return node.advertise<messages::PoseMeasurement>(topics::ofMeasurement(source), topics::kQueue);
    };
    publisher_ = advertise(Algorithm::name());
    for (const char* name : Algorithm::kPartials) partial_publishers_.push_back(advertise(name));
    reconfiguration_ = std::make_unique<Reconfiguration<typename Algorithm::Config, typename Algorithm::Tuning>>(
        getPrivateNodeHandle(), algorithm_->tuning(),
        [this](const typename Algorithm::Tuning& tuning) { algorithm_->tune(tuning); });
    work_ = std::make_unique<DeferredCall>(node, [this] { work(); });
    state_subscriber_ = node.subscribe(topics::kFilterState, topics::kQueue, &MeasurementNodelet::onState, this);
    prediction_subscriber_ =
        node.subscribe(topics::kSweepPrediction, topics::kQueue, &MeasurementNodelet::onPrediction, this);
    cloud_subscriber_ = node.subscribe(topics::kSweepPoints, topics::kQueue, &MeasurementNodelet::onCloud, this);
    health_ = reportHealth(Algorithm::name());
  }

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) { take(cloud); }
  void onPrediction(const messages::SweepPredictionConstPtr& prediction) { take(prediction); }
  void onState(const messages::FilterStateConstPtr& state) { take(state); }

  template <class MessagePtr>
  void take(const MessagePtr& message) {
    matcher_.add(message);
    work_->request();
  }

  void work() {
    if (const messages::FilterStateConstPtr message = matcher_.takePlace()) {
      if (const std::optional<FilterState> state = fromMessage(*message)) algorithm_->place(*state);
    }
    const std::optional<SweepMatcher::Job> job = matcher_.next();
    if (!job) return;
    if (job->begins) algorithm_->reset();
    for (const messages::FilterStateConstPtr& message : job->skipped) {
      if (const std::optional<FilterState> state = fromMessage(*message)) algorithm_->skip(*state);
    }
    measure(*job->prediction, *job->cloud);
    work_->request();  // the sweep's filter state may already be here
  }

  void measure(const messages::SweepPrediction& prediction, const sensor_msgs::PointCloud2& cloud) {
    const ros::SteadyTime begin = ros::SteadyTime::now();
    const std::optional<SweepTask> task = fromMessage(prediction);
    if (!task) return record_.addUnusable();
    if (!readCorrectedCloud(cloud, sweep_).ok()) sweep_.points_lidar.clear();
    sweep_.stamp_s = task->prediction.time_s();
    const Measurement measurement = algorithm_->measure(sweep_, *task);
    auto message =
        boost::make_shared<messages::PoseMeasurement>(toMessage(measurement, Algorithm::name(), prediction.header));
    message->sweep_points = static_cast<std::int32_t>(sweep_.points_lidar.size());
    message->duration = (ros::SteadyTime::now() - begin).toSec();
    record_.add(*message, measurement.status);
    publisher_.publish(messages::PoseMeasurementConstPtr(message));
    publishPartials(prediction);
    algorithm_->show(prediction);
  }

  void publishPartials(const messages::SweepPrediction& prediction) {
    const auto partials = algorithm_->partials();
    for (std::size_t i = 0; i < partials.size(); ++i) {
      auto message = boost::make_shared<messages::PoseMeasurement>(
          toMessage(partials[i], Algorithm::kPartials[i], prediction.header));
      message->sweep_points = static_cast<std::int32_t>(sweep_.points_lidar.size());
      partial_publishers_[i].publish(messages::PoseMeasurementConstPtr(message));
    }
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    record_.diagnose(status, matcher_.skipped());
    reconfiguration_->diagnose(status);
  }

  std::unique_ptr<Algorithm> algorithm_;
  ros::Publisher publisher_;
  std::vector<ros::Publisher> partial_publishers_;
  SweepMatcher matcher_;
  CorrectedSweep sweep_;
  MeasurementRecord record_;
  // Members with callbacks come last: they are destroyed first, and their destructors wait for running callbacks.
  std::unique_ptr<Reconfiguration<typename Algorithm::Config, typename Algorithm::Tuning>> reconfiguration_;
  std::unique_ptr<DeferredCall> work_;
  ros::Subscriber cloud_subscriber_, prediction_subscriber_, state_subscriber_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware
