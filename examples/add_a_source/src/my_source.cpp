// A source of poses: one answer to each sweep. This one only repeats the prediction, with a covariance so large that it
// hardly counts; put your own measurement in its place.
#include "fail_aware_lidar_odometry/PoseMeasurement.h"
#include "fail_aware_lidar_odometry/SweepPrediction.h"
#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.hpp>
#include <ros/ros.h>

namespace add_a_source {

class MySource : public nodelet::Nodelet {
  void onInit() override {
    publisher_ = getNodeHandle().advertise<fail_aware_lidar_odometry::PoseMeasurement>("measurement/my_source", 10);
    subscriber_ = getNodeHandle().subscribe("sweep/prediction", 10, &MySource::onPrediction, this);
  }

  void onPrediction(const fail_aware_lidar_odometry::SweepPredictionConstPtr& prediction) {
    const fail_aware_lidar_odometry::PoseMeasurementPtr measurement(new fail_aware_lidar_odometry::PoseMeasurement);
    measurement->header = prediction->header;  // the sweep's stamp, exactly; the odometry frame
    measurement->source = "my_source";
    measurement->sweep_points = -1;  // not known
    if (prediction->dt <= 0.0) {     // the first sweep of a drive: whoever keeps a reference starts anew
      measurement->status = fail_aware_lidar_odometry::PoseMeasurement::NO_REFERENCE;
    } else {
      measurement->status = fail_aware_lidar_odometry::PoseMeasurement::OK;
      measurement->pose = prediction->pose;                                // of the centre of gravity in odom
      for (int i = 0; i < 3; ++i) measurement->covariance[7 * i] = 100.0;  // m^2
      for (int i = 3; i < 6; ++i) measurement->covariance[7 * i] = 1.0;    // rad^2
    }
    publisher_.publish(measurement);  // do not change it afterwards
  }

  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
};

}  // namespace add_a_source

PLUGINLIB_EXPORT_CLASS(add_a_source::MySource, nodelet::Nodelet)
