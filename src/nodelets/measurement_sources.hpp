// Who answers for a sweep: the sweep's check (from SweepCorrection), the three measurements, and any further source
// that is named by parameter. Collects the answers to the open sweep and says when nobody is left to wait for.
//
// Not waited for: a source that nobody publishes, one that missed absent_after_sweeps in a row (until it is heard
// again), one whose last absent_after_sweeps answers came later than a sweep may stay open (until one does not), the
// three measurements while SweepCorrection is silent, and poses with a stamp of their own (they are taken when the sweep
// is closed, the nearest in time). Whoever answers late is at work, and is told from who is silent.
//
// Parameters: ~extra_sources/NAME/{topic, type, tolerance_s}. type: PoseMeasurement (stamp of the sweep, exactly;
// waited for) or PoseWithCovarianceStamped (base_link in odom, or in a frame that tf knows in odom).
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "source_health.hpp"
#include "fail_aware_lidar_odometry/bridge/graph_message_conversion.hpp"
#include "fail_aware_lidar_odometry/core/estimator.hpp"

namespace fail_aware {

struct ExtraSourceParams {
  std::string topic;
  std::string type = "PoseWithCovarianceStamped";  ///< or PoseMeasurement
  double tolerance_s = 0.1;                        ///< between its stamp and the sweep's

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("topic", self.topic);
    v("type", self.type);
    v("tolerance_s", self.tolerance_s);
  }
  void validate() const;
};

/// Throws ParameterError, naming the source.
std::map<std::string, ExtraSourceParams> readExtraSources(const ros::NodeHandle& private_node);

class MeasurementSources {
 public:
  /// `estimator` takes the poses with stamps of their own, and lives longer. `answered` is called whenever something came
  /// for the open sweep.
  MeasurementSources(const ros::NodeHandle& node, const std::map<std::string, ExtraSourceParams>& extra,
                     const std::string& odom_frame, Estimator& estimator, std::function<void()> answered);
  /// Subscribes. Whatever `answered` needs must be there by then: messages come in another thread than load()'s.
  void listen();
  ~MeasurementSources();
  /// `answered` is called no more.
  void stopListening();
  MeasurementSources(const MeasurementSources&) = delete;
  MeasurementSources& operator=(const MeasurementSources&) = delete;

  void setAbsentAfter(int sweeps) { absent_after_sweeps_ = sweeps; }
  /// One of the three measurements: false: neither waited for nor fused.
  void use(const std::string& name, bool used);

  /// `longest_s`: what takes longer than this is too late for any sweep.
  void open(const ros::Time& stamp, double longest_s);
  bool allAnswered() const;
  /// Somebody at work has not answered yet: for `late_only` one whose last answer was late.
  bool isAtWork(bool late_only) const;
  /// What came for the open sweep, but for the poses with stamps of their own.
  SweepAccount close();
  /// What the estimator made of those.
  void addPoses(const std::vector<ExternalMeasurement>& poses, SweepAccount& account);
  void reset() { clear(); }

  /// " a b (too late)": those that are not waited for any more.
  std::string absent() const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  struct Source {
    std::string name;
    ExtraSourceParams params;
    bool built_in = false;  ///< made of SweepCorrection's points
    bool used = true;
    bool exact = true;  ///< carries the sweep's stamp
    ros::Subscriber subscriber;
    std::optional<Measurement> measurement;  ///< of the open sweep
    SourceHealth record;
    std::size_t answers = 0, late = 0, refused = 0;
    std::string refused_because;
    std::string last_status = "none yet";
    double last_duration_s = 0.0;
  };

  Source& add(const std::string& name);
  bool canAnswer(const ros::Subscriber& subscriber, const SourceHealth& record) const {
    return !record.isSilent(absent_after_sweeps_) && !record.isTooLate(absent_after_sweeps_) &&
           subscriber.getNumPublishers() > 0;
  }
  bool isInVain(const ros::Time& stamp) const;
  void clear();
  bool checkAwaited() const { return !findings_ && canAnswer(check_subscriber_, check_record_); }
  bool awaited(const Source& source) const;
  void onCheck(const messages::SweepCheck& message);
  void onMeasurement(Source& source, const messages::PoseMeasurement& message);
  void onPose(Source& source, const geometry_msgs::PoseWithCovarianceStamped& message);
  void refuse(Source& source, const std::string& reason);
  std::optional<Pose> odomFrom(const std::string& frame, std::string& reason);

  ros::NodeHandle node_;
  std::string odom_frame_;
  Estimator& estimator_;
  std::function<void()> answered_;
  int absent_after_sweeps_ = 3;
  ros::Time open_;  ///< zero: none
  /// Until when an answer to the last sweeps was of use.
  struct Latest {
    ros::Time stamp;
    ros::SteadyTime at;
  };
  std::deque<Latest> latest_;
  std::deque<Source> sources_;
  ros::Subscriber check_subscriber_;
  std::optional<SweepFindings> findings_;
  SourceHealth check_record_;
  int check_points_ = -1;
  int sweep_points_ = -1;
  std::unique_ptr<tf2_ros::Buffer> tf_buffer_;
  std::unique_ptr<tf2_ros::TransformListener> tf_listener_;
};

}  // namespace fail_aware
