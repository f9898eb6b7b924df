// Multiplex ICP in the live graph (core/registration/multiplex_icp.hpp).
#include <pluginlib/class_list_macros.hpp>

#include "fail_aware_lidar_odometry/core/registration/multiplex_icp.hpp"
#include "icp_front.hpp"
#include "measurement_nodelet.hpp"

namespace fail_aware {

class IcpPointToPointAlgorithm {
 public:
  static const char* name() { return kIcpPointToPoint; }

  explicit IcpPointToPointAlgorithm(const PipelineParameters& params)
      : used_(params.profile.registration.use_point),
        front_(makeFront(params.profile.registration)),
        icp_(params.profile.registration.point) {}

  Measurement measure(const CorrectedSweep& sweep, const SweepTask& task) {
    if (!used_) return Measurement();
    front_.prepare(sweep, task.prediction, task.T_cog_lidar);
    return front_.align(icp_);
  }
  void place(const FilterState& state) { front_.place(state); }
  void reset() { front_.reset(); }

 private:
  bool used_;
  RegistrationFront front_;
  MultiplexIcp icp_;
};

using IcpPointToPoint = MeasurementNodelet<IcpPointToPointAlgorithm>;

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::IcpPointToPoint, nodelet::Nodelet)
