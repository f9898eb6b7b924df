#include "bus_links.hpp"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include <algorithm>
#include <cstdint>

namespace fail_aware {

std::vector<BusLink> busLinks(const std::string& node_name) {
  std::vector<BusLink> links;
  XmlRpc::XmlRpcValue args, result, payload;
  args[0] = ros::this_node::getName();
  args[1] = node_name;
  if (!ros::master::execute("lookupNode", args, result, payload, false)) return links;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(static_cast<std::string>(payload), host, port)) return links;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  if (!client.execute("getBusInfo", request, response) || response.getType() != XmlRpc::XmlRpcValue::TypeArray) {
    return links;
  }
  for (int i = 0; i < response[2].size(); ++i) {
    XmlRpc::XmlRpcValue& entry = response[2][i];
    links.push_back({static_cast<std::string>(entry[4]), static_cast<std::string>(entry[3]),
                     static_cast<std::string>(entry[2]) == "i"});
  }
  return links;
}

std::vector<std::string> registeredNodes(bool publishers, const std::string& topic) {
  std::vector<std::string> nodes;
  XmlRpc::XmlRpcValue args, result, payload;
  args[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", args, result, payload, false)) return nodes;
  XmlRpc::XmlRpcValue& topics = payload[publishers ? 0 : 1];
  for (int i = 0; i < topics.size(); ++i) {
    if (static_cast<std::string>(topics[i][0]) != topic) continue;
    for (int j = 0; j < topics[i][1].size(); ++j) nodes.push_back(static_cast<std::string>(topics[i][1][j]));
  }
  return nodes;
}

bool allLinked(const std::vector<std::string>& topics) {
  for (const std::string& topic : topics) {
    if (registeredNodes(true, topic).empty()) return false;
    const std::vector<std::string> subscribers = registeredNodes(false, topic);
    if (subscribers.empty()) return false;
    for (const std::string& node : subscribers) {
      const std::vector<BusLink> links = busLinks(node);
      if (std::none_of(links.begin(), links.end(), [&](const BusLink& l) { return l.inbound && l.topic == topic; })) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace fail_aware
