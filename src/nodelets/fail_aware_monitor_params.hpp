// FailAwareMonitor's parameters in its private namespace.
#pragma once

#include "core/integrity/silence.hpp"

namespace fail_aware {

struct FailAwareMonitorNodeletParams {
  bool start_redundant = true;  ///< t1 is the first sweep, also after a reset; false: t1 is set by the service
  SilenceParams silence;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("start_redundant", self.start_redundant);
    SilenceParams::visit(self.silence, v);
  }
  void checkRules() const { silence.checkRules(); }
};

}  // namespace fail_aware
