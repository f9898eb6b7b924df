// Who is linked with whom in a running graph: the master's registrations and each node's own account of its connections
// (slave API, getBusInfo). For tests that must not publish before everybody listens.
#pragma once

#include <string>
#include <vector>

namespace fail_aware {

struct BusLink {
  std::string topic;
  std::string transport;  ///< TCPROS, INTRAPROCESS
  bool inbound = false;
};

std::vector<BusLink> busLinks(const std::string& node_name);

/// Names of the nodes registered for each topic.
std::vector<std::string> registeredNodes(bool publishers, const std::string& topic);

/// Every topic has a publisher and a subscriber, and every subscriber's node a link to it.
bool allLinked(const std::vector<std::string>& topics);

}  // namespace fail_aware
