// Multiplex ICP in the live graph (core/registration/icp_point_to_point.hpp).
#include "fail_aware_lidar_odometry/IcpPointToPointConfig.h"
#include <pluginlib/class_list_macros.hpp>

#include "bridge/marker_conversion.hpp"
#include "core/local_map_registration.hpp"
#include "core/registration/icp_point_to_point.hpp"
#include "measurement_nodelet.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class IcpPointToPointAlgorithm {
 public:
  using Config = fail_aware_lidar_odometry::IcpPointToPointConfig;
  using Tuning = IcpPointToPointTuning;

  static const char* name() { return kIcpPointToPoint; }
  static constexpr std::array<const char*, 0> kPartials{};

  IcpPointToPointAlgorithm(ros::NodeHandle& node, const PipelineParameters& params)
      : markers_(node.advertise<visualization_msgs::MarkerArray>(topics::kMarkers, 1)),
        registration_(params.profile.registration, params.sensor.correctedTiming()),
        tuning_{params.profile.registration.icp_point_to_point},
        icp_(tuning_.icp) {}

  const Tuning& tuning() const { return tuning_; }
  void tune(const Tuning& tuning) {
    tuning_ = tuning;
    icp_ = IcpPointToPoint(tuning.icp);
  }

  Measurement measure(const CorrectedSweep& sweep, const SweepTask& task) {
    registration_.prepare(sweep, task.prediction, task.T_cog_lidar);
    return registration_.align(icp_, &tracks_);
  }
  std::array<Measurement, 0> partials() const { return {}; }
  void place(const FilterState& state) { registration_.place(state); }
  void skip(const FilterState& state) { registration_.skip(state); }
  void reset() { registration_.reset(); }
  void show(const messages::SweepPrediction& sweep) {
    if (markers_.getNumSubscribers() == 0) return;
    markers_.publish(boost::make_shared<const visualization_msgs::MarkerArray>(seedMarkers(tracks_, sweep.header)));
  }

 private:
  ros::Publisher markers_;
  LocalMapRegistration registration_;
  Tuning tuning_;
  IcpPointToPoint icp_;
  std::vector<SeedTrack> tracks_;  ///< of the last measurement
};

using IcpPointToPointNodelet = MeasurementNodelet<IcpPointToPointAlgorithm>;

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::IcpPointToPointNodelet, nodelet::Nodelet)
