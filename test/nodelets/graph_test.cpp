// The six nodelets over a made-up drive: one filter state, odometry and time to failure for every cloud, and the same
// poses as offline, with the lidar mounted askew on a vehicle whose base_link is elsewhere. Run in one manager
// (graph.test) and as six processes (standalone.test). Waits for messages, not for seconds.
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>

#include <vector>

#include "../support/graph_driver.hpp"
#include "bridge/parameter_server.hpp"
#include "core/geometry/decompositions.hpp"
#include "core/odometry_pipeline.hpp"
#include "core/types/corrected_sweep.hpp"
#include "fail_aware_lidar_odometry/bridge/point_cloud_conversion.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware::graph_test {
namespace {

constexpr int kSweeps = 12;

synthetic::Lidar askewLidar() {
  synthetic::Lidar lidar;
  lidar.T_base_lidar = poseFromVector((Vector6d() << 1.1, 0.2, 1.6, 0.01, 0.02, 0.3).finished());
  return lidar;
}

std::vector<Sweep> driveSweeps() {
  const synthetic::Street street;
  const synthetic::Drive drive;
  std::vector<Sweep> sweeps;
  for (int i = 0; i < kSweeps; ++i) {
    sweeps.push_back(street.scan([&](double t) { return drive.T_street_base(t); }, kSweepPeriod_s * i,
                                 static_cast<std::uint32_t>(i), askewLidar()));
  }
  return sweeps;
}

/// The position's variance grows with the distance. The heading's may shrink a little: a registration that is better
/// than the one before takes back more of its error in the map.
void expectGrownCovariance(const nav_msgs::Odometry& now, const nav_msgs::Odometry& before) {
  const Matrix6d C = fromMessage(now.pose.covariance), C_before = fromMessage(before.pose.covariance);
  EXPECT_LT((C - C.transpose()).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_GT(C(5, 5), 0.9 * C_before(5, 5));
  EXPECT_GT(C.diagonal().head(3).sum(), C_before.diagonal().head(3).sum());
}

void expectPositiveDefinite(const nav_msgs::Odometry& message) {
  for (const CovarianceMessage& covariance : {message.pose.covariance, message.twist.covariance}) {
    const Matrix6d C = fromMessage(covariance);
    ASSERT_TRUE(C.allFinite());
    EXPECT_GT(symmetricEigenvalues(C)[0], 0.0);
  }
}

TEST(Graph, EveryCloudHasItsEstimateAndItIsOfflines) {
  GraphDriver graph;
  Recorder<messages::PoseMeasurement> point(graph.node(), "measurement/icp_point_to_point");
  Recorder<messages::PoseMeasurement> plane(graph.node(), "measurement/icp_point_to_plane");
  Recorder<messages::PoseMeasurement> corners(graph.node(), "measurement/corner_svd");
  Recorder<sensor_msgs::PointCloud2> corrected(graph.node(), "sweep/points");
  Recorder<messages::SweepCheck> checks(graph.node(), "sweep/check");
  ASSERT_TRUE(graph.waitUntilLinked()) << "a nodelet did not come up";

  PipelineParameters params = readPipelineParameters(graph.node());
  const Pose T_base_lidar = askewLidar().T_base_lidar;
  const Vector6d lidar_in_base = vectorFromPose(T_base_lidar);
  params.sensor.lidar_in_base.assign(lidar_in_base.data(), lidar_in_base.data() + 6);
  OdometryPipeline offline(params, 1);
  offline.startRedundant();

  std::vector<sensor_msgs::PointCloud2Ptr> clouds;
  for (const Sweep& sweep : driveSweeps()) {
    clouds.push_back(cloudOf(sweep, stampOfSweep(static_cast<int>(clouds.size()))));
  }
  graph.publish(clouds[0]);
  EXPECT_FALSE(waitFor([&] { return graph.answered(clouds[0]->header.stamp); }, 0.5)) << "without a transform";
  graph.sendTransform(T_base_lidar);
  ASSERT_TRUE(waitFor([&] { return graph.answered(clouds[0]->header.stamp); })) << "the cloud has waited for it";

  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const ros::Time stamp = clouds[i]->header.stamp;
    if (i > 0) {
      ASSERT_TRUE(graph.drive(clouds[i])) << "sweep " << i;
    }
    ASSERT_TRUE(waitFor([&] {
      return point.count(stamp) > 0 && plane.count(stamp) > 0 && corners.count(stamp) > 0 &&
             corrected.count(stamp) > 0 && checks.count(stamp) > 0;
    })) << "sweep "
        << i;
    Sweep sweep;
    ASSERT_TRUE(readCloud(*clouds[i], sweep).ok());
    const SweepResult expected = offline.step(sweep);
    const messages::FilterState& state = graph.states.at(stamp);
    EXPECT_FALSE(state.deadline_missed);
    EXPECT_EQ(state.measurement_applied != 0, expected.state.measurement_applied) << "sweep " << i;
    const Vector6d error = logSe3(expected.T_odom_base.inverse() * graph.T_odom_base(stamp));
    EXPECT_LT(error.head<3>().norm(), 1e-4) << "sweep " << i;
    EXPECT_LT(error.tail<3>().norm(), 1e-5) << "sweep " << i;
    const messages::TimeToFailure& time = graph.times.at(stamp);
    EXPECT_EQ(time.state, static_cast<int>(expected.monitor.state)) << "sweep " << i;
    EXPECT_EQ(time.reasons, expected.monitor.reasons) << "sweep " << i << ": " << time.reasons_text;
    EXPECT_NEAR(time.time_to_failure, expected.monitor.time_to_failure.seconds, 1e-2) << "sweep " << i;
    expectPositiveDefinite(graph.odometry.at(stamp));
    if (i == 0) {
      EXPECT_GT(graph.odometry.at(stamp).twist.covariance[0], 1e5) << "a speed that is not known yet";
    }
    // the third sweep's registration ends what the first motion's search left open
    if (i > 2) expectGrownCovariance(graph.odometry.at(stamp), graph.odometry.at(clouds[i - 1]->header.stamp));
  }
  for (const auto& cloud : clouds) {
    EXPECT_EQ(graph.states.count(cloud->header.stamp), 1u);
    EXPECT_EQ(graph.odometry.count(cloud->header.stamp), 1u);
  }
  const nav_msgs::Odometry& last = graph.odometry.at(clouds.back()->header.stamp);
  EXPECT_EQ(last.header.frame_id, "odom");
  EXPECT_EQ(last.child_frame_id, "base_link");
  EXPECT_NEAR(last.twist.twist.linear.x, synthetic::Drive().speed_mps, 0.5);
  EXPECT_NEAR(last.twist.twist.linear.y, 0.0, 0.2) << "in base_link, not in the lidar's axes";
  EXPECT_NEAR(last.twist.twist.angular.z, synthetic::Drive().yaw_rate_rps, 0.05);
  const Pose truth = synthetic::Drive().T_odom_base(kSweepPeriod_s * (kSweeps - 1));
  EXPECT_LT((graph.T_odom_base(clouds.back()->header.stamp).translation() - truth.translation()).norm(), 0.1);

  // silence is a failure
  bool stale = false;
  ros::Subscriber listener = graph.node().subscribe<messages::TimeToFailure>(
      "time_to_failure", 10, [&](const messages::TimeToFailureConstPtr& message) {
        stale = message->state == messages::TimeToFailure::FAILED &&
                (message->reasons & messages::TimeToFailure::REASON_STALE) != 0 && message->time_to_failure == 0.0;
      });
  EXPECT_TRUE(waitFor([&] { return stale; }));
}

}  // namespace
}  // namespace fail_aware::graph_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "graph_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
