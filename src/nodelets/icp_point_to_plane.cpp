// Normal-filtered ICP in the live graph (core/registration/icp_point_to_plane.hpp), with the partial measurements of
// core/aiding as sources of their own: measurement/road_profile and measurement/above_ground. It also publishes its
// reference as `local_map`, once a second of sweep time, relative to the lidar at the previous sweep, whose pose is
// final. In odom's axes FLOAT32 would shift the points by half a metre if odom has map coordinates (UTM).
#include "fail_aware_lidar_odometry/IcpPointToPlaneConfig.h"
#include <pluginlib/class_list_macros.hpp>

#include "core/local_map_registration.hpp"
#include "core/registration/icp_point_to_plane.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "measurement_nodelet.hpp"
#include "stamps.hpp"
#include "topics.hpp"
#include "tuning.hpp"

namespace fail_aware {

class IcpPointToPlaneAlgorithm {
 public:
  using Config = fail_aware_lidar_odometry::IcpPointToPlaneConfig;
  using Tuning = IcpPointToPlaneTuning;

  static const char* name() { return kIcpPointToPlane; }
  static constexpr std::array<const char*, 2> kPartials{kRoadProfile, kAboveGround};

  IcpPointToPlaneAlgorithm(ros::NodeHandle& node, const PipelineParameters& params)
      : local_map_(node.advertise<sensor_msgs::PointCloud2>(topics::kLocalMap, 1)),
        registration_(params.profile.registration, params.sensor.correctedTiming()),
        tuning_{params.profile.registration.icp_point_to_plane},
        icp_(tuning_.icp) {}

  const Tuning& tuning() const { return tuning_; }
  void tune(const Tuning& tuning) {
    tuning_ = tuning;
    icp_ = IcpPointToPlane(tuning.icp);
  }

  Measurement measure(const CorrectedSweep& sweep, const SweepTask& task) {
    registration_.prepare(sweep, task.prediction, task.T_cog_lidar);
    return registration_.align(icp_, task.prediction.sigma_yaw_rad);
  }
  std::array<Measurement, 2> partials() const { return {registration_.roadProfile(), registration_.aboveGround()}; }
  void place(const FilterState& state) { registration_.place(state); }
  void skip(const FilterState& state) { registration_.skip(state); }
  void reset() { registration_.reset(); }
  void show(const messages::SweepPrediction& sweep) {
    const ros::Time stamp = sweep.previous_stamp;
    const double since_s = secondsFrom(shown_stamp_, stamp);
    if (local_map_.getNumSubscribers() == 0 || (since_s >= 0.0 && since_s < kLocalMapPeriod_s)) return;
    const std::optional<Pose> T_odom_cog = fromMessage(sweep.previous_pose),
                              T_cog_lidar = fromMessage(sweep.lidar_in_cog);
    if (stamp.isZero() || !T_odom_cog || !T_cog_lidar) return;
    shown_stamp_ = stamp;
    const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    writePoints(registration_.map().points(), *T_odom_cog * *T_cog_lidar, *cloud);
    cloud->header.stamp = stamp;
    cloud->header.frame_id = sweep.lidar_frame;
    local_map_.publish(sensor_msgs::PointCloud2ConstPtr(cloud));
  }

 private:
  static constexpr double kLocalMapPeriod_s = 1.0;

  ros::Publisher local_map_;
  ros::Time shown_stamp_;
  LocalMapRegistration registration_;
  Tuning tuning_;
  IcpPointToPlane icp_;
};

using IcpPointToPlaneNodelet = MeasurementNodelet<IcpPointToPlaneAlgorithm>;

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::IcpPointToPlaneNodelet, nodelet::Nodelet)
