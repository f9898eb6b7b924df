// Sweep correction in the live graph (core/sweep/sweep_corrector.hpp).
// In: points (any PointCloud2), sweep/prediction of the same stamp. Out: sweep/points, one for every prediction whose
// cloud is there; without points where the cloud could not be read, so that the sweep still closes; and sweep/check,
// what the raw sweep looks like (core/sweep/sweep_check.hpp).
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <memory>

#include "clock_check.hpp"
#include "exact_stamp_buffer.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/parameter_server.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_check.hpp"
#include "fail_aware_lidar_odometry/core/sweep/sweep_corrector.hpp"
#include "health.hpp"
#include "load_or_say_why.hpp"
#include "open_queue.hpp"
#include "private_parameters.hpp"
#include "rate_meter.hpp"
#include "spoken_faults.hpp"
#include "stamp_fault.hpp"
#include "stamps.hpp"
#include "topics.hpp"

namespace fail_aware {

class SweepCorrectionNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    openQueue(getSTCallbackQueue());
    loadOrSayWhy(getName(), [this] { load(); });
  }

  void load() {
    ros::NodeHandle& node = getNodeHandle();
    NoOwnParams none;
    readPrivateParameters(getPrivateNodeHandle(), none, NoTuning());
    const PipelineParameters params = readPipelineParameters(node);
    timing_params_ = params.sensor.timing;
    corrector_ = std::make_unique<SweepCorrector>(params.sensor.vertical_angle, params.sensor.azimuth,
                                                  params.sensor.correctedTiming(), params.profile.sweep_correction,
                                                  params.profile.level_keeping);
    check_ = std::make_unique<SweepCheck>(params.sensor.check);
    publisher_ = node.advertise<sensor_msgs::PointCloud2>(topics::kSweepPoints, topics::kQueue);
    check_publisher_ = node.advertise<messages::SweepCheck>(topics::kSweepCheck, topics::kQueue);
    prediction_subscriber_ =
        node.subscribe(topics::kSweepPrediction, topics::kQueue, &SweepCorrectionNodelet::onPrediction, this);
    cloud_subscriber_ = node.subscribe(topics::kClouds, topics::kQueue, &SweepCorrectionNodelet::onCloud, this);
    health_ =
        std::make_unique<Health>(node, getPrivateNodeHandle(), getName(), "sweep_correction",
                                 [this](diagnostic_updater::DiagnosticStatusWrapper& status) { diagnose(status); });
  }

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    clock_.heard(cloud->header.stamp);
    clouds_.push(cloud->header.stamp, cloud);
    advance(cloud->header.stamp);
  }

  void onPrediction(const messages::SweepPredictionConstPtr& prediction) {
    if (prediction->dt <= 0.0) corrector_->reset();  // a drive begins, whether this sweep's cloud comes or not
    predictions_.push(prediction->header.stamp, prediction);
    advance(prediction->header.stamp);
  }

  void advance(const ros::Time& stamp) {
    const messages::SweepPredictionConstPtr* prediction = predictions_.find(stamp);
    if (prediction == nullptr) return;
    const std::string& frame = (*prediction)->lidar_frame;
    const sensor_msgs::PointCloud2ConstPtr* cloud =
        clouds_.find(stamp, [&](const auto& c) { return frame.empty() || c->header.frame_id == frame; });
    if (cloud == nullptr) return;
    if (const std::optional<SweepTask> task = fromMessage(**prediction)) correct(**cloud, *task);
    unmatched_ += clouds_.popThrough(stamp);
    predictions_.popThrough(stamp);
  }

  void correct(const sensor_msgs::PointCloud2& cloud, const SweepTask& task) {
    const CloudReadResult read = readCloud(cloud, sweep_);
    if (!read.ok()) {
      ++refused_;
      last_reason_ = read.reason;
    }
    findings_ = check_->check(sweep_);
    report_ = corrector_->correct(sweep_, task.prediction, task.T_cog_lidar, corrected_);
    findings_.middle_s = report_.middle_s;
    findings_.revolution_s = report_.revolution_s;
    findings_.time_field_refused = report_.timing.guessed();
    if (findings_.time_field_refused) {
      ++guessed_;
      last_refusal_ = describeGuess(report_.timing);
    }
    if (report_.timing.source == TimingSource::kHeld) ++held_;
    outliers_ += report_.timing.outliers;
    check_publisher_.publish(messages::SweepCheckConstPtr(
        boost::make_shared<messages::SweepCheck>(toMessage(findings_, sweep_.size(), cloud.header))));
    if (findings_.repeats && !task.first()) corrected_.clear();
    const auto message = boost::make_shared<sensor_msgs::PointCloud2>();
    writeCloud(corrected_, sweep_.intensities, *message);
    message->header = cloud.header;
    publisher_.publish(sensor_msgs::PointCloud2ConstPtr(message));
    ++sweeps_;
    rate_.tick();
    last_stamp_ = cloud.header.stamp;
  }

  /// What the clouds show of their timing, against the parameters.
  std::string timingFault() const {
    const std::string seam = corrector_->seamContradiction();
    return seam.empty() ? stampFault(timing_params_, report_.timing, clock_.age_s()) : seam;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using Level = diagnostic_msgs::DiagnosticStatus;
    const std::string clock_fault = clock_.fault(), timing_fault = timingFault();
    faults_.say("timing", timing_fault);
    if (refused_ > refused_reported_) {
      status.summary(Level::WARN, "clouds without usable points: " + last_reason_);
      faults_.say("points", status.message);
    } else if (findings_.frozen || findings_.incomplete || findings_.low_visibility) {
      const char* what = findings_.incomplete ? describeIncomplete() : "the sweep is cut short in range";
      if (findings_.frozen) what = "the sweep is frozen: the driver repeats itself";
      status.summary(Level::WARN, what);
    } else if (guessed_ > guessed_reported_) {
      status.summary(Level::WARN, last_refusal_);
    } else if (!timing_fault.empty()) {
      status.summary(Level::WARN, timing_fault);
    } else if (!clock_fault.empty()) {
      status.summary(Level::WARN, clock_fault);
    } else {
      status.summary(Level::OK, sweeps_ == 0 ? "no sweep yet" : "correcting");
    }
    refused_reported_ = refused_;
    guessed_reported_ = guessed_;
    status.addf("rate (Hz)", "%.2f", rate_.take_hz());
    if (!last_stamp_.isZero()) {
      status.addf("age of the last sweep (s)", "%.3f", secondsFrom(last_stamp_, ros::Time::now()));
    }
    status.add("sweeps", sweeps_);
    status.add("points of the last sweep", sweep_.size());
    status.addf("azimuth coverage", "%.2f", findings_.azimuth_coverage);
    status.addf("share of far points", "%.3f", findings_.far_share);
    status.add("repetitions", findings_.repetitions);
    status.add("clouds without usable points", refused_);
    status.add("clouds without a prediction", unmatched_);
    status.add("timing source", toString(report_.timing.source));
    status.add("stamp reference", toString(report_.timing.reference));
    status.addf("age of the clouds on arrival (s)", "%.3f", clock_.age_s());
    status.add("time field", toString(report_.timing.field));
    status.add("time field's name", sweep_.time_field.name);
    status.add("sweeps timed by a guess", guessed_);
    status.add("sweeps timed as those before", held_);
    status.add("points without a usable time", outliers_);
    status.add("correction", toString(report_.correction.status));
  }

  SweepTimingParams timing_params_;
  std::unique_ptr<SweepCorrector> corrector_;
  ClockCheck clock_;                         ///< of the clouds
  SpokenFaults faults_{"sweep_correction"};  ///< in the log
  ros::Publisher publisher_, check_publisher_;
  ExactStampBuffer<sensor_msgs::PointCloud2ConstPtr> clouds_{topics::kQueue};
  ExactStampBuffer<messages::SweepPredictionConstPtr> predictions_{topics::kQueue};
  Sweep sweep_;
  CorrectedSweep corrected_;
  SweepCorrectorReport report_;
  std::unique_ptr<SweepCheck> check_;
  SweepFindings findings_;
  RateMeter rate_;
  ros::Time last_stamp_;
  std::string last_reason_, last_refusal_;
  std::size_t sweeps_ = 0, refused_ = 0, refused_reported_ = 0, unmatched_ = 0;
  std::size_t guessed_ = 0, guessed_reported_ = 0, held_ = 0, outliers_ = 0;
  // What calls back is destroyed first, and waits for a call that is under way.
  ros::Subscriber cloud_subscriber_, prediction_subscriber_;
  std::unique_ptr<Health> health_;
};

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::SweepCorrectionNodelet, nodelet::Nodelet)
