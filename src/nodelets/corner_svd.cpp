// Corner alignment in the live graph (core/registration/corner_svd/corner_svd.hpp).
#include "fail_aware_lidar_odometry/CornerSvdConfig.h"
#include <pluginlib/class_list_macros.hpp>

#include "bridge/marker_conversion.hpp"
#include "core/registration/corner_svd/corner_svd.hpp"
#include "measurement_nodelet.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class CornerSvdAlgorithm {
 public:
  using Config = fail_aware_lidar_odometry::CornerSvdConfig;
  using Tuning = CornerSvdTuning;

  static const char* name() { return kCornerSvd; }
  static constexpr std::array<const char*, 0> kPartials{};

  CornerSvdAlgorithm(ros::NodeHandle& node, const PipelineParameters& params)
      : markers_(node.advertise<visualization_msgs::MarkerArray>(topics::kMarkers, 1)),
        tuning_{params.profile.registration.corner_alignment},
        corners_(params.profile.registration.corner_extraction, params.profile.registration.corner_reference,
                 tuning_.alignment) {}

  const Tuning& tuning() const { return tuning_; }
  void tune(const Tuning& tuning) {
    tuning_ = tuning;
    corners_.setAlignment(tuning.alignment);
  }

  Measurement measure(const CorrectedSweep& sweep, const SweepTask& task) {
    Measurement measurement = corners_.measure(sweep, task.prediction, task.T_cog_lidar);
    T_odom_cog_ = measurement.ok() ? measurement.T_odom_cog : task.prediction.T_odom_cog;
    return measurement;
  }
  std::array<Measurement, 0> partials() const { return {}; }
  void place(const FilterState& state) { corners_.place(state); }
  void skip(const FilterState& state) { corners_.skip(state); }
  void reset() { corners_.reset(); }
  void show(const messages::SweepPrediction& sweep) {
    if (markers_.getNumSubscribers() == 0) return;
    markers_.publish(boost::make_shared<const visualization_msgs::MarkerArray>(
        cornerMarkers(movedCorners(T_odom_cog_, corners_.cornersCog()), corners_.referenceOdom(), sweep.header)));
  }

 private:
  ros::Publisher markers_;
  Tuning tuning_;
  CornerSvd corners_;
  Pose T_odom_cog_ = Pose::Identity();  ///< pose of the last sweep with corners
};

using CornerSvdNodelet = MeasurementNodelet<CornerSvdAlgorithm>;

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::CornerSvdNodelet, nodelet::Nodelet)
