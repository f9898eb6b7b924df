// Collects the answers to the open sweep and knows when none is missing. Sources: the sweep check (from
// SweepCorrection), the three measurements, the partial measurements (from IcpPointToPlane), and any other source that
// a parameter names.
//
// FusionUkf does not wait for: a source without a publisher; one that missed absent_after_sweeps consecutive sweeps
// (until it answers again); one whose last absent_after_sweeps answers came later than a sweep may stay open (until one
// is in time); the three measurements while SweepCorrection is silent; poses with their own stamps (taken when the
// sweep is closed, the nearest in time). A source that answers late is at work and is distinguished from a silent one.
//
// Parameters: ~extra_sources/NAME/{topic, type, tolerance_s}. type: PoseMeasurement (has exactly the sweep's stamp and
// is waited for) or PoseWithCovarianceStamped (base_link in odom, or in a frame that tf knows in odom).
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

#include "bridge/graph_message_conversion.hpp"
#include "core/estimator.hpp"
#include "source_health.hpp"

namespace fail_aware {

struct ExtraSourceParams {
  std::string topic;
  std::string type = "PoseWithCovarianceStamped";  ///< or PoseMeasurement
  double tolerance_s = 0.1;                        ///< largest difference between its stamp and the sweep's

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("topic", self.topic);
    v("type", self.type);
    v("tolerance_s", self.tolerance_s, requireNotNegative);
  }
  void checkRules() const;
};

/// Throws ParameterError, naming the source.
std::map<std::string, ExtraSourceParams> readExtraSources(const ros::NodeHandle& private_node);

class MeasurementSources {
 public:
  /// `estimator` receives the poses with their own stamps; it must outlive this object. `answered` is called for every
  /// answer to the open sweep.
  MeasurementSources(const ros::NodeHandle& node, const std::map<std::string, ExtraSourceParams>& extra,
                     const std::string& odom_frame, Estimator& estimator, std::function<void()> answered);
  /// Subscribes. Everything that `answered` needs must exist: messages come in another thread than load()'s.
  void listen();
  ~MeasurementSources();
  /// After this `answered` is not called any more.
  void stopListening();
  MeasurementSources(const MeasurementSources&) = delete;
  MeasurementSources& operator=(const MeasurementSources&) = delete;

  void setAbsentAfter(int sweeps) { absent_after_sweeps_ = sweeps; }
  /// For one of the three measurements; not used: neither waited for nor fused.
  void use(const std::string& name, bool used);

  /// `longest_s`: an answer that takes longer is too late for any sweep.
  void open(const ros::Time& stamp, double longest_s);
  bool allAnswered() const;
  /// Whether a source at work has not answered yet; with `late_only` only sources whose last answer was late.
  bool isAtWork(bool late_only) const;
  /// The answers to the open sweep, except for poses with their own stamps.
  SweepAccount close();
  /// Adds the estimator's measurements from the poses with their own stamps.
  void addPoses(const std::vector<ExternalMeasurement>& poses, SweepAccount& account);
  void reset() { clear(); }

  /// " a b (too late)": the sources that are no longer waited for.
  std::string absent() const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  struct Source {
    std::string name;
    ExtraSourceParams params;
    bool built_in = false;  ///< one of the package's own, made from SweepCorrection's points
    FusionInput::Kind kind = FusionInput::Kind::kExternal;
    bool used = true;
    bool exact = true;  ///< has the sweep's stamp
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
  ros::Time open_;  ///< zero: no open sweep
  /// For each of the last sweeps: the time until which an answer was useful.
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
