// Runs the built calibrators on made-up runs; CALIBRATE_NOISE, CALIBRATE_FAIL_AWARE, CALIBRATE_AZIMUTH and
// CALIBRATE_ELEVATION are their paths (compile definitions).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/geometry/degree.hpp"
#include "core/parameters/validate.hpp"
#include "made_up_runs_test.hpp"

namespace fail_aware::calibrate_test {
namespace {

namespace fs = std::filesystem;

class Calibrate : public MadeUpRunsTest {
 protected:
  /// The shipped profile with what the last run printed.
  ProfileParameters fittedProfile() const {
    ProfileParameters fitted;
    std::ofstream(folder_ / "fitted.yaml") << result_.out;
    loadYaml((folder_ / "fitted.yaml").string(), fitted, MissingKeys::kKeep);
    return fitted;
  }
};

TEST_F(Calibrate, NoiseFindsThatTheFilterSaidTwiceTheTruth) {
  MadeUpRun made_up;
  made_up.sweeps = 600;
  made_up.sigma_m = made_up.sigma_up_m = 0.02;
  made_up.sigma_yaw_rad = made_up.sigma_tilt_rad = 1e-3;
  made_up.said_sigma_m = 0.04;
  made_up.said_sigma_yaw_rad = 2e-3;
  PipelineParameters params;
  params.profile.filter.increment_scale = 1.0;
  params.profile.filter.increment_floor_m = 1e-6;
  params.profile.filter.increment_per_metre_m = 1e-6;
  params.profile.filter.increment_floor_deg = 1e-6;
  made_up.write(folder_ / "run", params);
  const fs::path yaml = folder_ / "noise.yaml";
  run(CALIBRATE_NOISE, options("run") + " --output '" + yaml.string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(result_.err.find("per_root_metre_m left"), std::string::npos) << result_.err;
  EXPECT_EQ(result_.err.find("per_root_metre_deg left"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("filter.increment_scale: 1 -> 0.2"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("evaluate_fail_aware --parameters " + yaml.string()), std::string::npos) << result_.err;
  EXPECT_EQ(result_.out, contentOf(yaml));
  ProfileParameters fitted;
  loadYaml(yaml.string(), fitted, MissingKeys::kKeep);
  const PoseFilter::Params& filter = fitted.filter;
  const double floor_m = filter.increment_floor_m + filter.increment_per_metre_m;
  const double floor_rad = filter.increment_floor_deg * kDegree;
  EXPECT_NEAR(std::sqrt(filter.increment_scale * 0.04 * 0.04 + floor_m * floor_m), 0.02, 1e-3);
  EXPECT_NEAR(std::sqrt(filter.increment_scale * 4e-6 + floor_rad * floor_rad), 1e-3, 5e-5);
  EXPECT_NE(result_.out.find("heading_per_root_metre_deg"), std::string::npos);
  EXPECT_EQ(result_.out.find("threshold"), std::string::npos) << "only what was fitted";
}

TEST_F(Calibrate, DriftThatTheRunsDoNotShowStaysAsItIs) {
  MadeUpRun exact;
  exact.sweeps = 600;
  PipelineParameters params;
  params.profile.monitor.drift.scale_bias = 0.0123;
  exact.write(folder_ / "exact", params);
  run(CALIBRATE_NOISE, options("exact"));
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  for (const char* key : {"scale_bias", "heading_per_root_metre_deg"}) {
    EXPECT_NE(result_.err.find("monitor.drift." + std::string(key) + " left as it is"), std::string::npos) << key;
  }
  const ProfileParameters fitted = fittedProfile();
  EXPECT_EQ(fitted.monitor.drift.scale_bias, 0.0123);
  EXPECT_EQ(fitted.monitor.drift.heading_per_root_metre_deg, params.profile.monitor.drift.heading_per_root_metre_deg);
}

TEST_F(Calibrate, NoiseDoesNotDependOnParametersOfTheReplay) {
  MadeUpRun noisy;
  noisy.sigma_m = 0.02;
  noisy.sigma_yaw_rad = 4e-4;
  noisy.write(folder_ / "noisy");
  run(CALIBRATE_NOISE, options("noisy"));
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const PoseFilter::Params fitted = fittedProfile().filter;
  run(CALIBRATE_NOISE, options("noisy") + " --set filter.increment_scale=3.0 --set filter.increment_floor_m=0.004");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NEAR(fittedProfile().filter.increment_scale, fitted.increment_scale, 0.02 * fitted.increment_scale);
  EXPECT_NEAR(fittedProfile().filter.increment_floor_m, fitted.increment_floor_m,
              0.02 * fitted.increment_floor_m + 1e-6);
}

TEST_F(Calibrate, NoiseRefusesTheTruthOfAnotherDrive) {
  MadeUpRun slow, fast;
  fast.speed_mps = 28.0;
  slow.write(folder_ / "slow");
  fast.write(folder_ / "fast");
  run(CALIBRATE_NOISE, " --run '" + (folder_ / "slow").string() + "' --ground-truth '" +
                           (folder_ / "fast" / "poses.txt").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("slow: half of its motions differ"), std::string::npos) << result_.err;
}

TEST_F(Calibrate, EtaStaysQuietInStartsThatDoNotFail) {
  MadeUpRun good, failing;
  failing.sweeps = 120;
  failing.drift_m = 0.02;
  PipelineParameters article;
  article.profile.monitor.indicator.average_s = article.profile.monitor.indicator.reference_speed_mps = 0.0;
  good.write(folder_ / "good", article);
  failing.write(folder_ / "failing", article);
  run(CALIBRATE_FAIL_AWARE, options("good") + options("failing") + " --eta-passed-by 0");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const ProfileParameters fitted = fittedProfile();
  // sigma alternates by 1e-6 rad: 2e-6 a sweep from the third on, over the 400 sweeps of the first episode
  EXPECT_NEAR(fitted.monitor.indicator.threshold, 2e-6 * 398, 1e-9);
  EXPECT_NE(result_.err.find("monitor.indicator.threshold: 0.001 -> 0.000796"), std::string::npos) << result_.err;
  run(CALIBRATE_FAIL_AWARE, options("good") + " --eta-passed-by 0");
  EXPECT_NE(result_.err.find("threshold left as it is: no start fails"), std::string::npos) << result_.err;
}

/// Predictions that are far too early even at the smallest confidence, and an alarm that is up all the time.
TEST_F(Calibrate, TheAlarmConfidenceIsNeverAboveTheConfidence) {
  MadeUpRun failing, sound;
  failing.sweeps = 600;  // ten starts that fail and more
  sound.sweeps = 200;
  failing.drift_m = 0.02;
  PipelineParameters timid;
  timid.profile.monitor.predictor.horizon_s = timid.profile.monitor.indicator.horizon_s = 12.0;  // quicker
  timid.profile.monitor.thresholds.degraded_s = 9.0;
  timid.profile.monitor.drift.position_per_root_metre_m = 0.5;
  failing.write(folder_ / "failing", timid);
  sound.write(folder_ / "sound", timid);
  run(CALIBRATE_FAIL_AWARE, options("failing") + options("sound") + " --alarm 0");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("alarm_confidence lowered to the confidence"), std::string::npos) << result_.err;
  const ProfileParameters fitted = fittedProfile();
  EXPECT_EQ(fitted.monitor.predictor.confidence, 0.5);
  EXPECT_EQ(fitted.monitor.predictor.alarm_confidence, 0.5);
  EXPECT_NO_THROW(validate(fitted.monitor));
}

/// A smaller alarm confidence makes times longer: fitted before it, the confidence alone lets too many be late.
TEST_F(Calibrate, TheConfidenceIsJudgedWithTheAlarmConfidenceThatIsWritten) {
  MadeUpRun failing, sound;
  failing.sweeps = 190;
  failing.drift_m = 0.01;
  sound.sweeps = 200;
  PipelineParameters timid;
  timid.profile.monitor.predictor.horizon_s = timid.profile.monitor.indicator.horizon_s = 12.0;  // quicker
  timid.profile.monitor.thresholds.degraded_s = 9.0;
  timid.profile.monitor.drift.position_per_root_metre_m = 0.05;
  failing.write(folder_ / "failing", timid);
  timid.profile.monitor.drift.position_per_root_metre_m = 0.036;
  sound.write(folder_ / "sound", timid);
  const fs::path yaml = folder_ / "alarm.yaml";
  run(CALIBRATE_FAIL_AWARE, options("failing") + options("sound") +
                                " --episode-every 3 --alarm 0.1 --late 0.2 --output '" + yaml.string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("monitor.predictor.confidence fitted again, with the new alarm_confidence"),
            std::string::npos)
      << result_.err;
  const CovariancePredictor::Params fitted = fittedProfile().monitor.predictor;
  EXPECT_LT(fitted.alarm_confidence, 0.6);
  EXPECT_GT(fitted.confidence, 0.85) << "0.65 before it is fitted again";
  run(EVALUATE_FAIL_AWARE, options("failing") + " --episode-every 3 --resamples 1 --parameters '" + yaml.string() +
                               "' --output '" + (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const Json report = Json::parse(contentOf(folder_ / "result" / "fail_aware.json"));
  EXPECT_LE(report["failing"]["times"]["covariance"]["late_ratio_of_failing"].get<double>(), 0.2);
}

TEST_F(Calibrate, WithoutAFailureNothingIsSaidOfTheConfidence) {
  MadeUpRun good;
  good.sweeps = 120;
  good.write(folder_ / "good");
  run(CALIBRATE_FAIL_AWARE, options("good"));
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("monitor.predictor.confidence left as it is: no start fails: give runs that do"),
            std::string::npos);
  const ProfileParameters fitted = fittedProfile();
  EXPECT_EQ(fitted.monitor.predictor.confidence, CovariancePredictor::Params().confidence);
  EXPECT_LE(fitted.monitor.predictor.alarm_confidence, fitted.monitor.predictor.confidence);
}

TEST_F(Calibrate, FewFailuresDoNotLowerTheConfidence) {
  MadeUpRun failing;
  failing.sweeps = 120;
  failing.drift_m = 0.02;
  failing.write(folder_ / "failing");
  run(CALIBRATE_FAIL_AWARE, options("failing"));
  EXPECT_NE(result_.err.find("monitor.predictor.confidence left as it is: 2 starts fail; --late 0.1 needs 10"),
            std::string::npos)
      << result_.err;
}

TEST_F(Calibrate, GuaranteeSaysHowManyRunsItNeeds) {
  MadeUpRun failing;
  failing.sweeps = 120;
  failing.drift_m = 0.02;
  failing.write(folder_ / "failing");
  run(CALIBRATE_FAIL_AWARE, options("failing") + " --guarantee --late 0.25");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("the guarantee needs 3 runs that fail in each state"), std::string::npos) << result_.err;
  EXPECT_EQ(result_.out.find("  confidence"), std::string::npos) << result_.out;
  run(CALIBRATE_FAIL_AWARE, options("failing") + " --guarantee --late 1");  // always kept
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(fittedProfile().monitor.predictor.confidence, 0.5);
  run(CALIBRATE_FAIL_AWARE, options("failing") + " --guarantee --late 0");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("--late 0"), std::string::npos) << result_.err;
}

TEST_F(Calibrate, UnusableInputIsRefusedInOneLine) {
  for (const std::string tool : {CALIBRATE_NOISE, CALIBRATE_FAIL_AWARE}) {
    run(tool, "--run a --ground-truth b");
    EXPECT_EQ(result_.exit_code, 2) << tool;
    EXPECT_NE(result_.err.find("a: no such folder"), std::string::npos) << result_.err;
    EXPECT_EQ(result_.out, "");
    run(tool, "");
    EXPECT_EQ(result_.exit_code, 2) << tool;
    run(tool, "--help");
    EXPECT_EQ(result_.exit_code, 0) << tool;
    EXPECT_NE(result_.out.find("--ground-truth"), std::string::npos);
  }
  MadeUpRun tiny;
  tiny.sweeps = 5;
  tiny.write(folder_ / "tiny");
  run(CALIBRATE_NOISE, options("tiny"));
  EXPECT_EQ(result_.exit_code, 2);
  expectOneErrorLine(result_, "calibrate_noise", "too few sweeps to calibrate with: 4, at least 10 are needed");
  tiny.sweeps = 120;
  tiny.write(folder_ / "short");
  run(CALIBRATE_NOISE, options("short"));
  EXPECT_EQ(result_.exit_code, 2);
  expectOneErrorLine(
      result_, "calibrate_noise",
      "the runs are too short to calibrate the drift: 3 errors (5 s and more after starts 5 s apart), at "
      "least 10 are needed: give a run of 25 s");
  run(CALIBRATE_NOISE, options("tiny") + " --set monitor.predictor.confidence=0.9");
  EXPECT_EQ(result_.exit_code, 2);
  expectOneErrorLine(result_, "calibrate_noise",
                     "--set monitor.predictor.confidence=0.9: only keys of monitor.drift. and filter.increment_ have");
  run(CALIBRATE_FAIL_AWARE, options("tiny") + " --late 2");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("--late"), std::string::npos) << result_.err;
}

/// A run in which the vehicle travels 0.25 deg to the left of the lidar's x axis, made with points turned by
/// `angle_deg` already.
void writeSkewedRun(const fs::path& run, double angle_deg, int sweeps = 200,
                    const std::vector<double>& lidar_in_base = SensorParameters().lidar_in_base) {
  fs::create_directories(run);
  PipelineParameters params;
  params.sensor.azimuth.angle_deg = angle_deg;
  params.sensor.lidar_in_base = lidar_in_base;
  saveYaml((run / "parameters.yaml").string(), params);
  std::vector<Pose> poses(static_cast<std::size_t>(sweeps), Pose::Identity());
  for (int i = 0; i < sweeps; ++i) {
    poses[static_cast<std::size_t>(i)].translation() << i, i * std::tan(0.25 * kDegree), 0.0;
  }
  writeKittiTrajectory((run / "trajectory_kitti.txt").string(), poses);
  Json summary;
  sealRun(run, {"parameters.yaml", "trajectory_kitti.txt"}, "r0123456789abcdef", summary);
}

TEST_F(Calibrate, AzimuthIsWhatTheRunsHadLessWhatIsLeft) {
  writeSkewedRun(folder_ / "a", -0.1);
  writeSkewedRun(folder_ / "b", -0.1);
  const std::string runs = " --run '" + (folder_ / "a").string() + "' --run '" + (folder_ / "b").string() + "'";
  const fs::path yaml = folder_ / "azimuth.yaml";
  run(CALIBRATE_AZIMUTH, runs + " --output '" + yaml.string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.err.find("398 motions, 398 m"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("+0.250 deg off base_link's x axis (positive: to the left, seen from above)"),
            std::string::npos)
      << result_.err;
  EXPECT_EQ(result_.out, contentOf(yaml));
  PipelineParameters params;
  loadYaml(yaml.string(), params, MissingKeys::kKeep);
  EXPECT_NEAR(params.sensor.azimuth.angle_deg, -0.35, 1e-9);

  run(CALIBRATE_AZIMUTH, " --trajectory '" + (folder_ / "a" / "trajectory_kitti.txt").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_NE(result_.out.find("angle_deg: -0.25"), std::string::npos) << result_.out;
}

TEST_F(Calibrate, AzimuthIsSoughtFromWhereTheLidarIsMounted) {
  struct Mount {
    double roll_rad, yaw_rad, angle_deg;
  };
  for (const Mount& mount : {Mount{0.0, 0.2 * kDegree, -0.45}, {M_PI, 0.2 * kDegree, -0.05}}) {
    writeSkewedRun(folder_ / "mounted", 0.0, 200, {1.0, 0.0, 1.7, mount.roll_rad, 0.0, mount.yaw_rad});
    run(CALIBRATE_AZIMUTH, " --run '" + (folder_ / "mounted").string() + "'");
    ASSERT_EQ(result_.exit_code, 0) << result_.err;
    PipelineParameters params;
    std::ofstream(folder_ / "found.yaml") << result_.out;
    loadYaml((folder_ / "found.yaml").string(), params, MissingKeys::kKeep);
    EXPECT_NEAR(params.sensor.azimuth.angle_deg, mount.angle_deg, 2e-3) << mount.roll_rad;
  }
  writeSkewedRun(folder_ / "mounted", 0.0, 200, {1.0, 0.0, 1.7, 0.0, 0.0, 15.0 * kDegree});
  run(CALIBRATE_AZIMUTH, " --run '" + (folder_ / "mounted").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("sensor.lidar_in_base"), std::string::npos) << result_.err;
}

TEST_F(Calibrate, AzimuthSaysWhenItIsNotSure) {
  std::vector<Pose> curvature(200, Pose::Identity()), scatter = curvature;
  for (int i = 0; i < 200; ++i) {
    const double yaw_rad = 0.02 * i;
    curvature[static_cast<std::size_t>(i)] = poseFromVector(
        (Vector6d() << 50.0 * std::sin(yaw_rad), 50.0 * (1.0 - std::cos(yaw_rad)), 0.0, 0.0, 0.0, yaw_rad).finished());
    scatter[static_cast<std::size_t>(i)].translation() << i, i % 20 < 10 ? 0.02 * (i % 20) : 0.0, 0.0;
  }
  const std::string file = (folder_ / "poses.txt").string();
  writeKittiTrajectory(file, curvature);
  run(CALIBRATE_AZIMUTH, " --trajectory '" + file + "'");
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_NE(result_.err.find("may be the curvature of these drives"), std::string::npos) << result_.err;
  scatter.resize(60);
  writeKittiTrajectory(file, scatter);
  run(CALIBRATE_AZIMUTH, " --trajectory '" + file + "'");
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_NE(result_.err.find("not known to 0.1 deg"), std::string::npos) << result_.err;
}

TEST_F(Calibrate, AzimuthSaysWhatItCannotUse) {
  writeSkewedRun(folder_ / "short", 0.0, 30);
  writeSkewedRun(folder_ / "other", 0.2);
  const std::string of_short = " --run '" + (folder_ / "short").string() + "'";
  run(CALIBRATE_AZIMUTH, of_short);
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("29 motions"), std::string::npos) << result_.err;
  run(CALIBRATE_AZIMUTH, of_short + " --run '" + (folder_ / "other").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("other: its sensor.azimuth.angle_deg or sensor.lidar_in_base is not that of"),
            std::string::npos)
      << result_.err;
  run(CALIBRATE_AZIMUTH, " --run '" + (folder_ / "nowhere").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("nowhere"), std::string::npos) << result_.err;
  fs::create_directories(folder_ / "broken");
  std::ofstream(folder_ / "broken" / "parameters.yaml") << "sensor:\n  lidar_in_base: [1.0, 2.0, 3.0]\n";
  Json summary;
  sealRun(folder_ / "broken", {"parameters.yaml"}, "r0123456789abcdef", summary);
  run(CALIBRATE_AZIMUTH, " --run '" + (folder_ / "broken").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("sensor.lidar_in_base: must be 6"), std::string::npos) << result_.err;
  const std::string camera = (folder_ / "camera.txt").string();
  std::ofstream(camera) << "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n";
  run(CALIBRATE_AZIMUTH, " --trajectory '" + camera + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("it moves along its z axis"), std::string::npos) << result_.err;
  for (const std::string& arguments : {std::string(), of_short + " --trajectory x.txt"}) {
    run(CALIBRATE_AZIMUTH, arguments);
    EXPECT_EQ(result_.exit_code, 2);
    EXPECT_NE(result_.err.find("--run or --trajectory is needed"), std::string::npos) << result_.err;
  }
}

/// A run with `angle_deg` that found `left_deg` more.
void writeTiltedRun(const fs::path& run, double angle_deg, double left_deg, double sigma_deg) {
  fs::create_directories(run);
  PipelineParameters params;
  params.sensor.vertical_angle.angle_deg = angle_deg;
  saveYaml((run / "parameters.yaml").string(), params);
  Json summary;
  summary["vertical_reference"] = {{"looks", 30}, {"elevation_deg", left_deg}, {"elevation_sigma_deg", sigma_deg}};
  sealRun(run, {"parameters.yaml"}, "r0123456789abcdef", summary);
}

TEST_F(Calibrate, ElevationIsWhatTheRunsHadAndWhatIsLeft) {
  writeTiltedRun(folder_ / "a", 0.1, 0.08, 0.04);
  writeTiltedRun(folder_ / "b", 0.2, -0.02, 0.04);
  const fs::path yaml = folder_ / "elevation.yaml";
  run(CALIBRATE_ELEVATION, " --run '" + (folder_ / "a").string() + "' --run '" + (folder_ / "b").string() +
                               "' --output '" + yaml.string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(result_.out, contentOf(yaml));
  EXPECT_EQ(result_.err.find("warning"), std::string::npos) << result_.err;
  PipelineParameters params;
  loadYaml(yaml.string(), params, MissingKeys::kKeep);
  EXPECT_NEAR(params.sensor.vertical_angle.angle_deg, 0.182, 1e-9);  // without the prior of 0.15 deg
  EXPECT_NEAR(params.sensor.vertical_angle.sigma_deg, 0.036, 1e-9);
  EXPECT_NE(result_.err.find("together: +0.182 deg, +- 0.036 deg; to the +- of each run 0.03 deg are added"),
            std::string::npos)
      << result_.err;
}

TEST_F(Calibrate, ElevationSaysWhatItCannotUse) {
  writeTiltedRun(folder_ / "vague", 0.0, 0.08, 0.10);
  run(CALIBRATE_ELEVATION, " --run '" + (folder_ / "vague").string() + "'");
  EXPECT_EQ(result_.exit_code, 0);
  EXPECT_NE(result_.err.find("not known to 0.1 deg"), std::string::npos) << result_.err;
  writeTiltedRun(folder_ / "open", 0.0, 0.01, 0.145);
  run(CALIBRATE_ELEVATION, " --run '" + (folder_ / "open").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("open: warning: hardly better known than its sigma_deg"), std::string::npos)
      << result_.err;
  EXPECT_NE(result_.err.find("no run determines the elevation"), std::string::npos) << result_.err;
  writeSkewedRun(folder_ / "silent", 0.0);
  run(CALIBRATE_ELEVATION, " --run '" + (folder_ / "silent").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("silent: it does not tell the beams' elevation"), std::string::npos) << result_.err;
  run(CALIBRATE_ELEVATION, " --run '" + (folder_ / "nowhere").string() + "'");
  EXPECT_EQ(result_.exit_code, 2);
  EXPECT_NE(result_.err.find("nowhere"), std::string::npos) << result_.err;
}

}  // namespace
}  // namespace fail_aware::calibrate_test
