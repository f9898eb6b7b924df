#include "evaluation/noise_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/degree.hpp"
#include "core/io/input_error.hpp"

namespace fail_aware::noise_calibration_test {
namespace {

TEST(NoiseCalibration, FindsTheIncrementsNoiseThatWasPutIn) {
  PoseFilter::Params truth;
  truth.increment_scale = 4.0;
  truth.increment_floor_m = 0.004;
  truth.increment_per_metre_m = 0.006;
  truth.increment_floor_deg = 0.02;
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  std::vector<IncrementSample> samples;
  for (int i = 0; i < 1500; ++i) {
    IncrementSample sample;
    sample.distance_m = 2.0 * (i % 5) / 4.0;
    const double level = i % 3 == 0 ? 4.0 : 0.1;  // so that scale and floors can be told apart
    sample.modelled.diagonal() << 1e-5, 2e-5, 1e-5, 1e-7, 1e-7, 2e-7;
    sample.modelled *= level;
    const double floor_m = truth.increment_floor_m + truth.increment_per_metre_m * sample.distance_m;
    const double floor_rad = truth.increment_floor_deg * kDegree;
    for (int k = 0; k < 6; ++k) {
      const double floor = k < 3 ? floor_m : floor_rad;
      sample.error[k] = normal(random) * std::sqrt(truth.increment_scale * sample.modelled(k, k) + floor * floor);
    }
    samples.push_back(sample);
  }
  const PoseFilter::Params fitted = fitIncrementNoise(samples, PoseFilter::Params());
  EXPECT_NEAR(fitted.increment_scale / truth.increment_scale, 1.0, 0.1);
  EXPECT_NEAR(fitted.increment_floor_m / truth.increment_floor_m, 1.0, 0.1);
  EXPECT_NEAR(fitted.increment_per_metre_m / truth.increment_per_metre_m, 1.0, 0.1);
  EXPECT_NEAR(fitted.increment_floor_deg / truth.increment_floor_deg, 1.0, 0.1);
  EXPECT_THROW(fitIncrementNoise({}, PoseFilter::Params()), InputError);
}

TEST(NoiseCalibration, TakesScaleAndFloorsOutOfWhatWasLogged) {
  PoseFilter::Params params;
  params.increment_scale = 2.0;
  params.increment_floor_m = 0.01;
  params.increment_per_metre_m = 0.005;
  params.increment_floor_deg = 0.1;
  MonitorInput first, second;
  second.state.dt_s = 0.1;
  second.state.T_previous_now.translation().x() = 2.0;
  second.state.T_odom_cog = second.state.T_previous_now;
  const Matrix6d modelled = 1e-4 * Matrix6d::Identity();
  second.state.increment_covariance = 2.0 * modelled;
  second.state.increment_covariance.diagonal().head<3>().array() += 0.02 * 0.02;
  second.state.increment_covariance.diagonal().tail<3>().array() += std::pow(0.1 * kDegree, 2);
  Pose T_true = Pose::Identity();
  T_true.translation().x() = 2.05;
  const std::vector<IncrementSample> samples = incrementSamples({Pose::Identity(), T_true}, {first, second}, params);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_NEAR(samples[0].error[0], 0.05, 1e-12);
  EXPECT_TRUE(samples[0].modelled.isApprox(modelled, 1e-9));
  EXPECT_NEAR(samples[0].distance_m, 2.0, 1e-12);
}

/// The doubt in a sweep is no part of what increment_scale scales.
TEST(NoiseCalibration, TheDoubtOfASweepIsNotScaled) {
  PoseFilter::Params params;
  params.increment_scale = 2.0;
  params.increment_floor_m = params.increment_per_metre_m = params.increment_floor_deg = 1e-9;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  std::vector<Pose> truth(1, Pose::Identity());
  std::vector<MonitorInput> log(1);
  for (int i = 0; i < 1000; ++i) {
    MonitorInput input;
    FilterState& s = input.state;
    s.dt_s = 0.1;
    if (i % 2 == 0) {
      s.doubt.sigma_m = 0.5;
      s.doubt.sigma_yaw_rad = 0.05;
    }
    s.increment_covariance = 2.0 * 1e-4 * Matrix6d::Identity() + covarianceOf(s.doubt);
    Vector6d error;
    for (int k = 0; k < 6; ++k) error[k] = normal(random) * std::sqrt(4e-4 + covarianceOf(s.doubt)(k, k));
    truth.push_back(truth.back() * poseFromVector(error));
    log.push_back(input);
  }
  const std::vector<IncrementSample> samples = incrementSamples(truth, log, params);
  ASSERT_EQ(samples.size(), 1000u);
  EXPECT_TRUE(samples.front().modelled.isApprox(1e-4 * Matrix6d::Identity(), 1e-6));
  const PoseFilter::Params fitted = fitIncrementNoise(samples, PoseFilter::Params());
  const double floor_m = fitted.increment_floor_m;
  EXPECT_NEAR(fitted.increment_scale * 1e-4 + floor_m * floor_m, 4e-4, 4e-5);
}

/// Straight drives whose odometry drifts as the model says.
std::vector<DriftRun> driftingRuns(const DriftModel& drift, int runs) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<DriftRun> all;
  for (int r = 0; r < runs; ++r) {
    const double heading_bias = drift.heading_bias_deg_per_m * kDegree * normal(random);
    const double scale = drift.scale_bias * normal(random);
    DriftRun run;
    Pose T_true = Pose::Identity(), T = Pose::Identity();
    for (int i = 0; i < 150; ++i) {
      MonitorInput input;
      FilterState& s = input.state;
      s.stamp_s = 0.4 * i;
      if (i > 0) {
        const double step_m = 8.0, dt_s = 0.4, root = std::sqrt(step_m);
        Vector6d step = Vector6d::Zero();
        step[0] = step_m;
        Vector6d error = Vector6d::Zero();
        error[0] = scale * step_m + drift.position_per_root_metre_m * root * normal(random);
        error[1] = drift.position_per_root_metre_m * root * normal(random);
        error[5] = heading_bias * step_m + drift.heading_per_root_metre_deg * kDegree * root * normal(random);
        s.dt_s = dt_s;
        s.T_previous_now = poseFromVector(step + error);
        T_true = T_true * poseFromVector(step);
        T = T * s.T_previous_now;
      }
      s.T_odom_cog = T;
      run.truth.push_back(T_true);
      run.log.push_back(input);
    }
    all.push_back(run);
  }
  return all;
}

TEST(NoiseCalibration, FindsTheDriftThatWasPutIn) {
  DriftModel truth;
  truth.position_per_root_metre_m = 0.02;
  truth.heading_per_root_metre_deg = 0.01;
  truth.heading_bias_deg_per_m = 0.003;
  truth.scale_bias = 0.004;
  DriftFitOptions options;
  options.episode_every_s = 15.0;
  options.every_s = 3.0;
  const DriftModel fitted = fitDrift(driftingRuns(truth, 60), DriftModel(), options);
  EXPECT_NEAR(fitted.position_per_root_metre_m / truth.position_per_root_metre_m, 1.0, 0.2);
  EXPECT_NEAR(fitted.heading_per_root_metre_deg / truth.heading_per_root_metre_deg, 1.0, 0.3);
  EXPECT_NEAR(fitted.heading_bias_deg_per_m / truth.heading_bias_deg_per_m, 1.0, 0.3);
  EXPECT_NEAR(fitted.scale_bias / truth.scale_bias, 1.0, 0.3);
}

TEST(NoiseCalibration, WithoutABiasItFindsNone) {
  DriftModel truth;
  truth.position_per_root_metre_m = 0.02;
  truth.heading_per_root_metre_deg = 0.01;
  truth.heading_bias_deg_per_m = 0.0;
  truth.scale_bias = 0.0;
  DriftFitOptions options;
  options.episode_every_s = 15.0;
  options.every_s = 3.0;
  const DriftModel fitted = fitDrift(driftingRuns(truth, 20), DriftModel(), options);
  // 0.01 deg per root metre make 0.0005 deg/m over 400 m
  EXPECT_LT(fitted.heading_bias_deg_per_m, 3e-4);
  EXPECT_LT(fitted.scale_bias, 8e-4);
  EXPECT_THROW(fitDrift({}, DriftModel()), InputError);
}

}  // namespace
}  // namespace fail_aware::noise_calibration_test
