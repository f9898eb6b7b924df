// Corner alignment in the live graph (core/registration/corner_measurement.hpp).
#include <pluginlib/class_list_macros.hpp>

#include "fail_aware_lidar_odometry/core/registration/corner_measurement.hpp"
#include "measurement_nodelet.hpp"

namespace fail_aware {

class CornerSvdAlgorithm {
 public:
  static const char* name() { return kCornerSvd; }

  explicit CornerSvdAlgorithm(const PipelineParameters& params)
      : used_(params.profile.registration.use_corners),
        corners_(params.profile.registration.corner_extraction, params.profile.registration.corner_reference,
                 params.profile.registration.corner_alignment) {}

  Measurement measure(const CorrectedSweep& sweep, const SweepTask& task) {
    if (!used_) return Measurement();
    return corners_.measure(sweep, task.prediction, task.T_cog_lidar);
  }
  void place(const FilterState& state) { corners_.place(state); }
  void reset() { corners_.reset(); }

 private:
  bool used_;
  CornerMeasurement corners_;
};

using CornerSvd = MeasurementNodelet<CornerSvdAlgorithm>;

}  // namespace fail_aware

PLUGINLIB_EXPORT_CLASS(fail_aware::CornerSvd, nodelet::Nodelet)
