// drive_simulator: publishes a simulated drive in real time, like a vehicle with a Velodyne: the cloud, the lidar's
// mounting on /tf_static, and the ground truth.
//
// Private parameters: those of DriveSimulation::Params (scene, duration_s, seed, drive/..., lidar/...), VelodyneNames
// (topics, frames), and the ones below. Stamps are the wall clock's: use_sim_time must be off. Ends with the drive.
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <boost/make_shared.hpp>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "bridge/parameter_server.hpp"
#include "bridge/velodyne_messages.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "simulation/fault_injector.hpp"
#include "simulation/sweep_stamping.hpp"
#include "simulation_options.hpp"

namespace {

using namespace fail_aware;

constexpr int kQueue = 10;

constexpr const char* kHelp =
    "A node that simulates a drive in real time and publishes it as a vehicle with a Velodyne does: /velodyne_points,\n"
    "/tf_static, and the truth on /ground_truth/odometry. Needs a ROS master and the wall clock (use_sim_time off).\n"
    "launch/demo.launch starts it together with the odometry.\n"
    "faults: KIND[:START[:DURATION[:SEVERITY]]], separated by blanks; scenes and kinds: simulate_drive --help.\n"
    "Exit codes: 0 the drive is over, 1 it failed, 2 bad arguments or parameters.\n"
    "Private parameters (_NAME:=VALUE) and their defaults:\n";

struct Parameters {
  DriveSimulation::Params simulation;
  VelodyneNames names;
  std::string faults;               ///< KIND[:START[:DURATION[:SEVERITY]]], separated by blanks
  bool wait_for_subscriber = true;  ///< the drive begins when the clouds have a subscriber

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    DriveSimulation::Params::visit(self.simulation, v);
    VelodyneNames::visit(self.names, v);
    v("faults", self.faults);
    v("wait_for_subscriber", self.wait_for_subscriber);
  }
};

std::vector<Fault> faultsOf(const std::string& text, double drive_s) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return parseFaults(words, drive_s);
}

/// The arguments that are not ROS's (remappings, private parameters).
std::vector<std::string> argumentsOf(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  if (!arguments.empty()) arguments.erase(arguments.begin());
  return arguments;
}

class DriveSimulator {
 public:
  explicit DriveSimulator(const Parameters& parameters)
      : parameters_(parameters),
        faults_(faultsOf(parameters.faults, parameters.simulation.duration_s)),
        simulation_(parameters.simulation, 1),
        injector_(static_cast<std::uint64_t>(parameters.simulation.seed), faults_) {
    clouds_ = node_.advertise<sensor_msgs::PointCloud2>(parameters_.names.cloud_topic, kQueue);
    truths_ = node_.advertise<nav_msgs::Odometry>(parameters_.names.ground_truth_topic, kQueue);
  }

  void run() {
    transforms_.sendTransform(lidarPlace(parameters_.simulation.T_base_lidar(), parameters_.names, ros::Time::now()));
    while (ros::ok() && parameters_.wait_for_subscriber && clouds_.getNumSubscribers() == 0) {
      ros::WallDuration(0.05).sleep();
    }
    SimulatedSweep sweep;
    bool more = simulation_.next(sweep, vehiclesAround(faults_, simulation_.time_s()));  // building the world is slow
    epoch_ = ros::Time::now();
    const ros::SteadyTime begin = ros::SteadyTime::now();
    std::size_t late = 0, count = 0;
    for (; more && ros::ok(); more = simulation_.next(sweep, vehiclesAround(faults_, simulation_.time_s()))) {
      const ros::WallDuration ahead(sweep.begin_s + sweep.period_s - (ros::SteadyTime::now() - begin).toSec());
      if (ahead.toSec() > 0.0) ahead.sleep();
      if (-ahead.toSec() > sweep.period_s) ++late;
      ++count;
      publish(injector_.apply(std::move(sweep)));
    }
    publish(injector_.flush());
    if (late > 0) ROS_WARN("%zu of %zu sweeps came late: the machine is too slow or too busy", late, count);
    ROS_INFO("the drive is over: %zu sweeps", count);
    ros::WallDuration(1.0).sleep();  // so that the last messages still arrive
  }

 private:
  void publish(const std::vector<SimulatedSweep>& arriving) {
    for (const SimulatedSweep& simulated : arriving) {
      if (!has_first_) T_world_first_ = simulated.T_world_base_end;
      has_first_ = true;
      truths_.publish(groundTruth(T_world_first_.inverse() * simulated.T_world_base_end, parameters_.names,
                                  timeAt(epoch_, simulated.begin_s + simulated.period_s)));
      const Sweep sweep = driverSweep(simulated);
      const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
      writeVelodyneCloud(sweep, *cloud);
      cloud->header.frame_id = parameters_.names.lidar_frame;
      cloud->header.stamp = timeAt(epoch_, sweep.stamp_s);
      clouds_.publish(cloud);
    }
  }

  Parameters parameters_;
  std::vector<Fault> faults_;
  DriveSimulation simulation_;
  FaultInjector injector_;
  ros::NodeHandle node_;
  ros::Publisher clouds_, truths_;
  tf2_ros::StaticTransformBroadcaster transforms_;
  ros::Time epoch_;
  bool has_first_ = false;
  Pose T_world_first_ = Pose::Identity();
};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments = argumentsOf(argc, argv);
  if (!arguments.empty()) {
    const bool help = arguments.front() == "--help" || arguments.front() == "-h";
    if (help) std::cout << kHelp << formatYaml(toList(Parameters()));
    if (!help) std::cerr << "drive_simulator: error: unknown argument " << arguments.front() << " (see --help)\n";
    return help ? 0 : 2;
  }
  ros::init(argc, argv, "drive_simulator");
  const ros::NodeHandle private_node("~");  // keeps the node up
  ros::AsyncSpinner spinner(1);
  spinner.start();
  try {
    Parameters parameters;
    readParameters(private_node, "", parameters, MissingKeys::kKeep);
    DriveSimulator(parameters).run();
  } catch (const ParameterError& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
