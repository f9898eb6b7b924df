#include "process_monitor.hpp"

#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <fstream>
#include <iterator>
#include <sstream>

namespace fail_aware {

std::string publisherOf(const std::string& topic) {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return "";
  XmlRpc::XmlRpcValue& published = state[0];  // (topic, (node, ...)), ...
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string>(published[i][0]) == topic && published[i][1].size() > 0) {
      return static_cast<std::string>(published[i][1][0]);
    }
  }
  return "";
}

std::optional<long> processOfNode(const std::string& node_name) {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = ros::this_node::getName();
  request[1] = node_name;
  if (!ros::master::execute("lookupNode", request, response, payload, false)) return std::nullopt;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(static_cast<std::string>(payload), host, port)) return std::nullopt;
  XmlRpc::XmlRpcClient node(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue caller, answer;
  caller[0] = ros::this_node::getName();
  if (!node.execute("getPid", caller, answer) || node.isFault()) return std::nullopt;
  if (answer.getType() != XmlRpc::XmlRpcValue::TypeArray || answer.size() != 3 ||
      answer[2].getType() != XmlRpc::XmlRpcValue::TypeInt) {
    return std::nullopt;
  }
  return static_cast<int>(answer[2]);
}

std::optional<ProcessSample> sampleProcess(long pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  const std::string line{std::istreambuf_iterator<char>(file), {}};
  const std::size_t name_end = line.rfind(')');  // a process name may contain blanks and brackets
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(name_end + 1));
  std::string skipped;
  constexpr int kBeforeTimes = 11, kBetweenTimesAndMemory = 8;
  for (int i = 0; i < kBeforeTimes; ++i) fields >> skipped;
  double user = 0.0, system = 0.0, pages = 0.0;
  fields >> user >> system;
  for (int i = 0; i < kBetweenTimesAndMemory; ++i) fields >> skipped;
  fields >> pages;
  if (!fields) return std::nullopt;
  ProcessSample sample;
  sample.cpu_s = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  sample.rss_mb = pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
  return sample;
}

}  // namespace fail_aware
