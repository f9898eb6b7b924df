// Every kind of fault that the simulator makes, and some together, through the live graph: each accepted cloud has
// exactly one filter state, odometry and time to failure, every number on every topic of the graph is finite, the fault
// is told, and the odometry corrects again when it is over. Clouds as the driver's, each sent when the one before is
// answered.
#include <gtest/gtest.h>
#include <nav_msgs/Path.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "../support/graph_driver.hpp"
#include "../support/message_numbers.hpp"
#include "bridge/velodyne_messages.hpp"
#include "core/estimation/stamp_order.hpp"
#include "simulation/drive_simulation.hpp"
#include "simulation/fault_injector.hpp"
#include "simulation/sweep_stamping.hpp"

namespace fail_aware::simulated_faults_test {
namespace {

using Reason = messages::TimeToFailure;

constexpr int kSeed = 2;
constexpr double kDuration_s = 2.2, kFaultBegin_s = 1.0;
constexpr double kAlertLimit_m = 0.6;

struct Case {
  std::string name;
  std::vector<std::string> faults;
  std::uint32_t reasons;  ///< that some sweep must be told with
  bool recovers = true;   ///< the fault ends, and the last sweep is corrected and without these reasons
};

const std::vector<Case>& cases() {
  constexpr std::uint32_t kNothingSeen =
      Reason::REASON_SWEEP_EMPTY | Reason::REASON_NO_MEASUREMENT | Reason::REASON_PREDICTION_ONLY;
  static const std::vector<Case> cases = {
      {"blanked_sector", {"blanked_sector:1:0.5"}, Reason::REASON_SWEEP_INCOMPLETE},
      {"lost_rings", {"lost_rings:1:0.5"}, 0},
      {"all_rings_lost", {"lost_rings:1:0.5:1"}, kNothingSeen},
      {"range_cap", {"range_cap:1:0.5"}, Reason::REASON_LOW_VISIBILITY},
      {"thick_fog", {"range_cap:1:0.5:3"}, Reason::REASON_LOW_VISIBILITY | Reason::REASON_PREDICTION_ONLY},
      {"noise", {"noise:1:0.5"}, 0},
      {"ghost_points", {"ghost_points:1:0.5"}, 0},
      {"frozen_cloud", {"frozen_cloud:1:0.5"}, Reason::REASON_FROZEN_CLOUD},
      {"half_sweep", {"half_sweep:1:0.5"}, Reason::REASON_SWEEP_INCOMPLETE},
      {"dropped", {"dropped:1:0.7"}, Reason::REASON_TIME_JUMP},
      {"duplicated", {"duplicated:1:0.5"}, Reason::REASON_DROPPED_SWEEPS},
      {"reordered", {"reordered:1:0.4"}, Reason::REASON_DROPPED_SWEEPS},
      {"stamp_jump_forward", {"stamp_jump:1:inf:5"}, Reason::REASON_TIME_JUMP, false},
      {"stamp_jump_back", {"stamp_jump:1:inf:-5"}, 0, false},
      {"stamp_jump_for_a_while", {"stamp_jump:1:0.5:0.3"}, 0},
      {"stamp_jitter", {"stamp_jitter:1:inf:0.005"}, 0, false},
      {"time_sign", {"time_sign:1"}, 0, false},
      {"tilted_mount", {"tilted_mount:1"}, 0, false},
      {"dense_traffic", {"dense_traffic:1:0.5"}, 0},
      {"empty_cloud", {"empty_cloud:1:0.5"}, kNothingSeen},
      {"nan", {"nan:1:0.5"}, kNothingSeen},
      {"half_of_it_nan", {"nan:1:0.5:0.5"}, 0},
      {"fog_noise_and_drops",
       {"range_cap:1:0.5", "noise:1:0.5", "dropped:1.2:0.1", "duplicated:1.3:0.2"},
       Reason::REASON_LOW_VISIBILITY | Reason::REASON_DROPPED_SWEEPS},
      {"half_tilted_ghosts_reordered",
       {"half_sweep:1:0.5", "tilted_mount:1:0.5", "ghost_points:1:0.5", "reordered:1:0.4"},
       Reason::REASON_SWEEP_INCOMPLETE | Reason::REASON_DROPPED_SWEEPS},
      {"everything_from_the_start",
       {"blanked_sector:0", "noise:0", "lost_rings:0", "nan:0:5:0.5", "time_sign:0"},
       Reason::REASON_SWEEP_INCOMPLETE,
       false},
  };
  return cases;
}

/// The drive without faults, by the number of vehicles around; each is simulated once.
const std::vector<SimulatedSweep>& cleanDrive(const std::vector<Fault>& faults) {
  static std::map<int, std::vector<SimulatedSweep>> drives;
  const int most = vehiclesAround(faults, kFaultBegin_s);
  std::vector<SimulatedSweep>& drive = drives[most];
  if (!drive.empty()) return drive;
  DriveSimulation::Params params;
  params.seed = kSeed;
  params.duration_s = kDuration_s;
  params.drive.start_speed_mps = 8.0;
  params.lidar.columns = 1042;
  DriveSimulation simulation(params, 1);
  SimulatedSweep sweep;
  while (simulation.next(sweep, vehiclesAround(faults, simulation.time_s()))) drive.push_back(sweep);
  return drive;
}

std::vector<SimulatedSweep> arrivals(const Case& test) {
  std::vector<Fault> faults;
  for (const std::string& text : test.faults) faults.push_back(Fault::parse(text));
  FaultInjector injector(kSeed, faults);
  std::vector<SimulatedSweep> all;
  for (const SimulatedSweep& sweep : cleanDrive(faults)) {
    for (SimulatedSweep& arriving : injector.apply(sweep)) all.push_back(std::move(arriving));
  }
  for (SimulatedSweep& arriving : injector.flush()) all.push_back(std::move(arriving));
  return all;
}

// ---- every number that is published ---------------------------------------------------------------------------------

bool isUnit(const geometry_msgs::Quaternion& q) {
  return std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) < 1e-6;
}

// Beside being finite; most messages promise no more.
void expectRotations(const nav_msgs::Odometry& m) { EXPECT_TRUE(isUnit(m.pose.pose.orientation)); }
void expectRotations(const messages::FilterState& m) {
  EXPECT_TRUE(isUnit(m.pose.orientation) && isUnit(m.increment.orientation));
}
void expectRotations(const messages::SweepPrediction& m) {
  EXPECT_TRUE(isUnit(m.previous_pose.orientation) && isUnit(m.pose.orientation) && isUnit(m.lidar_in_cog.orientation));
}
void expectRotations(const messages::PoseMeasurement& m) {
  EXPECT_TRUE(m.status != messages::PoseMeasurement::OK || isUnit(m.pose.orientation)) << m.source;
}
void expectRotations(const tf2_msgs::TFMessage& m) {
  for (const auto& transform : m.transforms) EXPECT_TRUE(isUnit(transform.transform.rotation));
}
void expectRotations(const nav_msgs::Path& m) {
  for (const auto& pose : m.poses) EXPECT_TRUE(isUnit(pose.pose.orientation));
}
template <class Message>
void expectRotations(const Message&) {}

class SimulatedFaults : public testing::TestWithParam<Case> {
 protected:
  static void SetUpTestSuite() {
    graph_ = new GraphDriver;
    watch<messages::SweepPrediction>("sweep/prediction");
    watch<messages::SweepCheck>("sweep/check");
    watch<sensor_msgs::PointCloud2>("sweep/points");
    for (const char* name : {"icp_point_to_point", "icp_point_to_plane", "corner_svd"}) {
      watch<messages::PoseMeasurement>(std::string("measurement/") + name);
    }
    watch<messages::FilterState>("filter_state");
    watch<nav_msgs::Odometry>("odometry");
    watch<messages::TimeToFailure>("time_to_failure");
    watch<nav_msgs::Path>("path");
    watch<visualization_msgs::MarkerArray>("markers");
    watch<sensor_msgs::PointCloud2>("local_map");
    watch<tf2_msgs::TFMessage>("/tf");
    graph_->sendTransform(DriveSimulation::Params().T_base_lidar());
    ASSERT_TRUE(graph_->waitUntilLinked());
    ASSERT_TRUE(graph_->start(cloudOf(cleanDrive({})[0])));
  }
  static void TearDownTestSuite() {
    watched_.clear();
    delete graph_;
  }

  /// Every number of every message on this topic.
  template <class Message>
  static void watch(const std::string& topic) {
    seen_[topic] = 0;
    boost::function<void(const typename Message::ConstPtr&)> look = [topic](const typename Message::ConstPtr& message) {
      SCOPED_TRACE(topic);
      EXPECT_EQ(numbersNotFinite(*message), "");
      expectRotations(*message);
      ++seen_[topic];
    };
    watched_.push_back(graph_->node().subscribe<Message>(topic, 100, look));
  }

  static std::string topicsNotSeen() {
    std::string topics;
    for (const auto& [topic, messages] : seen_) topics += messages == 0 ? ' ' + topic : "";
    return topics;
  }

  void SetUp() override {
    std_srvs::Trigger trigger;
    ASSERT_TRUE(ros::service::call(graph_->topic("fusion_ukf/reset"), trigger));
    for (auto& [topic, messages] : seen_) messages = 0;
  }

  static sensor_msgs::PointCloud2Ptr cloudOf(const SimulatedSweep& simulated) {
    const Sweep sweep = driverSweep(simulated);
    const auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
    writeVelodyneCloud(sweep, *cloud);
    cloud->header.frame_id = "velodyne";
    cloud->header.stamp = timeAt(epoch_, sweep.stamp_s);
    return cloud;
  }

  static ros::Time epoch_;  ///< of the drive; the next one begins where it ended, so that stamps go on as usual
  static GraphDriver* graph_;
  static std::vector<ros::Subscriber> watched_;
  static std::map<std::string, int> seen_;  ///< messages by topic, in this drive
};

GraphDriver* SimulatedFaults::graph_ = nullptr;
std::vector<ros::Subscriber> SimulatedFaults::watched_;
std::map<std::string, int> SimulatedFaults::seen_;
ros::Time SimulatedFaults::epoch_(1577836800, 0);

TEST_P(SimulatedFaults, EverySweepHasAPoseOrAnHonestState) {
  const Case& test = GetParam();
  ros::Time newest;
  StampSequence stamps;
  Pose T_world_first = Pose::Identity(), T_odom_first = Pose::Identity();
  std::uint32_t told = 0;
  std::size_t answered = 0;
  for (const SimulatedSweep& simulated : arrivals(test)) {
    const sensor_msgs::PointCloud2Ptr cloud = cloudOf(simulated);
    const ros::Time stamp = cloud->header.stamp;
    const StampOrder order = newest.isZero() ? StampOrder::kAdvances : stamps.next((stamp - newest).toSec());
    if (order != StampOrder::kAdvances && !beginsDrive(order)) {
      graph_->publish(cloud);  // refused; the next sweep tells
      continue;
    }
    if (beginsDrive(order)) stamps.beginDrive();
    newest = stamp;
    ASSERT_TRUE(graph_->drive(cloud)) << simulated.begin_s << " s";
    ++answered;
    const messages::FilterState& state = graph_->states.at(stamp);
    const messages::TimeToFailure& time = graph_->times.at(stamp);
    EXPECT_EQ(graph_->states.count(stamp), 1u);
    EXPECT_EQ(graph_->odometry.count(stamp), 1u);
    EXPECT_FALSE(state.deadline_missed);
    EXPECT_LE(time.state, messages::TimeToFailure::FAILED);
    EXPECT_TRUE(time.time_to_failure == -1.0 || (time.time_to_failure >= 0.0 && time.time_to_failure <= time.horizon));
    if (state.dt == 0.0) {
      T_world_first = simulated.T_world_base_end;
      T_odom_first = graph_->T_odom_base(stamp);
    }
    told |= time.reasons;
    const Pose truth = T_world_first.inverse() * simulated.T_world_base_end;
    const Pose motion = T_odom_first.inverse() * graph_->T_odom_base(stamp);
    const double error_m = (motion.translation() - truth.translation()).head<2>().norm();
    if (error_m > kAlertLimit_m) {
      EXPECT_NE(time.state, messages::TimeToFailure::OK) << simulated.begin_s << " s: off by " << error_m << " m";
    }
  }
  epoch_ = newest;
  EXPECT_GE(answered, 10u);
  EXPECT_TRUE(waitFor([] { return topicsNotSeen().empty(); })) << topicsNotSeen();
  EXPECT_TRUE(has(told, test.reasons)) << "told: " << told << ", must have: " << test.reasons;
  if (!test.recovers) return;
  EXPECT_TRUE(graph_->states.at(newest).measurement_applied);
  EXPECT_EQ(graph_->times.at(newest).reasons & test.reasons, 0u) << graph_->times.at(newest).reasons_text;
}

INSTANTIATE_TEST_SUITE_P(Kinds, SimulatedFaults, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

TEST(NumbersNotFinite, SeesFieldsListsAndPartsOfAnyMessage) {
  const double nan = std::nan("");
  messages::FilterState state;
  EXPECT_EQ(numbersNotFinite(state), "");
  state.speed_kept = nan;
  EXPECT_NE(numbersNotFinite(state), "");
  state.speed_kept = 0.0;
  state.measurement_nis = {0.0, HUGE_VAL};
  EXPECT_NE(numbersNotFinite(state), "");
  messages::TimeToFailure time;
  time.alert_limit = nan;  // the last field
  EXPECT_NE(numbersNotFinite(time), "");
  visualization_msgs::MarkerArray markers;
  markers.markers.resize(2);
  EXPECT_EQ(numbersNotFinite(markers), "");
  markers.markers[1].points.resize(1);
  markers.markers[1].points[0].z = nan;
  EXPECT_NE(numbersNotFinite(markers), "");
  Sweep sweep;
  sweep.points_lidar = {{1.0f, 2.0f, 3.0f}, {1.0f, 2.0f, 3.0f}};
  sensor_msgs::PointCloud2Ptr cloud = cloudOf(sweep, ros::Time(1, 0));
  EXPECT_EQ(numbersNotFinite(*cloud), "");
  const float infinity = HUGE_VALF;
  std::memcpy(&cloud->data[cloud->point_step + 4], &infinity, sizeof infinity);
  EXPECT_EQ(numbersNotFinite(*cloud), " y of point 1");
}

TEST(SimulatedFaultCases, NameEveryKind) {
  for (const FaultTraits& traits : faultTraits()) {
    EXPECT_TRUE(std::any_of(cases().begin(), cases().end(), [&](const Case& test) {
      return test.faults.size() == 1 && Fault::parse(test.faults[0]).kind == traits.kind;
    })) << traits.name;
  }
}

}  // namespace
}  // namespace fail_aware::simulated_faults_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "simulated_faults_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
