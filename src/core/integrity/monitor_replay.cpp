#include "core/integrity/monitor_replay.hpp"

namespace fail_aware {

std::vector<MonitorOutput> replayMonitor(const std::vector<MonitorInput>& log, double start_s,
                                         const MonitorParameters& params) {
  FailAwareMonitor monitor(params);
  std::vector<MonitorOutput> outputs;
  outputs.reserve(log.size());
  for (const MonitorInput& input : log) {
    const bool first = outputs.empty();
    if (!first && input.state.dt_s == 0.0) monitor.reset();
    const double since_first_s = input.state.stamp_s - log.front().state.stamp_s;
    if (!monitor.started() && since_first_s >= start_s - kStartTolerance_s) monitor.start();
    outputs.push_back(monitor.update(input.state, input.condition));
  }
  return outputs;
}

}  // namespace fail_aware
