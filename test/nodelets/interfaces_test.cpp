// What plugs into the running graph: clouds as different drivers pack them, stamps that jump, services, set_pose, extra
// measurement sources, dynamic_reconfigure, diagnostics. One graph for all tests; each begins with ~reset.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <std_srvs/Trigger.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "../support/bus_links.hpp"
#include "../support/driver_clouds.hpp"
#include "../support/graph_driver.hpp"
#include "../support/tum_trajectory.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/io/trajectory_io.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::interfaces_test {
namespace {

using Reason = messages::TimeToFailure;

class Interfaces : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    graph_ = new GraphDriver;
    using Answer = boost::function<void(const messages::SweepPredictionConstPtr&)>;
    // A source of one's own that answers every sweep, mostly that it has nothing.
    visual_ = new ros::Publisher(graph_->node().advertise<messages::PoseMeasurement>("/visual/pose", 10));
    predictions_ = new ros::Subscriber(graph_->node().subscribe<messages::SweepPrediction>(
        "sweep/prediction", 10, Answer([](const messages::SweepPredictionConstPtr& prediction) {
          messages::PoseMeasurement measurement;
          if (visual_pose_) measurement = visual_pose_(*prediction);
          if (!visual_pose_) measurement.status = messages::PoseMeasurement::NOT_CONVERGED;
          const std::string frame = measurement.header.frame_id;
          measurement.header = prediction->header;
          if (!frame.empty()) measurement.header.frame_id = frame;
          measurement.source = "visual";
          measurement.sweep_points = -1;
          visual_->publish(measurement);
        })));
    graph_->sendTransform();
    ASSERT_TRUE(graph_->waitUntilLinked());
    ASSERT_TRUE(waitFor([] { return allLinked({"/visual/pose"}); }));
    ASSERT_TRUE(graph_->start(streetCloud(0)));
  }
  static void TearDownTestSuite() {
    delete predictions_;
    delete visual_;
    delete graph_;
  }

  void SetUp() override {
    ASSERT_TRUE(waitFor([] { return call("fusion_ukf/reset"); }));  // a link to a service may break
  }

  static bool call(const std::string& service, std::string* message = nullptr) {
    std_srvs::Trigger trigger;
    if (!ros::service::call(graph_->topic(service), trigger)) return false;
    if (message != nullptr) *message = trigger.response.message;
    return trigger.response.success;
  }
  static void drive(int first, int last) {
    for (int i = first; i <= last; ++i) ASSERT_TRUE(graph_->drive(streetCloud(i))) << "sweep " << i;
  }
  static const messages::FilterState& stateAt(int i) { return graph_->states.at(stampOfSweep(i)); }
  static std::uint32_t reasonsAt(int i) { return graph_->times.at(stampOfSweep(i)).reasons; }
  static Pose poseAt(int i) { return graph_->T_odom_base(stampOfSweep(i)); }
  static Pose truthAt(int i, int first = 0) {
    return synthetic::Drive().T_odom_base(kSweepPeriod_s * i, kSweepPeriod_s * first);
  }
  static void expectNear(const Pose& a, const Pose& b, double tolerance_m, const std::string& what) {
    EXPECT_LT((a.translation() - b.translation()).norm(), tolerance_m) << what;
    EXPECT_LT(logSe3(a.inverse() * b).tail<3>().norm(), 0.01) << what;
  }

  static GraphDriver* graph_;
  static ros::Publisher* visual_;
  static ros::Subscriber* predictions_;
  static std::function<messages::PoseMeasurement(const messages::SweepPrediction&)> visual_pose_;
};

GraphDriver* Interfaces::graph_ = nullptr;
ros::Publisher* Interfaces::visual_ = nullptr;
ros::Subscriber* Interfaces::predictions_ = nullptr;
std::function<messages::PoseMeasurement(const messages::SweepPrediction&)> Interfaces::visual_pose_;

// ---- clouds ---------------------------------------------------------------------------------------------------------

TEST_F(Interfaces, CloudsOfEveryDriverGiveTheSameOdometry) {
  struct Packing {
    const char* name;
    std::function<sensor_msgs::PointCloud2Ptr(int)> cloud;
  };
  constexpr float kHalf = static_cast<float>(0.5 * kSweepPeriod_s);
  const Packing packings[] = {
      {"x y z intensity time", [](int i) { return streetCloud(i); }},
      {"velodyne driver, time zero", [](int i) { return velodyneCloud(i, [](float) { return 0.0f; }); }},
      {"velodyne driver, time negative", [](int i) { return velodyneCloud(i, [](float t) { return t - kHalf; }); }},
      {"velodyne driver, time positive", [](int i) { return velodyneCloud(i, [](float t) { return t + kHalf; }); }},
      {"kitti2bag", kittiCloud},
      {"organised with NaN", organisedCloud}};
  constexpr int kSweeps = 5;
  std::vector<Pose> expected;
  for (const Packing& packing : packings) {
    SetUp();
    for (int i = 0; i < kSweeps; ++i) {
      ASSERT_TRUE(graph_->drive(packing.cloud(i))) << packing.name << ", sweep " << i;
      EXPECT_EQ(stateAt(i).measurement_applied != 0, i > 0) << packing.name << ", sweep " << i;
      if (static_cast<int>(expected.size()) <= i) expected.push_back(poseAt(i));
      // Points and times are rounded otherwise in each. A seed of the point-to-point ICP that then ends elsewhere moves
      // its mean by 7 mm, the pose by 2. Times that are wrong by 0.4 ms would move it by 5.
      expectNear(poseAt(i), expected[static_cast<std::size_t>(i)], 5e-3,
                 packing.name + std::string(", sweep ") + std::to_string(i));
    }
  }
  expectNear(expected.back(), truthAt(kSweeps - 1), 0.05, "truth");
}

TEST_F(Interfaces, ACloudOfAnotherFrameIsLostAndCounted) {
  drive(0, 2);
  const sensor_msgs::PointCloud2Ptr other = streetCloud(3);
  other->header.frame_id = "rear_lidar";
  graph_->states.forget(stampOfSweep(3));  // of other tests
  graph_->publish(other);
  drive(4, 4);
  EXPECT_EQ(graph_->states.count(stampOfSweep(3)), 0u);
  EXPECT_EQ(stateAt(4).dropped_before, 1u);
  EXPECT_TRUE(has(reasonsAt(4), Reason::REASON_DROPPED_SWEEPS));
  EXPECT_TRUE(stateAt(4).measurement_applied);

  const sensor_msgs::PointCloud2Ptr beside = streetCloud(0);  // of the same stamp as a good one
  beside->header = streetCloud(5)->header;
  beside->header.frame_id = "rear_lidar";
  graph_->publish(streetCloud(5));
  graph_->publish(beside);
  drive(6, 6);
  expectNear(poseAt(6), truthAt(6), 0.05, "the other one's points were not taken");
}

TEST_F(Interfaces, WhatIsWrongWithASweepIsToldAtOnce) {
  drive(0, 2);
  const auto driveOnly = [&](int i, const std::function<bool(const Eigen::Vector3f&)>& keep) {
    Sweep sweep = streetSweep(i), kept;
    for (const Eigen::Vector3f& p : sweep.points_lidar) {
      if (keep(p)) kept.points_lidar.push_back(p);
    }
    ASSERT_TRUE(graph_->drive(cloudOf(kept, stampOfSweep(i))));
  };
  driveOnly(3, [](const Eigen::Vector3f& p) { return p.y() > 0.0f; });
  EXPECT_TRUE(has(reasonsAt(3), Reason::REASON_SWEEP_INCOMPLETE));
  driveOnly(4, [](const Eigen::Vector3f& p) { return p.norm() < 10.0f; });
  EXPECT_TRUE(has(reasonsAt(4), Reason::REASON_LOW_VISIBILITY));
  driveOnly(5, [](const Eigen::Vector3f&) { return false; });
  EXPECT_TRUE(has(reasonsAt(5), Reason::REASON_SWEEP_EMPTY | Reason::REASON_NO_MEASUREMENT));
  for (int i = 6; i < 11; ++i) ASSERT_TRUE(graph_->drive(cloudOf(streetSweep(6), stampOfSweep(i))));
  EXPECT_FALSE(has(reasonsAt(6), Reason::REASON_FROZEN_CLOUD));
  EXPECT_TRUE(has(reasonsAt(10), Reason::REASON_FROZEN_CLOUD)) << "within five sweeps";
  EXPECT_GE(graph_->times.at(stampOfSweep(10)).state, Reason::FAILING);
}

TEST_F(Interfaces, ACloudThatCannotBeReadIsASweepWithoutPoints) {
  drive(0, 2);
  const std::vector<std::function<void(sensor_msgs::PointCloud2&)>> damages = {
      [](sensor_msgs::PointCloud2& cloud) { cloud.fields.clear(); },
      [](sensor_msgs::PointCloud2& cloud) { cloud.fields[2].name = "height"; },
      [](sensor_msgs::PointCloud2& cloud) { cloud.data.resize(cloud.data.size() / 2); },
      [](sensor_msgs::PointCloud2& cloud) { cloud.point_step = 1; },
      [](sensor_msgs::PointCloud2& cloud) { std::fill(cloud.data.begin(), cloud.data.end(), 0xff); },  // NaN
      [](sensor_msgs::PointCloud2& cloud) { cloud.width = cloud.height = 0; }};
  int i = 3;
  for (const auto& damage : damages) {
    const sensor_msgs::PointCloud2Ptr cloud = streetCloud(i);
    damage(*cloud);
    ASSERT_TRUE(graph_->drive(cloud)) << i;
    EXPECT_TRUE(has(reasonsAt(i), Reason::REASON_SWEEP_EMPTY | Reason::REASON_PREDICTION_ONLY)) << i;
    EXPECT_TRUE(fromMessage(graph_->odometry.at(stampOfSweep(i)).pose.covariance).allFinite()) << i;
    ++i;
  }
  drive(i, i + 1);
  EXPECT_TRUE(stateAt(i + 1).measurement_applied);
}

// ---- time -----------------------------------------------------------------------------------------------------------

TEST_F(Interfaces, ABagThatBeginsAgainIsANewDriveFromTheLastPose) {
  drive(0, 8);
  std::map<int, Pose> expected;
  for (const int i : {1, 2, 3}) expected[i] = poseAt(8) * poseAt(1).inverse() * poseAt(i);
  graph_->publish(streetCloud(0));  // 0.8 s back: it may be wrong, and is refused
  drive(1, 3);                      // the next one follows on it
  EXPECT_EQ(stateAt(1).dt, 0.0);
  EXPECT_TRUE(has(reasonsAt(1), Reason::REASON_TIME_JUMP));
  EXPECT_FALSE(has(reasonsAt(2), Reason::REASON_TIME_JUMP));
  for (const auto& [i, pose] : expected) expectNear(poseAt(i), pose, 0.05, std::to_string(i));
  EXPECT_EQ(graph_->times.at(stampOfSweep(1)).sigma_x, 0.0) << "t1 is the new start";
}

TEST_F(Interfaces, OneStampFarBackIsLostAndTheDriveGoesOn) {
  drive(0, 7);
  graph_->publish(cloudOf(streetSweep(8), stampOfSweep(8) - ros::Duration(3600.0)));
  drive(9, 10);
  EXPECT_EQ(stateAt(9).dropped_before, 1u);
  EXPECT_NEAR(stateAt(9).dt, 0.2, 1e-6);
  expectNear(poseAt(10), truthAt(10), 0.05, "after it");
}

TEST_F(Interfaces, OverAGapOfASecondItGoesOn) {
  drive(0, 7);
  drive(18, 20);
  EXPECT_NEAR(stateAt(18).dt, 1.1, 1e-6);
  EXPECT_TRUE(has(reasonsAt(18), Reason::REASON_TIME_JUMP));
  EXPECT_FALSE(has(reasonsAt(19), Reason::REASON_TIME_JUMP));
  EXPECT_TRUE(stateAt(20).measurement_applied);
  expectNear(poseAt(20), truthAt(20), 0.3, "after the gap");
}

TEST_F(Interfaces, AStampFarAheadIsLostAndTheDriveGoesOn) {
  drive(0, 2);
  const ros::Time end(4294967290, 0);  // tf2 would throw
  graph_->publish(cloudOf(streetSweep(3), end));
  graph_->publish(cloudOf(streetSweep(3), stampOfSweep(3) + ros::Duration(3600.0)));
  drive(4, 6);
  EXPECT_EQ(graph_->states.count(end), 0u);
  EXPECT_EQ(stateAt(4).dropped_before, 2u);
  EXPECT_NEAR(stateAt(4).dt, 0.2, 1e-6);
  EXPECT_TRUE(stateAt(6).measurement_applied);
  expectNear(poseAt(6), truthAt(6), 0.05, "after them");
}

TEST_F(Interfaces, AClockThatIsSetForwardBeginsADrive) {
  drive(0, 2);
  const ros::Duration step(1.7e9 - 1.0 * stampOfSweep(0).sec);
  graph_->publish(cloudOf(streetSweep(3), stampOfSweep(3) + step));
  for (int i = 4; i <= 7; ++i) ASSERT_TRUE(graph_->drive(cloudOf(streetSweep(i), stampOfSweep(i) + step))) << i;
  const auto& first = graph_->states.at(stampOfSweep(4) + step);
  EXPECT_EQ(first.dt, 0.0);
  EXPECT_TRUE(has(graph_->times.at(stampOfSweep(4) + step).reasons, Reason::REASON_TIME_JUMP));
  EXPECT_TRUE(graph_->states.at(stampOfSweep(7) + step).measurement_applied);
  expectNear(graph_->T_odom_base(stampOfSweep(7) + step), poseAt(2) * truthAt(7, 4), 0.05, "since then");
}

// ---- services -------------------------------------------------------------------------------------------------------

TEST_F(Interfaces, ResetIsANewStartForAll) {
  drive(0, 4);
  EXPECT_GT(graph_->times.at(stampOfSweep(4)).sigma_x, 0.0);
  ASSERT_TRUE(call("fusion_ukf/reset"));
  drive(5, 8);
  EXPECT_EQ(stateAt(5).dt, 0.0);
  expectNear(poseAt(5), Pose::Identity(), 1e-9, "odom begins at base_link");
  EXPECT_EQ(graph_->times.at(stampOfSweep(5)).sigma_x, 0.0) << "nothing has accumulated";
  EXPECT_EQ(reasonsAt(5), std::uint32_t{Reason::REASON_MOTION_UNKNOWN}) << "nothing is wrong with a reset";
  EXPECT_TRUE(stateAt(8).measurement_applied);
  expectNear(poseAt(8), truthAt(8, 5), 0.05, "references began anew");
}

TEST_F(Interfaces, SaveTrajectoryWritesEverySweepSinceTheStart) {
  std::string message;
  EXPECT_FALSE(call("fusion_ukf/save_trajectory", &message));
  EXPECT_NE(message.find("no pose yet"), std::string::npos) << message;
  drive(0, 3);
  const std::string path =
      (std::filesystem::temp_directory_path() / ("interfaces_test_tum_" + std::to_string(getpid()) + ".txt")).string();
  graph_->node().setParam("fusion_ukf/trajectory_file", path);
  ASSERT_TRUE(call("fusion_ukf/save_trajectory", &message)) << message;
  EXPECT_NE(message.find(path + ": 4 poses"), std::string::npos) << message;
  const std::vector<StampedPose> poses = readTumTrajectory(path);
  std::filesystem::remove(path);
  ASSERT_EQ(poses.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(poses[static_cast<std::size_t>(i)].stamp_s, stampOfSweep(i).toSec(), 1e-6);
    expectNear(poses[static_cast<std::size_t>(i)].T, poseAt(i), 1e-6, std::to_string(i));
  }
  graph_->node().setParam("fusion_ukf/trajectory_file", "/no/such/folder/tum.txt");
  EXPECT_FALSE(call("fusion_ukf/save_trajectory", &message));
  EXPECT_NE(message.find("/no/such/folder"), std::string::npos) << message;
  graph_->node().setParam("fusion_ukf/trajectory_file", path);
}

// ---- set_pose -------------------------------------------------------------------------------------------------------

geometry_msgs::PoseWithCovarianceStamped poseMessage(const Pose& T, double sigma_m, double sigma_rad,
                                                     const std::string& frame, const ros::Time& stamp) {
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header.frame_id = frame;
  message.header.stamp = stamp;
  message.pose.pose = toPoseMessage(T);
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  message.pose.covariance = toCovarianceMessage(variances.asDiagonal());
  return message;
}

TEST_F(Interfaces, SetPoseMovesOdomAndKeepsTheMotion) {
  ros::Publisher publisher = graph_->node().advertise<geometry_msgs::PoseWithCovarianceStamped>("set_pose", 1);
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() == 1; }));
  drive(0, 5);
  const Pose T_new_old = poseFromVector((Vector6d() << 500.0, -200.0, 3.0, 0.0, 0.0, 2.0).finished());
  publisher.publish(poseMessage(T_new_old * poseAt(5), 0.1, 0.01, "map", stampOfSweep(5)));  // refused
  const auto epoch = stateAt(5).odom_reset_count;
  drive(6, 6);
  EXPECT_EQ(stateAt(6).odom_reset_count, epoch) << "another frame's pose is refused";
  expectNear(poseAt(6), truthAt(6), 0.05, "refused");

  // topics of one publisher and another are not ordered: it takes effect with one of the next sweeps
  publisher.publish(poseMessage(T_new_old * truthAt(6), 0.1, 0.01, "odom", stampOfSweep(6)));
  int set_at = 7;
  for (;; ++set_at) {
    ASSERT_LT(set_at, 16);
    drive(set_at, set_at);
    if (stateAt(set_at).odom_reset_count != epoch) break;
  }
  expectNear(poseAt(set_at), T_new_old * truthAt(set_at), 0.15, "moved on from its stamp");
  const nav_msgs::Odometry& odometry = graph_->odometry.at(stampOfSweep(set_at));
  EXPECT_NEAR(odometry.twist.twist.linear.x, synthetic::Drive().speed_mps, 0.5) << "the true motion";
  EXPECT_NEAR(std::sqrt(odometry.pose.covariance[35]), 0.01, 1e-3) << "the covariance that was set";
  EXPECT_TRUE(graph_->times.at(stampOfSweep(set_at)).sigma_x == 0.0) << "a new t1";
  const Pose T_set = poseAt(set_at);
  drive(set_at + 1, set_at + 5);
  for (int i = set_at + 1; i <= set_at + 5; ++i) {
    EXPECT_TRUE(stateAt(i).measurement_applied) << i;
    EXPECT_EQ(stateAt(i).odom_reset_count, stateAt(set_at).odom_reset_count);
    EXPECT_GT(stateAt(i).valid_inputs, 1u) << "references began anew, the motion is known";
    expectNear(T_set.inverse() * poseAt(i), truthAt(i, set_at), 0.06, std::to_string(i));
  }

  publisher.publish(poseMessage(Pose::Identity(), 0.0, 0.0, "odom", ros::Time()));  // known exactly
  const auto epoch_set = stateAt(set_at + 5).odom_reset_count;
  int known_at = set_at + 6;
  for (;; ++known_at) {
    ASSERT_LT(known_at, set_at + 16);
    drive(known_at, known_at);
    if (stateAt(known_at).odom_reset_count != epoch_set) break;
  }
  const Matrix6d known = fromMessage(graph_->odometry.at(stampOfSweep(known_at)).pose.covariance);
  EXPECT_GT(symmetricEigenvalues(known)[0], 0.0) << "others invert it";
  EXPECT_LT(std::sqrt(known(0, 0)), 0.005);
}

// ---- extra sources --------------------------------------------------------------------------------------------------

int sourceOf(const messages::FilterState& state, const std::string& name) {
  const auto at = std::find(state.measurement_names.begin(), state.measurement_names.end(), name);
  return at == state.measurement_names.end() ? -1 : static_cast<int>(at - state.measurement_names.begin());
}

TEST_F(Interfaces, AGpsJoinsTheFusionAndCarriesItAlone) {
  ros::Publisher gps = graph_->node().advertise<geometry_msgs::PoseWithCovarianceStamped>("/gps/pose", 10);
  ASSERT_TRUE(waitFor([&] { return gps.getNumSubscribers() == 1; }));
  // its stamps lie 30 ms after the sweeps'; it comes before the sweep does, in odom, without a heading
  const auto fix = [&](int i) {
    const double stamp_s = kSweepPeriod_s * i + 0.03;
    Pose T = Pose::Identity();
    T.translation() = synthetic::Drive().T_odom_base(stamp_s).translation();
    gps.publish(poseMessage(T, 0.3, 0.0, "odom", stampOfSweep(i) + ros::Duration(0.03)));
  };
  drive(0, 3);
  EXPECT_GE(sourceOf(stateAt(3), "gps"), 0);
  EXPECT_FALSE(stateAt(3).deadline_missed) << "nobody waits for it";
  int used = 0;
  for (int i = 4; i < 10; ++i) {
    fix(i);
    drive(i, i);
    const auto at = static_cast<std::size_t>(sourceOf(stateAt(i), "gps"));
    if (stateAt(i).measurement_status[at] != messages::PoseMeasurement::OK) continue;
    ++used;
    EXPECT_GT(stateAt(i).measurement_weights[at], 0.5) << i;
    EXPECT_FALSE(has(reasonsAt(i), Reason::REASON_MEASUREMENTS_DISAGREE)) << i;
  }
  EXPECT_GE(used, 4);
  expectNear(poseAt(9), truthAt(9), 0.06, "with the lidar");
  // the lidar goes blind
  used = 0;
  for (int i = 10; i < 25; ++i) {
    fix(i);
    ASSERT_TRUE(graph_->drive(cloudOf(Sweep(), stampOfSweep(i))));
    EXPECT_TRUE(has(reasonsAt(i), Reason::REASON_SWEEP_EMPTY));
    used += stateAt(i).measurement_applied ? 1 : 0;
  }
  EXPECT_GE(used, 12);
  EXPECT_LT((poseAt(24).translation() - truthAt(24).translation()).head<2>().norm(), 0.6);
  // a frame that nobody knows
  gps.publish(poseMessage(Pose::Identity(), 0.3, 0.0, "utm", stampOfSweep(25)));
  drive(25, 27);
  EXPECT_EQ(stateAt(27).measurement_status[static_cast<std::size_t>(sourceOf(stateAt(27), "gps"))],
            messages::FilterState::NOT_ARRIVED);
  // a pose of another place
  std::string log;
  ros::Subscriber listener = graph_->node().subscribe<rosgraph_msgs::Log>(
      "/rosout", 100, [&](const rosgraph_msgs::LogConstPtr& line) { log += line->msg + '\n'; });
  ASSERT_TRUE(waitFor([&] { return listener.getNumPublishers() > 0; }));
  int at = 28;
  EXPECT_TRUE(waitFor([&] {  // again until the log's link is up: the line comes every 10 s
    Pose elsewhere = synthetic::Drive().T_odom_base(kSweepPeriod_s * at);
    elsewhere.translation().x() += 500.0;
    gps.publish(poseMessage(elsewhere, 0.3, 0.0, "odom", stampOfSweep(at) + ros::Duration(0.03)));
    EXPECT_TRUE(graph_->drive(streetCloud(at)));
    ++at;
    return log.find("the pose of gps is not used: its pose is ") != std::string::npos;
  })) << log;
}

TEST_F(Interfaces, OwnPoseMeasurementIsMatchedByStamp) {
  visual_pose_ = [](const messages::SweepPrediction& prediction) {
    const Pose T_base_cog = synthetic::Lidar().T_base_lidar * fromMessage(prediction.lidar_in_cog)->inverse();
    const double since_start_s = (prediction.header.stamp - stampOfSweep(0)).toSec();
    messages::PoseMeasurement measurement;
    measurement.status = messages::PoseMeasurement::OK;
    measurement.pose = toPoseMessage(synthetic::Drive().T_odom_base(since_start_s) * T_base_cog);
    measurement.covariance = toCovarianceMessage(0.01 * Matrix6d::Identity());
    return measurement;
  };
  drive(0, 4);
  for (int i = 1; i <= 4; ++i) {
    const auto at = static_cast<std::size_t>(sourceOf(stateAt(i), "visual"));
    EXPECT_EQ(stateAt(i).measurement_status[at], messages::PoseMeasurement::OK) << i;
    EXPECT_GT(stateAt(i).measurement_weights[at], 0.5) << i;
    EXPECT_EQ(stateAt(i).deadline_missed, 0) << i;
  }
  expectNear(poseAt(4), truthAt(4), 0.06, "with it");
  // in a frame that it must not have
  visual_pose_ = [](const messages::SweepPrediction&) {
    messages::PoseMeasurement measurement;
    measurement.status = messages::PoseMeasurement::OK;
    measurement.header.frame_id = "map";
    measurement.pose = toPoseMessage(Pose(Eigen::Translation3d(0.0, 0.2, 0.0)));
    measurement.covariance = toCovarianceMessage(1e-6 * Matrix6d::Identity());
    return measurement;
  };
  drive(5, 6);
  for (int i = 5; i <= 6; ++i) {
    const auto at = static_cast<std::size_t>(sourceOf(stateAt(i), "visual"));
    EXPECT_EQ(stateAt(i).measurement_status[at], messages::PoseMeasurement::NO_REFERENCE) << i;
    EXPECT_EQ(stateAt(i).deadline_missed, 0) << "it has answered";
  }
  expectNear(poseAt(6), truthAt(6), 0.06, "without it");
  visual_pose_ = nullptr;
}

// ---- reconfiguration, diagnostics -----------------------------------------------------------------------------------

template <class Value>
const Value* valueOf(const std::vector<Value>& values, const std::string& name) {
  for (const Value& value : values) {
    if (value.name == name) return &value;
  }
  return nullptr;
}

bool reconfigure(const std::string& node, const dynamic_reconfigure::Config& request,
                 dynamic_reconfigure::Config& reply) {
  dynamic_reconfigure::Reconfigure call;
  call.request.config = request;
  if (!ros::service::call("/fail_aware_lidar_odometry/" + node + "/set_parameters", call)) return false;
  reply = call.response.config;
  return true;
}

TEST_F(Interfaces, ReconfigurationRefusesAnInvalidSet) {
  dynamic_reconfigure::Config request, reply;
  ASSERT_TRUE(reconfigure("fusion_ukf", request, reply));
  EXPECT_EQ(valueOf(reply.doubles, "gate_sigma")->value, 2.5) << "the profile's, not the .cfg's nor an earlier run's";
  EXPECT_EQ(valueOf(reply.doubles, "deadline_s")->value, 60.0) << "the launch file's";

  dynamic_reconfigure::BoolParameter off;
  off.name = "use_corner_svd";
  off.value = false;
  request.bools = {off};
  ASSERT_TRUE(reconfigure("fusion_ukf", request, reply));
  drive(0, 2);
  EXPECT_EQ(sourceOf(stateAt(2), "corner_svd"), -1);
  EXPECT_FALSE(has(reasonsAt(2), Reason::REASON_MISSING_CORNERS)) << "not used, not missed";
  request.bools.front().value = true;
  ASSERT_TRUE(reconfigure("fusion_ukf", request, reply));
  drive(3, 3);
  EXPECT_GE(sourceOf(stateAt(3), "corner_svd"), 0);

  request.bools.clear();
  for (const char* name : {"use_icp_point_to_point", "use_icp_point_to_plane"}) {
    off.name = name;
    request.bools.push_back(off);
  }
  ASSERT_TRUE(reconfigure("fusion_ukf", request, reply));
  EXPECT_TRUE(valueOf(reply.bools, "use_icp_point_to_point")->value &&
              valueOf(reply.bools, "use_icp_point_to_plane")->value)
      << "refused";
  drive(4, 4);
  EXPECT_TRUE(stateAt(4).measurement_applied);

  request = dynamic_reconfigure::Config();
  dynamic_reconfigure::DoubleParameter value;
  value.name = "failing_s";
  value.value = 20.0;  // more than degraded_s
  request.doubles = {value};
  ASSERT_TRUE(reconfigure("fail_aware_monitor", request, reply));
  EXPECT_EQ(valueOf(reply.doubles, "failing_s")->value, 1.0);
  value.name = "alert_limit_m";
  value.value = 0.01;
  request.doubles = {value};
  ASSERT_TRUE(reconfigure("fail_aware_monitor", request, reply));
  EXPECT_EQ(valueOf(reply.doubles, "alert_limit_m")->value, 0.01);
  drive(5, 9);
  EXPECT_EQ(graph_->times.at(stampOfSweep(9)).state, Reason::FAILED) << "a centimetre is soon passed";
  EXPECT_TRUE(has(reasonsAt(9), Reason::REASON_COVARIANCE_LIMIT));
  value.value = 0.6;
  request.doubles = {value};
  ASSERT_TRUE(reconfigure("fail_aware_monitor", request, reply));

  request = dynamic_reconfigure::Config();
  dynamic_reconfigure::IntParameter seeds;
  seeds.name = "seeds";
  seeds.value = 1;
  request.ints = {seeds};
  ASSERT_TRUE(reconfigure("icp_point_to_point", request, reply));
  EXPECT_EQ(valueOf(reply.ints, "seeds")->value, 1);
  drive(10, 11);
  EXPECT_TRUE(stateAt(11).measurement_applied);
  request.ints.front().value = 8;
  ASSERT_TRUE(reconfigure("icp_point_to_point", request, reply));
}

TEST_F(Interfaces, EveryNodeletTellsItsHealth) {
  std::map<std::string, std::set<std::string>> keys;
  ros::Subscriber listener = graph_->node().subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 50, [&](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
        for (const auto& status : array->status) {
          for (const auto& name : NodeletManager::types()) {
            if (status.name.find(name.first) == std::string::npos) continue;
            for (const auto& value : status.values) keys[name.first].insert(value.key);
          }
        }
      });
  drive(0, 3);
  EXPECT_TRUE(waitFor([&] { return keys.size() == NodeletManager::types().size(); }));
  for (const char* name :
       {"sweep_correction", "icp_point_to_point", "icp_point_to_plane", "corner_svd", "fusion_ukf"}) {
    EXPECT_TRUE(keys[name].count("rate (Hz)")) << name;
    EXPECT_TRUE(keys[name].count("sweeps")) << name;
  }
  EXPECT_TRUE(keys["fusion_ukf"].count("dropped: overload"));
  EXPECT_TRUE(keys["fusion_ukf"].count("icp_point_to_plane: last"));
  EXPECT_TRUE(keys["fusion_ukf"].count("gps: answers"));
  EXPECT_TRUE(keys["fail_aware_monitor"].count("silence (s)"));
}

}  // namespace
}  // namespace fail_aware::interfaces_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "interfaces_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
