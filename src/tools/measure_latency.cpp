// measure_latency: time from cloud to odometry in the running graph, and CPU and memory of its process.
//
// Latency is the time from this node's receipt of a cloud to its receipt of the odometry with the same stamp, on the
// steady clock, whatever use_sim_time is. For accurate figures run it on the graph's machine.
#include "fail_aware_lidar_odometry/FilterState.h"
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <mutex>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cloud_answers.hpp"
#include "core/io/trajectory_io.hpp"
#include "evaluation/quantile.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"
#include "json.hpp"
#include "process_monitor.hpp"
#include "tool_support.hpp"

namespace {

using namespace fail_aware;

constexpr const char* kName = "measure_latency";
constexpr std::uint32_t kQueue = 100;
constexpr double kPatience_s = 5.0;

struct Options {
  std::string cloud = "/velodyne_points", graph = "/fail_aware_lidar_odometry", manager, json, trajectory;
  double duration_s = 0.0, idle_s = 0.0;
  std::size_t skip = 0;
};

void addOptions(CLI::App& app, Options& options) {
  app.add_option("--cloud", options.cloud, "the topic that the odometry reads")->capture_default_str();
  app.add_option("--namespace", options.graph, "namespace of the graph whose odometry and filter_state are read")
      ->capture_default_str();
  app.add_option("--manager", options.manager,
                 "node whose process is watched (default: the one that publishes NAMESPACE/odometry)");
  app.add_option("--duration", options.duration_s, "s from the first cloud (default: until Ctrl-C)")
      ->check(positiveNumber());
  app.add_option("--idle", options.idle_s, "ends after this many s without a message, after the first cloud")
      ->check(positiveNumber());
  app.add_option("--skip", options.skip, "number of answered sweeps at the start that the latency leaves out")
      ->transform(wholeNumber(0));
  app.add_option("--json", options.json, "file for the figures");
  app.add_option("--trajectory", options.trajectory, "file for the odometry, TUM format");
}

double steadyNow_s() { return ros::SteadyTime::now().toSec(); }

/// Records the graph's messages. Callbacks run in several threads.
class Observer {
 public:
  Observer(ros::NodeHandle& node, const Options& options)
      : keep_trajectory_(!options.trajectory.empty()),
        cloud_(node.subscribe(options.cloud, kQueue, &Observer::onCloud, this)),
        odometry_(node.subscribe(options.graph + "/odometry", kQueue, &Observer::onOdometry, this)),
        state_(node.subscribe(options.graph + "/filter_state", kQueue, &Observer::onState, this)) {}

  struct View {
    CloudAnswers answers;
    double first_s = 0.0, last_s = 0.0;
    std::size_t dropped = 0, deadline_missed = 0, predicted_only = 0;
    std::vector<StampedPose> trajectory;
  };
  View view() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return view_;
  }
  /// Time of the first message; 0: no message yet.
  double firstAt() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return view_.first_s;
  }
  double lastAt() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return view_.last_s;
  }

 private:
  void onCloud(const sensor_msgs::PointCloud2ConstPtr& cloud) {
    const double now_s = steadyNow_s();
    const std::lock_guard<std::mutex> lock(mutex_);
    if (view_.first_s == 0.0) view_.first_s = now_s;
    view_.last_s = now_s;
    view_.answers.cloud(cloud->header.stamp.toNSec(), now_s);
  }
  void onOdometry(const nav_msgs::OdometryConstPtr& odometry) {
    const double now_s = steadyNow_s();
    const std::lock_guard<std::mutex> lock(mutex_);
    view_.last_s = now_s;
    view_.answers.odometry(odometry->header.stamp.toNSec(), now_s);
    if (!keep_trajectory_) return;
    if (const std::optional<Pose> T = fromMessage(odometry->pose.pose)) {
      view_.trajectory.push_back({odometry->header.stamp.toSec(), *T});
    }
  }
  void onState(const fail_aware_lidar_odometry::FilterStateConstPtr& state) {
    const std::lock_guard<std::mutex> lock(mutex_);
    view_.dropped += state->dropped_before;
    view_.deadline_missed += state->deadline_missed != 0;
    view_.predicted_only += state->measurement_applied == 0 && state->dt > 0.0;
  }

  const bool keep_trajectory_;
  mutable std::mutex mutex_;
  View view_;
  ros::Subscriber cloud_, odometry_, state_;
};

/// The manager's process, sampled while clouds arrive.
class ProcessWatch {
 public:
  /// `node` empty: the node that publishes `topic`.
  ProcessWatch(std::string node, std::string topic) : node_(std::move(node)), topic_(std::move(topic)) {}

  void update() {
    if (node_.empty()) node_ = publisherOf(topic_);
    if (node_.empty()) return;
    if (!pid_) pid_ = processOfNode(node_);
    if (!pid_) return;
    const std::optional<ProcessSample> sample = sampleProcess(*pid_);
    if (!sample) return;
    last_ = sample;
    last_s_ = steadyNow_s();
    if (!first_) {
      first_ = sample;
      first_s_ = last_s_;
    }
    max_rss_mb_ = std::max(max_rss_mb_, sample->rss_mb);
  }

  Json figures() const {
    Json json;
    json["node"] = node_;
    if (!first_ || last_s_ <= first_s_) return json;
    json["cpu_percent_of_one_core"] = 100.0 * (last_->cpu_s - first_->cpu_s) / (last_s_ - first_s_);
    json["rss_start_mb"] = first_->rss_mb;
    json["rss_end_mb"] = last_->rss_mb;
    json["rss_max_mb"] = max_rss_mb_;
    return json;
  }

 private:
  std::string node_, topic_;
  std::optional<long> pid_;
  std::optional<ProcessSample> first_, last_;
  double first_s_ = 0.0, last_s_ = 0.0, max_rss_mb_ = 0.0;
};

Json latencyOf(const std::vector<double>& latencies_s, std::size_t skip) {
  std::vector<double> ms;
  for (std::size_t i = skip; i < latencies_s.size(); ++i) ms.push_back(1e3 * latencies_s[i]);
  Json json;
  json["sweeps"] = ms.size();
  if (ms.empty()) ms.push_back(0.0);
  json["mean"] = std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(ms.size());
  json["p50"] = quantile(ms, 0.5);
  json["p95"] = quantile(ms, 0.95);
  json["p99"] = quantile(ms, 0.99);
  json["max"] = quantile(ms, 1.0);
  return json;
}

Json figuresOf(const Observer::View& view, const ProcessWatch& watch, std::size_t skip) {
  Json json;
  json["duration_s"] = view.last_s - view.first_s;
  json["clouds"] = view.answers.clouds();
  json["odometries"] = view.answers.odometries();
  json["clouds_without_odometry"] = view.answers.unanswered();
  json["dropped_counted"] = view.dropped;
  json["deadline_missed"] = view.deadline_missed;
  json["predicted_only"] = view.predicted_only;
  json["latency_ms"] = latencyOf(view.answers.latencies_s(), skip);
  json["process"] = watch.figures();
  return json;
}

void printTable(const Json& json) {
  const auto count = [&](const char* key) { return json[key].get<std::size_t>(); };
  const auto& latency = json["latency_ms"];
  const auto& process = json["process"];
  const double share = 100.0 * static_cast<double>(count("clouds_without_odometry")) /
                       static_cast<double>(std::max<std::size_t>(1, count("clouds")));
  std::printf("clouds                   %zu in %.1f s\n", count("clouds"), json["duration_s"].get<double>());
  std::printf("odometries               %zu\n", count("odometries"));
  std::printf("clouds without odometry  %zu (%.2f %%), counted as dropped: %zu\n", count("clouds_without_odometry"),
              share, count("dropped_counted"));
  std::printf("deadline missed          %zu, prediction only: %zu\n", count("deadline_missed"),
              count("predicted_only"));
  std::printf("latency, ms              p50 %.1f  p95 %.1f  p99 %.1f  max %.1f\n", latency["p50"].get<double>(),
              latency["p95"].get<double>(), latency["p99"].get<double>(), latency["max"].get<double>());
  if (process.contains("rss_max_mb")) {
    std::printf("%-24s CPU %.0f %% of one core, memory %.0f MB at the start, %.0f MB at the end, %.0f MB at most\n",
                process["node"].get<std::string>().c_str(), process["cpu_percent_of_one_core"].get<double>(),
                process["rss_start_mb"].get<double>(), process["rss_end_mb"].get<double>(),
                process["rss_max_mb"].get<double>());
  } else {
    const std::string node = process["node"].get<std::string>();
    std::printf("CPU and memory           not measured: %s\n",
                node.empty() ? "no node publishes the odometry" : (node + " is not a node on this machine").c_str());
  }
  std::fflush(stdout);
}

bool finished(const Observer& observer, const Options& options) {
  const double first_s = observer.firstAt(), now_s = steadyNow_s();
  if (first_s == 0.0) return false;
  if (options.duration_s > 0.0 && now_s - first_s >= options.duration_s) return true;
  return options.idle_s > 0.0 && now_s - observer.lastAt() >= options.idle_s;
}

/// Says once that no cloud comes.
class CloudWait {
 public:
  void update(const Observer& observer, const std::string& topic) {
    if (told_ || observer.firstAt() > 0.0 || steadyNow_s() - begin_s_ < kPatience_s) return;
    told_ = true;
    const std::string name = ros::names::resolve(topic);
    std::cerr << kName << ": waiting for a cloud on " << name
              << (publisherOf(name).empty() ? ", which no node publishes (--cloud)" : "") << std::endl;
  }

 private:
  double begin_s_ = steadyNow_s();
  bool told_ = false;
};

int run(const Options& options) {
  if (!ros::master::check()) {
    throw InputError("no ROS master at " + ros::master::getURI() + "; launch the odometry first");
  }
  for (const std::string& path : {options.json, options.trajectory}) {
    if (!path.empty() && !std::ofstream(path, std::ios::app)) throw InputError("cannot write " + path);
  }
  ros::NodeHandle node;
  Observer observer(node, options);
  ProcessWatch watch(options.manager, ros::names::resolve(options.graph + "/odometry"));
  ros::AsyncSpinner spinner(2);
  spinner.start();
  CloudWait wait;
  while (ros::ok() && !finished(observer, options)) {
    wait.update(observer, options.cloud);
    if (observer.firstAt() > 0.0) watch.update();
    ros::WallDuration(0.25).sleep();
  }
  spinner.stop();

  const Observer::View view = observer.view();
  const Json json = figuresOf(view, watch, options.skip);
  printTable(json);
  if (!options.json.empty() && !(std::ofstream(options.json) << json.dump(2) << "\n").flush()) {
    throw std::runtime_error("cannot write " + options.json);
  }
  if (!options.trajectory.empty()) writeTumTrajectory(options.trajectory, view.trajectory);
  if (view.answers.odometries() == 0) {
    return reportError(kName, "no odometry on " + options.graph + "/odometry", kExitFailed);
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kName, [&] {
    ros::init(argc, argv, kName, ros::init_options::AnonymousName);  // removes ROS's arguments
    CLI::App app(
        "Measures the time from cloud to odometry in the running graph, counts what was dropped, and watches CPU "
        "and memory of the nodelet manager. Prints a table at the end.\n"
        "Exit codes: 0 done, 1 no odometry came, 2 bad usage or input.",
        kName);
    Options options;
    addOptions(app, options);
    if (!parseArguments(app, argc, argv)) return kExitDone;
    return run(options);
  });
}
