// nodelet 1.10.0 (Debian 11) discards callbacks for a nodelet while its onInit runs: a timer that loses a tick never
// ticks again, and a subscriber that loses a call stays one message behind. Since 1.10.1 the queue is always open.
#pragma once

#include <nodelet/detail/callback_queue.h>
#include <ros/callback_queue_interface.h>

namespace fail_aware {

/// Call first in onInit: everything that the callbacks use must already exist.
inline void openQueue(ros::CallbackQueueInterface& queue) {
  if (auto* of_nodelet = dynamic_cast<nodelet::detail::CallbackQueue*>(&queue)) of_nodelet->enable();
}

}  // namespace fail_aware
