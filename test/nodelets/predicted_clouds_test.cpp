#include "../../src/nodelets/predicted_clouds.hpp"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <string>

namespace fail_aware::predicted_clouds_test {
namespace {

PredictedClouds::Cloud cloudAt(std::uint32_t second, const std::string& frame = "velodyne") {
  const auto message = boost::make_shared<sensor_msgs::PointCloud2>();
  message->header.stamp = ros::Time(second, 0);
  message->header.frame_id = frame;
  return message;
}

PredictedClouds::Prediction predictionAt(std::uint32_t second, const std::string& lidar_frame = "velodyne") {
  const auto message = boost::make_shared<::fail_aware_lidar_odometry::SweepPrediction>();
  message->header.stamp = ros::Time(second, 0);
  message->lidar_frame = lidar_frame;
  return message;
}

TEST(PredictedClouds, ThePairIsThereWithTheSecondMessage) {
  PredictedClouds clouds;
  EXPECT_FALSE(clouds.add(cloudAt(1)));
  EXPECT_EQ(clouds.add(predictionAt(1))->cloud->header.stamp, ros::Time(1, 0));
  EXPECT_FALSE(clouds.add(predictionAt(2)));
  EXPECT_EQ(clouds.add(cloudAt(2))->prediction->header.stamp, ros::Time(2, 0));
  EXPECT_FALSE(clouds.add(cloudAt(2))) << "once";
}

TEST(PredictedClouds, CloudsWithoutAPredictionAreCounted) {
  PredictedClouds clouds;
  clouds.add(cloudAt(1));
  clouds.add(cloudAt(2));
  clouds.add(cloudAt(3));
  EXPECT_EQ(clouds.unmatched(), 0u) << "their predictions may come";
  EXPECT_TRUE(clouds.add(predictionAt(3)));
  EXPECT_EQ(clouds.unmatched(), 2u);
}

TEST(PredictedClouds, ACloudOfAnotherFrameIsNotTheSweeps) {
  PredictedClouds clouds;
  clouds.add(cloudAt(1, "velodyne"));
  clouds.add(cloudAt(1, "radar"));
  EXPECT_EQ(clouds.add(predictionAt(1))->cloud->header.frame_id, "velodyne");
  clouds.add(cloudAt(2, "radar"));
  EXPECT_FALSE(clouds.add(predictionAt(2)));
  clouds.add(cloudAt(3, "radar"));
  EXPECT_TRUE(clouds.add(predictionAt(3, ""))) << "any frame";
}

}  // namespace
}  // namespace fail_aware::predicted_clouds_test
