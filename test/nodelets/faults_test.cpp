// What the graph says when a nodelet is absent from the start, is unloaded in flight, and comes back: each in turn, in
// one manager. Order of events, not time: the very next sweep tells.
#include <gtest/gtest.h>

#include "../support/graph_driver.hpp"

namespace fail_aware {
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
  void waitForLinks(const std::vector<std::string>& names) {
    std::vector<std::string> topics;
    for (const std::string& name : names) topics.push_back(graph_.topic(name));
    EXPECT_TRUE(waitFor([&] { return allLinked(topics); }));
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
  std::uint32_t reasons;  ///< that its absence gives, from the second sweep on
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
    EXPECT_TRUE(has(reasons, stage.reasons)) << "absent: " << reasonText(reasons);
  }
  RecordProperty("absent_answer_ms", static_cast<int>(1e3 * graph_.answer_s));
  for (int round = 0; round < 2; ++round) {
    load(stage.name);
    ASSERT_TRUE(graph_.waitUntilLinked());
    // back: a reference has to be there before the first measurement
    bool recovered = false;
    for (int i = 0; i < 5 && !recovered; ++i) recovered = (drive() & stage.reasons & ~Reason::REASON_MISSING_CORNERS) == 0;
    EXPECT_TRUE(recovered) << "round " << round;
    EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).corrected);
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
    testing::Values(Stage{"sweep_correction", kNoSweep},
                    Stage{"icp_point_to_point", Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_ICP_POINT},
                    Stage{"icp_point_to_plane", Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_ICP_PLANE},
                    Stage{"corner_svd", Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_CORNERS}),
    [](const auto& stage) { return std::string(stage.param.name); });

TEST_F(Faults, WithoutTheMonitorTheOdometryGoesOnAndNoTimeIsTold) {
  loadAllBut("fail_aware_monitor");
  graph_.monitored = false;
  start();
  if (HasFatalFailure()) return;
  for (int i = 0; i < 3; ++i) drive();
  EXPECT_FALSE(graph_.times.connected()) << "a planner that hears nothing for 0.5 s takes it as failed";
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).corrected);
  load("fail_aware_monitor");
  ASSERT_TRUE(graph_.waitUntilLinked());
  graph_.monitored = true;
  drive();
  unload("fail_aware_monitor");
  graph_.monitored = false;
  drive();
  EXPECT_EQ(graph_.times.count(stampOfSweep(next_ - 1)), 0u);
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).corrected);
}

TEST_F(Faults, WithoutTheFilterTheMonitorSaysFailedAndStaleUntilItIsBack) {
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
    return last && last->state == Reason::FAILED && has(last->reasons, Reason::REASON_STALE) && last->time_to_failure == 0.0;
  }));
  load("fusion_ukf");
  ASSERT_TRUE(graph_.waitUntilLinked());
  graph_.sendTransform();
  ASSERT_TRUE(graph_.start(streetCloud(next_))) << "a new start, where the vehicle is now";
  EXPECT_EQ(graph_.states.at(stampOfSweep(next_)).dt, 0.0);
  ++next_;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(has(drive(), Reason::REASON_STALE));
  EXPECT_TRUE(graph_.states.at(stampOfSweep(next_ - 1)).corrected);
}

TEST_F(Faults, AStageThatIsConnectedButSilentIsWaitedForToTheDeadlineAndThenNoLonger) {
  graph_.node().setParam("fusion_ukf/deadline_s", 1.0);
  graph_.node().setParam("fusion_ukf/first_deadline_s", 1.0);
  loadAllBut("corner_svd");
  graph_.node().setParam("fusion_ukf/deadline_s", 600.0);
  graph_.node().setParam("fusion_ukf/first_deadline_s", 600.0);
  ros::Publisher silent = graph_.node().advertise<messages::PoseMeasurement>("measurement/corner_svd", 1);
  ASSERT_TRUE(graph_.waitUntilLinked());
  start();
  if (HasFatalFailure()) return;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(has(drive(), Reason::REASON_NO_ANSWER | Reason::REASON_MISSING_CORNERS)) << i;
  // it speaks, too late, of the last sweep: the next one waits for it again
  messages::PoseMeasurement late;
  late.header.stamp = stampOfSweep(next_ - 1);
  late.source = kCornerSvd;
  late.status = messages::PoseMeasurement::TOO_FEW_CORNERS;
  silent.publish(late);
  ros::Subscriber answer = graph_.node().subscribe<messages::SweepPrediction>(
      "sweep/prediction", 10, [&](const messages::SweepPredictionConstPtr& prediction) {
        late.header.stamp = prediction->header.stamp;
        silent.publish(late);
      });
  ASSERT_TRUE(waitFor([&] { return answer.getNumPublishers() > 0; }));
  bool answered = false;
  for (int i = 0; i < 10 && !answered; ++i) answered = !has(drive(), Reason::REASON_NO_ANSWER);
  EXPECT_TRUE(answered);
}

}  // namespace
}  // namespace fail_aware

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "faults_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
