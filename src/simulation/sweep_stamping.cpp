#include "simulation/sweep_stamping.hpp"

namespace fail_aware {

Sweep kittiSweep(const SimulatedSweep& simulated) {
  Sweep sweep = simulated.sweep;
  if (simulated.time_sign_wrong) {
    for (float& time_s : sweep.times_s) time_s = -time_s;
  }
  return sweep;
}

Sweep driverSweep(const SimulatedSweep& simulated) {
  Sweep sweep = simulated.sweep;
  sweep.stamp_s += 0.5 * simulated.period_s;
  const auto period_s = static_cast<float>(simulated.period_s);
  const float sign = simulated.time_sign_wrong ? -1.0f : 1.0f;
  for (float& time_s : sweep.times_s) time_s = sign * (time_s - period_s);
  for (float& intensity : sweep.intensities) intensity *= 255.0f;
  return sweep;
}

}  // namespace fail_aware
