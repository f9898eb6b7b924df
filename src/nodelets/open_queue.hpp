// nodelet 1.10.0 (Debian 11) throws away what comes for a nodelet while its onInit works: a timer whose tick is lost never
// ticks again, and a subscriber whose call is lost is a message behind from then on. Since 1.10.1 the queue is open from
// the start.
#pragma once

#include <nodelet/detail/callback_queue.h>
#include <ros/callback_queue_interface.h>

namespace fail_aware {

/// To be called first in onInit: what is called back from then on must find what it uses.
inline void openQueue(ros::CallbackQueueInterface& queue) {
  if (auto* of_nodelet = dynamic_cast<nodelet::detail::CallbackQueue*>(&queue)) of_nodelet->enable();
}

}  // namespace fail_aware
