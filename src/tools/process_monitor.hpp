// CPU time and memory of a ROS node's process on this machine.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace fail_aware {

/// The node that publishes a topic (resolved name), from the master; a nodelet counts as its manager. Empty: none.
std::string publisherOf(const std::string& topic);

/// The process id, from the master and the node itself; nothing if there is no such node.
std::optional<long> processOfNode(const std::string& node_name);

struct ProcessSample {
  double cpu_s = 0.0;  ///< user and system, since the process began
  double rss_mb = 0.0;
};

/// Nothing if there is no such process.
std::optional<ProcessSample> sampleProcess(long pid);

}  // namespace fail_aware
