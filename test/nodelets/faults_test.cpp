// What the graph says when a nodelet is absent from the start, is unloaded in flight, and comes back: each in turn, in
// one manager. Order of events, not time: the very next sweep tells.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../support/bus_links.hpp"
#include "../support/graph_driver.hpp"

namespace fail_aware::faults_test {
namespace {

using Reason = messages::TimeToFailure;

class Faults : public testing::Test {
 protected:
  ~Faults() override {
    for (const std::string& name : loaded_) manager_.unload(name);
  }

  void load(const std::string& name) {
    ASSERT_TRUE(manager_.load(name)) << name;
    loaded_.push_back(name);
  }
  void unload(const std::string& name) {
    ASSERT_TRUE(manager_.unload(name)) << name;
    loaded_.erase(std::find(loaded_.begin(), loaded_.end(), name));
  }
  void loadAllBut(const std::string& absent) {
    for (const auto& [name, type] : NodeletManager::types()) {
      if (name != absent) load(name);
    }
  }
  /// The next sweep; its reasons.
  std::uint32_t drive() {
    const ros::Time stamp = stampOfSweep(next_);
    EXPECT_TRUE(graph_.drive(streetCloud(next_))) << "sweep " << next_;
    ++next_;
    return graph_.times.count(stamp) > 0 ? graph_.times.at(stamp).reasons : 0u;
  }
  /// For the FusionUkf that is loaded next.
  void setDeadline(double seconds) {
    graph_.node().setParam("fusion_ukf/deadline_s", seconds);
    graph_.node().setParam("fusion_ukf/first_deadline_s", seconds);
  }
  /// Of the FusionUkf that runs.
  bool reconfigureDeadline(double seconds) {
    dynamic_reconfigure::Reconfigure call;
    dynamic_reconfigure::DoubleParameter value;
    value.value = seconds;
    for (const char* name : {"deadline_s", "first_deadline_s"}) {
      value.name = name;
      call.request.config.doubles.push_back(value);
    }
    return ros::service::call(graph_.topic("fusion_ukf/set_parameters"), call);
  }
  bool call(const std::string& service) {
    std_srvs::Trigger trigger;
    return ros::service::call(graph_.topic(service), trigger) && trigger.response.success;
  }
  void waitForLinks(const std::vector<std::string>& names) {
    std::vector<std::string> topics;
    for (const std::string& name : names) topics.push_back(graph_.topic(name));
    EXPECT_TRUE(waitFor([&] { return allLinked(topics); }));
  }
  /// Keeps in `said` what the filter says in /diagnostics.
  ros::Subscriber listenToFilter(std::string& said) {
    return graph_.node().subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 50, [&said](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
          for (const auto& status : array->status) {
            if (status.name.find("fusion_ukf") != std::string::npos) said = status.message;
          }
        });
  }
  void start() {
    graph_.sendTransform();
    waitForLinks({kCloudTopic, "filter_state", "odometry"});
    ASSERT_TRUE(graph_.start(streetCloud(next_++)));
  }

  GraphDriver graph_;
  NodeletManager manager_;
  std::vector<std::string> loaded_;
  int next_ = 0;
};

struct Stage {
  const char* name;
  std::uint32_t reasons;                 ///< that its absence gives, from the second sweep on
  std::uint32_t reasons_from_the_start;  ///< likewise, where it was never there
};

class FaultsOfAStage : public Faults, public testing::WithParamInterface<Stage> {};

TEST_P(FaultsOfAStage, AbsentKilledAndBackEachIsToldInTheNextSweep) {
  const Stage stage = GetParam();
  // absent from the start
  loadAllBut(stage.name);
  start();
  if (testing::Test::HasFatalFailure()) return;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t reasons = drive();
    EXPECT_TRUE(has(reasons, stage.reasons_from_the_start)) << "absent: " << reasonText(reasons);
  }
  RecordProperty("absent_answer_ms", static_cast<int>(1e3 * graph_.answer_s));
  for (int round = 0; round < 2; ++round) {
    load(stage.name);
    ASSERT_TRUE(graph_.waitUntilLinked());
    // back: a reference has to be there before the first measurement
    bool recovered = false;
    for (int i = 0; i < 5 && !recovered; ++i) {
      recovered = (drive() & stage.reasons & ~static_cast<std::uint32_t>(Reason::REASON_MISSING_CORNERS)) == 0 &&
                  graph_.states.at(stampOfSweep(next_ - 1)).measurement_applied;
    }
    EXPECT_TRUE(recovered) << "round " << round;
    if (round == 1) break;
    // killed in flight
    unload(stage.name);
    const std::uint32_t reasons = drive();
    EXPECT_TRUE(has(reasons, stage.reasons)) << "killed: " << reasonText(reasons);
    RecordProperty("killed_answer_ms", static_cast<int>(1e3 * graph_.answer_s));
  }
}

constexpr std::uint32_t kNoSweep = Reason::REASON_NO_ANSWER | Reason::REASON_NO_MEASUREMENT |
                                   Reason::REASON_PREDICTION_ONLY | Reason::REASON_MISSING_ICP_POINT |
                                   Reason::REASON_MISSING_ICP_PLANE | Reason::REASON_MISSING_CORNERS;

INSTANTIATE_TEST_SUITE_P(
    InTurn, FaultsOfAStage,
    testing::Values(Stage{"sweep_correction", kNoSweep, Reason::REASON_NO_ANSWER | Reason::REASON_MOTION_UNKNOWN},
                    Stage{"icp_point_to_point", Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_ICP_POINT,
                          Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_ICP_POINT},
                    Stage{"icp_point_to_plane", Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_ICP_PLANE,
                          Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_ICP_PLANE},
                    Stage{"corner_svd", Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_CORNERS,
                          Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_CORNERS}),
    [](const auto& stage) { return std::string(stage.param.name); });

TEST_F(Faults, WithoutTheMonitorTheOdometryGoesOnAndNoTimeIsTold) {
  loadAllBut("fail_aware_monitor");
  graph_.monitored = false;
  start();
  if (HasFatalFailure()) return;
  for (int i = 0; i < 3; ++i) drive();
  EXPECT_FALSE(graph_.times.connected()) << "a planner that hears nothing for 0.5 s takes it as failed";
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).measurement_applied);
  load("fail_aware_monitor");
  ASSERT_TRUE(graph_.waitUntilLinked());
  graph_.monitored = true;
  drive();
  unload("fail_aware_monitor");
  graph_.monitored = false;
  drive();
  EXPECT_EQ(graph_.times.count(stampOfSweep(next_ - 1)), 0u);
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).measurement_applied);
}

TEST_F(Faults, WithoutFilterTheStateIsFailedAndStale) {
  loadAllBut("");
  ASSERT_TRUE(graph_.waitUntilLinked());
  start();
  if (HasFatalFailure()) return;
  for (int i = 0; i < 3; ++i) drive();
  unload("fusion_ukf");
  messages::TimeToFailureConstPtr last;
  ros::Subscriber listener = graph_.node().subscribe<messages::TimeToFailure>(
      "time_to_failure", 10, [&](const messages::TimeToFailureConstPtr& message) { last = message; });
  EXPECT_TRUE(waitFor([&] {
    return last && last->state == Reason::FAILED && has(last->reasons, Reason::REASON_STALE) &&
           last->time_to_failure == 0.0;
  }));
  load("fusion_ukf");
  ASSERT_TRUE(graph_.waitUntilLinked());
  graph_.sendTransform();
  ASSERT_TRUE(graph_.start(streetCloud(next_))) << "a new start, where the vehicle is now";
  EXPECT_EQ(graph_.states.at(stampOfSweep(next_)).dt, 0.0);
  ++next_;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(has(drive(), Reason::REASON_STALE));
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).measurement_applied);
}

TEST_F(Faults, ResetEndsTheServiceUntilAskedAgain) {
  graph_.node().setParam("fail_aware_monitor/start_redundant", false);
  loadAllBut("");
  graph_.node().deleteParam("fail_aware_monitor/start_redundant");
  ASSERT_TRUE(graph_.waitUntilLinked());
  const auto last = [&] { return graph_.times.at(stampOfSweep(next_ - 1)); };
  ASSERT_TRUE(call("fail_aware_monitor/start_redundant"));  // before the first sweep: t1 waits for an observed motion
  start();
  if (HasFatalFailure()) return;
  EXPECT_TRUE(last().t1.isZero());
  EXPECT_TRUE(has(last().reasons, Reason::REASON_MOTION_UNKNOWN));
  const auto driveUntilServing = [&] {
    for (int i = 0; i < 10 && last().t1.isZero(); ++i) drive();
    return !last().t1.isZero();
  };
  EXPECT_TRUE(driveUntilServing());
  ASSERT_TRUE(call("fail_aware_monitor/stop_redundant"));
  messages::TimeToFailureConstPtr said;
  ros::Subscriber listener = graph_.node().subscribe<messages::TimeToFailure>(
      "time_to_failure", 10, [&](const messages::TimeToFailureConstPtr& message) { said = message; });
  EXPECT_TRUE(waitFor([&] { return said && has(said->reasons, Reason::REASON_STALE) && said->t1.isZero(); }));
  drive();
  EXPECT_TRUE(last().t1.isZero());
  EXPECT_EQ(last().state, Reason::UNKNOWN);
  ASSERT_TRUE(call("fail_aware_monitor/start_redundant"));
  EXPECT_TRUE(driveUntilServing());
  ASSERT_TRUE(call("fusion_ukf/reset"));
  for (int i = 0; i < 3; ++i) {
    drive();
    EXPECT_TRUE(last().t1.isZero()) << "odom is another; nobody may go on as if it were not";
    EXPECT_EQ(last().state, Reason::UNKNOWN);
  }
  ASSERT_TRUE(call("fail_aware_monitor/start_redundant"));
  EXPECT_TRUE(driveUntilServing());
  ASSERT_TRUE(call("fusion_ukf/reset"));
  ASSERT_TRUE(call("fail_aware_monitor/start_redundant"));
  drive();
  EXPECT_TRUE(driveUntilServing()) << "asked for after the reset";
}

TEST_F(Faults, UnloadedInTheMiddleOfASweepANodeletTakesNothingWithIt) {
  setDeadline(2.0 * patienceFactor());
  loadAllBut("");
  ASSERT_TRUE(graph_.waitUntilLinked());
  start();
  if (HasFatalFailure()) return;
  for (int i = 0; i < 2; ++i) drive();
  for (const char* name : {"sweep_correction", "icp_point_to_point", "icp_point_to_plane", "corner_svd",
                           "fail_aware_monitor", "fusion_ukf"}) {
    graph_.publish(streetCloud(next_++));
    unload(name);
    load(name);
    ASSERT_TRUE(graph_.waitUntilLinked()) << name;
  }
  graph_.sendTransform();
  // A topic that is advertised anew at once keeps its links in roscpp's list while they are mended, some tenths of a
  // second later: what goes there at first may be lost. So first a sweep that everybody answers.
  ASSERT_TRUE(waitFor([&] {
    const ros::Time stamp = stampOfSweep(next_);
    return graph_.drive(streetCloud(next_++), 10.0 * patienceFactor()) && !graph_.states.at(stamp).deadline_missed;
  }));
  ASSERT_TRUE(reconfigureDeadline(600.0));
  ASSERT_TRUE(call("fusion_ukf/reset"));
  for (int i = 0; i < 3; ++i) drive();
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).measurement_applied);
  setDeadline(600.0);
}

TEST_F(Faults, WhatKeepsANodeletFromBeingLoadedIsInTheLog) {
  std::string log;
  ros::Subscriber listener = graph_.node().subscribe<rosgraph_msgs::Log>(
      "/rosout", 100, [&](const rosgraph_msgs::LogConstPtr& line) { log += line->msg + '\n'; });
  ASSERT_TRUE(manager_.load("corner_svd"));  // the manager runs
  ASSERT_TRUE(manager_.unload("corner_svd"));
  const auto expectRefused = [&](const std::string& name, const std::string& said) {
    log.clear();
    EXPECT_TRUE(waitFor([&] {  // again and again until the log's link is up
      EXPECT_FALSE(manager_.load(name)) << said;
      return log.find(name + " is not loaded") != std::string::npos && log.find(said) != std::string::npos;
    })) << said + ", not in:\n" + log;  // a line of the case before may come late
  };
  const auto refused = [&](const std::string& key, const auto& value, const std::string& name,
                           const std::string& rule) {
    graph_.node().setParam(key, value);
    expectRefused(name, key.substr(key.rfind('/') + 1) + rule);
    graph_.node().deleteParam(key);
  };
  refused("fusion_ukf/nonsense", 1, "fusion_ukf", ": unknown");
  refused("fusion_ukf/deadline_s", "soon", "fusion_ukf", ": must be a number");
  refused("fusion_ukf/queue_size", 0, "fusion_ukf", " = 0: must be in [1, 6]");
  refused("fail_aware_monitor/stale_sweeps", -1.0, "fail_aware_monitor", " = -1: must be in [1, 20]");
  refused("fusion_ukf/odom_frame", "base_link", "fusion_ukf", " = base_link: must not be base_frame");
  refused("icp_point_to_point/nonsense", 1, "icp_point_to_point", ": unknown");
  refused("sweep_correction/nonsense", 1, "sweep_correction", ": unknown");
  refused("profile/nonsense", 1.0, "icp_point_to_plane", ": unknown");
  refused("sensor/nonsense", 1.0, "sweep_correction", ": unknown");
  XmlRpc::XmlRpcValue vehicle;
  ASSERT_TRUE(graph_.node().getParam("vehicle", vehicle));
  graph_.node().deleteParam("vehicle");
  expectRefused("fusion_ukf", "vehicle: not on the parameter server");
  graph_.node().setParam("vehicle", vehicle);
  XmlRpc::XmlRpcValue sensor;
  ASSERT_TRUE(graph_.node().getParam("sensor", sensor));
  graph_.node().setParam("sensor", vehicle);
  expectRefused("fusion_ukf", "sensor: is the file of a vehicle: give it as vehicle:=, not as sensor:=");
  graph_.node().setParam("sensor", sensor);
  setDeadline(600.0);
  load("fusion_ukf");
}

TEST_F(Faults, NodeletNamesParametersWithoutEffect) {
  std::string log;
  ros::Subscriber listener = graph_.node().subscribe<rosgraph_msgs::Log>(
      "/rosout", 100, [&](const rosgraph_msgs::LogConstPtr& line) { log += line->msg + '\n'; });
  for (const char* name : {"corner_svd", "fail_aware_monitor", "fusion_ukf", "sweep_correction"}) {
    graph_.node().setParam(std::string(name) + "/diagnostic_period", 0.5);
    graph_.node().setParam(std::string(name) + "/num_worker_threads", 2);
    load(name);
    unload(name);
  }
  EXPECT_TRUE(waitFor([&] {
    graph_.node().setParam("corner_svd/min_corners", 9);
    load("corner_svd");
    unload("corner_svd");
    return log.find("corner_svd/min_corners: the profile's value counts") != std::string::npos;
  })) << log;
}

/// The corners' answer to the sweep at `stamp`: none to measure.
messages::PoseMeasurement noCorners(const ros::Time& stamp) {
  messages::PoseMeasurement message;
  message.header.stamp = stamp;
  message.source = kCornerSvd;
  message.status = messages::PoseMeasurement::TOO_FEW_CORNERS;
  return message;
}

TEST_F(Faults, SilentStageIsGivenUpAtTheDeadline) {
  setDeadline(1.0);
  loadAllBut("corner_svd");
  setDeadline(600.0);
  ros::Publisher silent = graph_.node().advertise<messages::PoseMeasurement>("measurement/corner_svd", 1);
  ASSERT_TRUE(graph_.waitUntilLinked());
  start();
  if (HasFatalFailure()) return;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(has(drive(), Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_CORNERS)) << i;
  // From here on no deadline comes: a sweep is closed when nobody is left to wait for, on however slow a machine.
  ASSERT_TRUE(reconfigureDeadline(600.0));
  drive();
  // it speaks, too late, of the last sweep: the next one waits for it again
  silent.publish(noCorners(stampOfSweep(next_ - 1)));
  ros::Subscriber answer = graph_.node().subscribe<messages::SweepPrediction>(
      "sweep/prediction", 10, [&](const messages::SweepPredictionConstPtr& prediction) {
        silent.publish(noCorners(prediction->header.stamp));
      });
  ASSERT_TRUE(waitFor([&] { return answer.getNumPublishers() > 0; }));
  EXPECT_TRUE(waitFor([&] { return !has(drive(), Reason::REASON_NO_ANSWER); }));
}

TEST_F(Faults, AStageThatAnswersLateIsGivenMoreTime) {
  constexpr double kDeadline_s = 1.0;
  setDeadline(kDeadline_s);
  graph_.node().setParam("fusion_ukf/late_deadline_s", 600.0);
  loadAllBut("corner_svd");
  setDeadline(600.0);
  graph_.node().deleteParam("fusion_ukf/late_deadline_s");
  ros::Publisher slow = graph_.node().advertise<messages::PoseMeasurement>("measurement/corner_svd", 1);
  ASSERT_TRUE(graph_.waitUntilLinked());
  start();
  if (HasFatalFailure()) return;
  EXPECT_TRUE(waitFor([&] {
    slow.publish(noCorners(stampOfSweep(next_ - 1)));  // too late
    const ros::Time stamp = stampOfSweep(next_);
    graph_.publish(streetCloud(next_++));
    if (waitFor([&] { return graph_.answered(stamp); }, 3.0 * kDeadline_s)) return false;  // the next one then
    slow.publish(noCorners(stamp));  // after the deadline, and in time nevertheless
    return waitFor([&] { return graph_.answered(stamp); }) &&
           !has(graph_.times.at(stamp).reasons, Reason::REASON_NO_ANSWER);
  }));
}

TEST_F(Faults, ATransformInMillimetresIsToldAndNotUsed) {
  Pose in_mm = synthetic::Lidar().T_base_lidar;
  in_mm.translation() *= 1000.0;
  graph_.sendTransform(in_mm);
  std::string said;
  const ros::Subscriber listener = listenToFilter(said);
  loadAllBut("");
  ASSERT_TRUE(graph_.waitUntilLinked());
  graph_.publish(streetCloud(next_++));
  EXPECT_TRUE(waitFor([&] { return said.find("must be in [-100, 100]") != std::string::npos; })) << said;
  graph_.sendTransform();
  EXPECT_TRUE(graph_.start(streetCloud(next_)));
}

TEST_F(Faults, AStageThatIsAlwaysTooLateIsWaitedForNoLonger) {
  setDeadline(0.2);
  graph_.node().setParam("fusion_ukf/late_deadline_s", 0.2);
  loadAllBut("corner_svd");
  setDeadline(600.0);
  graph_.node().deleteParam("fusion_ukf/late_deadline_s");
  ros::Publisher slow = graph_.node().advertise<messages::PoseMeasurement>("measurement/corner_svd", 10);
  std::string said;
  const ros::Subscriber listener = listenToFilter(said);
  ASSERT_TRUE(graph_.waitUntilLinked());
  start();
  if (HasFatalFailure()) return;
  const ros::Time stamp = stampOfSweep(next_);
  EXPECT_TRUE(has(drive(), Reason::REASON_NO_ANSWER)) << "closed by its deadline";
  for (int i = 0; i < 3; ++i) slow.publish(noCorners(stamp));
  ASSERT_TRUE(waitFor([&] { return said == "no answer from corner_svd (too late)"; })) << said;
  // From here on no deadline comes: a sweep is closed when nobody is left to wait for.
  ASSERT_TRUE(reconfigureDeadline(600.0));
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(has(drive(), Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_CORNERS));
  // In a sweep that waits for no other source the answer comes at an unknown time; before 600 s it is in time.
  ros::Subscriber quick = graph_.node().subscribe<messages::SweepPrediction>(
      "sweep/prediction", 10,
      [&](const messages::SweepPredictionConstPtr& prediction) { slow.publish(noCorners(prediction->header.stamp)); });
  ASSERT_TRUE(waitFor([&] { return quick.getNumPublishers() > 0; }));
  EXPECT_TRUE(waitFor([&] { return !has(drive(), Reason::REASON_NO_ANSWER); }));
}

}  // namespace
}  // namespace fail_aware::faults_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "faults_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
