// Normal-filtered ICP in the live graph (core/registration/normal_filtered_icp.hpp).
#include <pluginlib/class_list_macros.hpp>

#include "fail_aware_lidar_odometry/core/registration/normal_filtered_icp.hpp"
#include "icp_front.hpp"
#include "measurement_nodelet.hpp"

namespace fail_aware {

class IcpPointToPlaneAlgorithm {
 public:
  static const char* name() { return kIcpPointToPlane; }

  explicit IcpPointToPlaneAlgorithm(const PipelineParameters& params)
      : used_(params.profile.registration.use_plane),
        front_(makeFront(params.profile.registration)),
        icp_(params.profile.registration.plane) {}

  Measurement measure(const CorrectedSweep& sweep, const SweepTask& task) {
    if (!used_) return Measurement();
    front_.prepare(sweep, task.prediction, task.T_cog_lidar);
    return front_.align(icp_, task.prediction.sigma_yaw_rad);
  }
  void place(const FilterState& state) { front_.place(state); }
  void reset() { front_.reset(); }

 private:
  bool used_;
  RegistrationFront front_;
  NormalFilteredIcp icp_;
};

using IcpPointToPlane = MeasurementNodelet<IcpPointToPlaneAlgorithm>;

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::IcpPointToPlane, nodelet::Nodelet)
