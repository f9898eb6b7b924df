// Whole drives of which only every n-th sweep is left, as on a machine that is too busy: the way is kept all the same.
#include <gtest/gtest.h>

#include "core/odometry_pipeline.hpp"
#include "simulation/drive_simulation.hpp"
#include "simulation/sweep_stamping.hpp"

namespace fail_aware::few_sweeps_drive {
namespace {

constexpr int kAllUntil = 14;  // sweeps: the motion is known, the period too
constexpr double kEnd_s = 15.0;

struct Outcome {
  int predicted = 0;
  double error_m = 0.0, length_m = 0.0;  ///< at the end, in the first pose's frame
};

/// A town from 3 m/s on, in which the driver speeds up and turns.
Outcome drive(int every) {
  DriveSimulation::Params simulated;
  simulated.seed = 4;
  simulated.duration_s = kEnd_s;
  simulated.drive.start_speed_mps = 3.0;
  simulated.lidar.columns = 1042;
  DriveSimulation simulation(simulated, 1);
  PipelineParameters params;
  params.sensor.timing.stamp_reference =
      "mid";  // the times count from the start: to bring them together takes the period
  OdometryPipeline pipeline(params, 1);
  Outcome outcome;
  Pose T_world_first, T_world_base;
  SweepResult result;
  SimulatedSweep sweep;
  for (int i = 0; simulation.next(sweep); ++i) {
    if (i == 0) T_world_first = T_world_base = sweep.T_world_base;
    outcome.length_m += (sweep.T_world_base.translation() - T_world_base.translation()).norm();
    T_world_base = sweep.T_world_base;
    if (i > kAllUntil && (i - kAllUntil) % every != 0) continue;
    Sweep arriving = kittiSweep(sweep);
    result = pipeline.step(arriving);
    if (result.status == SweepStatus::kPredicted) ++outcome.predicted;
    outcome.error_m =
        (result.T_odom_base.translation() - (T_world_first.inverse() * T_world_base).translation()).norm();
  }
  return outcome;
}

class FewSweeps : public testing::TestWithParam<int> {};

TEST_P(FewSweeps, KeepTheWay) {
  const Outcome outcome = drive(GetParam());
  EXPECT_GT(outcome.length_m, 60.0);
  EXPECT_EQ(outcome.predicted, 0);
  EXPECT_LT(outcome.error_m, 0.01 * outcome.length_m);
}

INSTANTIATE_TEST_SUITE_P(Every, FewSweeps, testing::Values(2, 4, 7), testing::PrintToStringParamName());

}  // namespace
}  // namespace fail_aware::few_sweeps_drive
