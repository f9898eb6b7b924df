// Runs the built tool on made-up runs; EVALUATE_FAIL_AWARE is its path (compile definition).
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "made_up_runs_test.hpp"

namespace fail_aware::evaluate_fail_aware_test {
namespace {

namespace fs = std::filesystem;

class EvaluateFailAware : public MadeUpRunsTest {
 protected:
  void run(const std::string& arguments) { MadeUpRunsTest::run(EVALUATE_FAIL_AWARE, arguments); }

  /// Makes a run of 12 s up, and judges it into result/.
  void judgeShortRun(const std::string& name, const std::string& more = "") {
    MadeUpRun made_up;
    made_up.sweeps = 120;
    made_up.write(folder_ / name);
    run(options(name) + " --resamples 1" + more + " --output '" + (folder_ / "result").string() + "'");
  }

  nlohmann::json report() const { return nlohmann::json::parse(contentOf(folder_ / "result" / "fail_aware.json")); }

  void expectRefused(const std::string& arguments, const std::string& reason) {
    run(arguments);
    EXPECT_EQ(result_.exit_code, 2) << arguments;
    EXPECT_EQ(result_.out, "");
    expectOneErrorLine(result_, "evaluate_fail_aware", reason);
  }
};

/// Whatever row, not the last one only: a log that was cut and joined.
TEST_F(EvaluateFailAware, ARowThatTheTruthDoesNotHaveIsRefused) {
  MadeUpRun made_up;
  made_up.sweeps = 30;
  made_up.write(folder_ / "run");
  const std::filesystem::path log = folder_ / "run" / "monitor_log.csv";
  const std::string text = contentOf(log);
  const std::size_t row = text.find("\n10,");
  ASSERT_NE(row, std::string::npos) << text.substr(0, 400);
  std::ofstream(log) << text.substr(0, row) << "\n1000000," << text.substr(row + 4);
  made_up.seal(folder_ / "run");
  expectRefused(options("run"), "has row 1000000");
}

TEST_F(EvaluateFailAware, PosesOfTheCameraNeedTheirCalibration) {
  MadeUpRun made_up;
  made_up.write(folder_ / "run");
  std::ofstream truth(folder_ / "run" / "poses.txt");
  for (int i = 0; i < made_up.sweeps; ++i) truth << "1 0 0 0 0 1 0 0 0 0 1 " << i << "\n";
  truth.close();
  expectRefused(options("run"), "give --calib calib.txt");
}

TEST_F(EvaluateFailAware, ATruthThatIsNotInMetresIsTold) {
  judgeShortRun("run");
  EXPECT_EQ(result_.err.find("warning"), std::string::npos) << result_.err;
  std::vector<Pose> truth = readKittiTrajectory((folder_ / "run" / "poses.txt").string());
  for (Pose& pose : truth) pose.translation() *= 1000.0;
  writeKittiTrajectory((folder_ / "run" / "poses.txt").string(), truth);
  run(options("run") + " --resamples 1");
  EXPECT_NE(result_.err.find("warning: "), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("the true poses reach 11"), std::string::npos) << result_.err;
  EXPECT_NE(result_.err.find("the ground truth is another drive's or not in m"), std::string::npos) << result_.err;
}

TEST_F(EvaluateFailAware, KnownDriftsGiveKnownEpisodes) {
  MadeUpRun good, bad;
  bad.drift_m = 0.0101;  // 0.606 m after 6.0 s: t1 at 0, 5, .. 30 s fail, that at 35 s is watched for 4.9 s
  good.write(folder_ / "good");
  bad.write(folder_ / "bad");
  run(options("good") + options("bad") + " --resamples 50 --output '" + (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(result_.err.rfind("evaluate_fail_aware: 16 starts, 7 fail; missed ", 0), 0u) << result_.err;
  EXPECT_NE(result_.err.find("plot_fail_aware " + (folder_ / "result").string()), std::string::npos) << result_.err;
  const nlohmann::json json = report();
  EXPECT_EQ(json["good"]["episodes"], 8);
  EXPECT_EQ(json["good"]["failing"], 0);
  EXPECT_EQ(json["bad"]["failing"], 7);
  EXPECT_EQ(json["pooled"]["episodes"], 16);
  EXPECT_NEAR(json["bad"]["watched_s"].get<double>(), 7 * 6.0 + 4.9, 1e-6);
  // the drift is no secret of time: elapsed time orders every pair of failing episodes rightly
  EXPECT_EQ(json["bad"]["concordance"]["elapsed_time"]["index"], 1.0);
  EXPECT_EQ(json["bad"]["concordance"]["constant"]["index"], 0.5);
  EXPECT_TRUE(json["good"]["concordance"]["combination"]["index"].is_null()) << "no failure, no order";
  EXPECT_NEAR(json["bad"]["consistency"]["nis"]["icp_point_to_point"]["mean_per_dof"].get<double>(), 1.0, 1e-9);
  EXPECT_TRUE(json["bad"]["consistency"]["nis"]["corner_svd"].is_null());
  EXPECT_NEAR(json["bad"]["failure_p50_s"].get<double>(), 6.0, 1e-6);
  EXPECT_TRUE(json["good"]["failure_p50_s"].is_null());
  EXPECT_TRUE(json["good"]["eta_threshold_p50_s"].is_null()) << "the heading's sigma is all but steady";
  for (const char* name : {"combination", "eta", "covariance"}) EXPECT_TRUE(json["bad"]["times"].contains(name));

  EXPECT_NE(result_.out.find("concordance combination"), std::string::npos);
  const std::size_t missed = result_.out.find("  missed, %");
  ASSERT_NE(missed, std::string::npos);
  EXPECT_EQ(result_.out.substr(missed + 38, 14), "             -") << "of good no start fails";
  EXPECT_EQ(result_.out.find("nan"), std::string::npos);
  const std::string csv = contentOf(folder_ / "result" / "predictions.csv");
  EXPECT_EQ(csv.rfind("run,begin_s,failed,since_start_s,remaining_s,", 0), 0u);
  EXPECT_NE(csv.find("\nbad,30.000000,1,0,6,"), std::string::npos);
}

/// 10 m/s: a stop takes 5 s. Sideways drift: 0.606 m after 12 s.
TEST_F(EvaluateFailAware, ThePlannersFigureOfAKnownDrift) {
  MadeUpRun good, bad;
  bad.drift_m = 0.00505;
  good.write(folder_ / "good");
  bad.write(folder_ / "bad");
  std::ofstream(folder_ / "bad" / "faults.csv") << "kind,start_s,duration_s,severity\nhalf_sweep,9,1,0.5\n";
  const std::string never = " --set monitor.indicator.threshold=1.0e9 --set monitor.predictor.alert_limit_m=1.0e9";
  run(options("good") + options("bad") + never + " --alert-limit 0.6 --resamples 1 --output '" +
      (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const nlohmann::json planner = report()["pooled"]["planner"];
  EXPECT_EQ(planner["time_or_state"]["in_time"]["count"], 0) << "it never stops";
  EXPECT_EQ(planner["time_or_state"]["in_time"]["of"], 6) << "t1 at 0, 5, .. 25 s";
  EXPECT_EQ(planner["time_or_state"]["used_ratio"], 1.0);
  EXPECT_NEAR(planner["time_or_state"]["in_time"]["interval"][1].get<double>(), 0.4593, 1e-4);
  EXPECT_EQ(planner["fixed_time"]["in_time"]["count"], 0) << "no worse than the planner";
  EXPECT_EQ(planner["sudden_faults_apart"]["time_or_state"]["too_sudden"], 1) << "t1 at 0: 3 s from the fault on";
  EXPECT_EQ(planner["sudden_faults_apart"]["time_or_state"]["in_time"]["of"], 5);
  bad.drive_begin_stamp_s = -3.0;  // the run begins 3 s later: for it the fault is at 6 s
  bad.seal(folder_ / "bad");
  run(options("good") + options("bad") + never + " --alert-limit 0.6 --resamples 1 --output '" +
      (folder_ / "result").string() + "'");
  EXPECT_EQ(report()["pooled"]["planner"]["sudden_faults_apart"]["time_or_state"]["too_sudden"], 0);
  EXPECT_TRUE(report()["good"]["planner"]["sudden_faults_apart"].is_null());
  EXPECT_EQ(report()["good"]["planner"]["time_or_state"]["sound_stopped"]["of"], 8);
  EXPECT_NE(result_.out.find("planner: stopped in time"), std::string::npos);

  run(options("bad") + never +
      " --alert-limit 0.6 --deceleration 100 --resamples 1 --set monitor.predictor.horizon_s=1 " +
      "--set monitor.indicator.horizon_s=1 --set monitor.thresholds.degraded_s=0.9 --set "
      "monitor.thresholds.failing_s=0.9 " +
      "--output '" + (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const nlohmann::json hasty = report()["bad"]["planner"];
  EXPECT_EQ(hasty["time_or_state"]["in_time"]["count"], 6)
      << "a horizon of 1 s: the time is never more than the stop takes";
  EXPECT_NEAR(hasty["time_or_state"]["used_ratio_of_failing"].get<double>(), 3.0 / 11.0, 0.01);
  std::ofstream(folder_ / "bad" / "faults.csv") << "kind,start_s\nhalf_sweep,soon\n";
  expectRefused(options("bad"), "faults.csv:2: 'soon' is no number; a line is kind,start_s,duration_s,severity");
}

TEST_F(EvaluateFailAware, TrueIncrementCovariancesHaveANeesOfOne) {
  MadeUpRun run_;
  run_.sweeps = 3000;
  run_.sigma_m = run_.said_sigma_m;
  run_.sigma_yaw_rad = run_.said_sigma_yaw_rad;
  run_.write(folder_ / "true");
  run_.said_sigma_m *= 2.0;
  run_.said_sigma_yaw_rad *= 2.0;
  run_.write(folder_ / "modest");
  run(options("true") + options("modest") + " --resamples 1 --episode-every 100 --output '" +
      (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const nlohmann::json json = report();
  EXPECT_NEAR(json["true"]["consistency"]["increment_horizontal"]["mean_per_dof"].get<double>(), 1.0, 0.08);
  EXPECT_NEAR(json["modest"]["consistency"]["increment_horizontal"]["mean_per_dof"].get<double>(), 0.25, 0.02);
}

TEST_F(EvaluateFailAware, MeasurementCovariancesAreJudged) {
  MadeUpRun run_;
  run_.sweeps = 3000;
  run_.sigma_m = run_.sigma_up_m = run_.said_sigma_m;
  run_.sigma_yaw_rad = run_.sigma_tilt_rad = run_.said_sigma_yaw_rad;
  run_.write(folder_ / "run");
  run_.write(folder_ / "before_they_were_logged");
  fs::remove(folder_ / "before_they_were_logged" / "measurements.csv");
  run_.seal(folder_ / "before_they_were_logged", {"monitor_log.csv", "parameters.yaml"});
  run(options("run") + options("before_they_were_logged") + " --resamples 1 --episode-every 100 --output '" +
      (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const nlohmann::json report_ = report();
  const nlohmann::json& of = report_["run"]["consistency"]["measurement"];
  EXPECT_EQ(of["icp_point_to_point"]["samples"], 2999);
  EXPECT_NEAR(of["icp_point_to_point"]["mean_per_dof"].get<double>(), 1.0, 0.05);
  EXPECT_NEAR(of["icp_point_to_plane"]["mean_per_dof"].get<double>(), 0.25, 0.0125);
  EXPECT_TRUE(of["corner_svd"].is_null());
  EXPECT_NE(result_.out.find("NEES/dof icp_point_to_point"), std::string::npos);
  const nlohmann::json& unknown = report_["before_they_were_logged"]["consistency"]["measurement"];
  EXPECT_TRUE(unknown["icp_point_to_point"].is_null());
}

TEST_F(EvaluateFailAware, AFailureIsWhatTheRunsLimitSays) {
  MadeUpRun made_up;
  made_up.drift_m = 0.0101;
  PipelineParameters wide;
  wide.profile.monitor.predictor.alert_limit_m = 50.0;
  made_up.write(folder_ / "wide", wide);
  made_up.write(folder_ / "usual");
  const std::string output = " --resamples 1 --output '" + (folder_ / "result").string() + "'";
  run(options("wide") + output);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(report()["wide"]["failing"], 0);
  EXPECT_EQ(report()["wide"]["alert_limit_m"], 50.0);
  run(options("wide") + output + " --alert-limit 0.6");
  EXPECT_EQ(report()["wide"]["failing"], 7);
  const nlohmann::json since_t1 = report()["wide"]["consistency"]["accumulated_position_since_t1"];
  ASSERT_EQ(since_t1.size(), 3u);
  EXPECT_EQ(since_t1[1]["from_s"], 5.0);
  EXPECT_GT(since_t1[1]["consistency"]["samples"].get<int>(), 0);
  expectRefused(options("usual") + options("wide"), "--alert-limit");
}

TEST_F(EvaluateFailAware, ParametersCanBeChangedForTheReplay) {
  MadeUpRun made_up;
  made_up.drift_m = 0.0101;
  PipelineParameters article;
  article.profile.monitor.indicator.average_s = article.profile.monitor.indicator.reference_speed_mps = 0.0;
  made_up.write(folder_ / "run", article);
  const std::string output = " --resamples 1 --output '" + (folder_ / "result").string() + "'";
  run(options("run") + output +
      " --set monitor.indicator.threshold=1.0e9 --set monitor.predictor.alert_limit_m=1.0e9 --alert-limit 0.6");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(report()["run"]["missed"], 7) << "nothing is ever near such limits";
  std::ofstream(folder_ / "strict.yaml") << "monitor:\n  indicator:\n    threshold: 1.0e-12\n";
  run(options("run") + output + " --parameters '" + (folder_ / "strict.yaml").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(report()["run"]["missed"], 0);
  EXPECT_GT(report()["run"]["lead_p50_s"].get<double>(), 4.0);
  EXPECT_TRUE(report()["run"]["stop_in_time_2mps2"].is_number());
  std::ofstream(folder_ / "lax.yaml")
      << "monitor:\n  indicator:\n    threshold: 1.0e+9\n  predictor:\n    alert_limit_m: 1.0e+9\n";
  run(options("run") + output + " --parameters '" + (folder_ / "strict.yaml").string() + "' --parameters '" +
      (folder_ / "lax.yaml").string() + "' --alert-limit 1000");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(report()["run"]["alarm_ratio"], 0.0) << "the last file counts";
  EXPECT_TRUE(report()["run"]["stop_in_time_2mps2"].is_null()) << "nothing failed";
}

TEST_F(EvaluateFailAware, AKeyOfAFileWithoutEffectIsTold) {
  MadeUpRun made_up;
  made_up.sweeps = 60;
  made_up.write(folder_ / "run");
  std::ofstream(folder_ / "noise.yaml") << "filter:\n  increment_scale: 3.5\n  increment_floor_m: 0.25\n"
                                           "monitor:\n  drift:\n    scale_bias: 0.002\n";
  const std::string arguments =
      options("run") + " --resamples 1 --parameters '" + (folder_ / "noise.yaml").string() + "'";
  run(arguments);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(result_.err.rfind("evaluate_fail_aware: warning: run was made with another filter.increment_", 0), 0u)
      << result_.err;
  EXPECT_NE(result_.err.find("(and 1 more keys), which has no effect here: run offline_odometry with it\n"),
            std::string::npos)
      << result_.err;
  PipelineParameters same;
  same.profile.filter.increment_scale = 3.5;
  same.profile.filter.increment_floor_m = 0.25;
  made_up.write(folder_ / "run", same);
  run(arguments);
  EXPECT_EQ(result_.err.find("warning"), std::string::npos) << result_.err;
}

TEST_F(EvaluateFailAware, RunsOfOneNameStayApart) {
  MadeUpRun good;
  good.sweeps = 120;
  good.write(folder_ / "a" / "out");
  good.write(folder_ / "b" / "out");
  const auto of = [&](const char* drive) {
    const std::string folder = (folder_ / drive / "out").string();
    return " --ground-truth '" + folder + "/poses.txt' --run '" + folder + "'";
  };
  run(of("a") + of("b") + " --resamples 1 --output '" + (folder_ / "result").string() + "'");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  for (const char* file : {"predictions.csv", "episodes.csv"}) {
    const std::string csv = contentOf(folder_ / "result" / file);
    EXPECT_NE(csv.find("\nout,"), std::string::npos) << file;
    EXPECT_NE(csv.find("\nout#2,"), std::string::npos) << file;
  }
}

TEST_F(EvaluateFailAware, ARunsNameMayContainCommasAndQuotes) {
  judgeShortRun("rain, \"heavy\"");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  for (const char* file : {"predictions.csv", "episodes.csv"}) {
    const std::string csv = contentOf(folder_ / "result" / file);
    EXPECT_NE(csv.find("\n\"rain, \"\"heavy\"\"\",0"), std::string::npos) << csv.substr(0, 400);
  }
}

TEST_F(EvaluateFailAware, ARunWithASetPoseOrTwoDrivesIsRefused) {
  MadeUpRun made_up;
  made_up.sweeps = 60;
  made_up.pose_set_at = 30;
  made_up.write(folder_ / "run");
  expectRefused(options("run"), "a pose was set at stamp 3.0");
  made_up.pose_set_at = -1;
  made_up.new_drive_at = 30;
  made_up.write(folder_ / "run");
  expectRefused(options("run"), "the stamps jump at stamp 3.0");
}

/// A run of a part of a drive (offline_odometry --first) is held against that part of the truth.
TEST_F(EvaluateFailAware, ALaterPartOfADriveHasItsOwnTruth) {
  constexpr int kFirst = 7;
  MadeUpRun made_up;
  made_up.drift_m = 0.0101;
  made_up.sweeps = 120;
  made_up.write(folder_ / "run");
  const std::string output = " --resamples 1 --output '" + (folder_ / "result").string() + "'";
  run(options("run") + output);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const nlohmann::json whole = report();
  const std::string truth = contentOf(folder_ / "run" / "poses.txt");
  std::ofstream longer(folder_ / "run" / "poses.txt");
  for (int i = 0; i < kFirst; ++i) longer << "1 0 0 " << i << " 0 1 0 0 0 0 1 0\n";  // before it
  longer << truth;
  longer.close();
  made_up.first = kFirst;
  made_up.seal(folder_ / "run");
  run(options("run") + output);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(report(), whole);
  made_up.first = kFirst + 1;
  made_up.seal(folder_ / "run");
  expectRefused(options("run"), "do not belong together");
  std::string summary = contentOf(folder_ / "run" / "summary.json");
  summary.replace(summary.find("\"first\": 8"), 10, "\"first\": -1");
  std::ofstream(folder_ / "run" / "summary.json") << summary;
  expectRefused(options("run"), "/run/first");
  std::ofstream(folder_ / "run" / "summary.json") << "{";
  expectRefused(options("run"), "summary.json: cannot be read as JSON");
}

TEST_F(EvaluateFailAware, MixedOrUnfinishedRunsAreRefused) {
  MadeUpRun made_up, other;
  made_up.sweeps = other.sweeps = 60;
  other.speed_mps = 11.0;
  const fs::path run_folder = folder_ / "run";
  for (const char* name : {"monitor_log.csv", "measurements.csv", "parameters.yaml"}) {
    made_up.write(run_folder);
    other.write(folder_ / "other", [] {
      PipelineParameters params;
      params.profile.monitor.predictor.horizon_s = 50.0;
      return params;
    }());
    run(options("run") + " --resamples 1");
    ASSERT_EQ(result_.exit_code, 0) << result_.err;
    fs::copy_file(folder_ / "other" / name, run_folder / name, fs::copy_options::overwrite_existing);
    expectRefused(options("run"),
                  std::string(name) + ": not the file that run r0123456789abcdef of summary.json wrote");
    fs::remove(run_folder / name);
    expectRefused(options("run"), std::string(name) + ": missing");
  }
  made_up.write(run_folder);
  std::ofstream(run_folder / "monitor_log.csv", std::ios::app) << " ";
  expectRefused(options("run"), "run offline_odometry again");
  made_up.write(run_folder);
  fs::create_directory(run_folder / "unfinished_r0123456789abcdef");
  expectRefused(options("run"), "did not finish");
  fs::remove(run_folder / "unfinished_r0123456789abcdef");
  fs::remove(run_folder / "summary.json");
  expectRefused(options("run"), "not the folder of a finished run; run offline_odometry again");
  std::ofstream(run_folder / "summary.json") << R"({"run": {"first": 0}})";
  expectRefused(options("run"), "names no run (run.id, files)");
}

TEST_F(EvaluateFailAware, RefusedSweepsDoNotShiftTheTruth) {
  MadeUpRun made_up;
  made_up.sweeps = 120;
  made_up.sigma_m = made_up.said_sigma_m;
  const std::string output = " --resamples 1 --episode-every 100 --output '" + (folder_ / "result").string() + "'";
  made_up.write(folder_ / "run");
  run(options("run") + output);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const nlohmann::json all = report();
  made_up.refused = {3, 40, 41};
  made_up.write(folder_ / "run");
  run(options("run") + output);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(report()["run"]["failing"], all["run"]["failing"]) << "a row of truth off by one is 1 m, and a failure";
}

/// Runs that are judged one by one and then together have the figures of all at once, to the last digit.
TEST_F(EvaluateFailAware, KeptEpisodesGiveTheSameFigures) {
  MadeUpRun good, bad;
  good.sigma_m = good.said_sigma_m;
  bad.drift_m = 0.0101;
  good.write(folder_ / "good");
  bad.write(folder_ / "bad");
  const auto output = [&](const char* name) { return " --resamples 20 --output '" + (folder_ / name).string() + "'"; };
  std::string kept;
  for (const char* name : {"good", "bad"}) {
    const std::string result = std::string(name) + "_result";
    run(options(name) + output(result.c_str()) + " --keep-episodes");
    ASSERT_EQ(result_.exit_code, 0) << result_.err;
    kept += " --episodes '" + (folder_ / result / "episodes.bin").string() + "'";
  }
  run(options("good") + options("bad") + output("at_once"));
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const std::string table = result_.out;
  run(kept + output("result"));
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  EXPECT_EQ(result_.out, table);
  for (const char* name : {"fail_aware.json", "predictions.csv", "episodes.csv"}) {
    EXPECT_EQ(contentOf(folder_ / "result" / name), contentOf(folder_ / "at_once" / name)) << name;
  }
  EXPECT_EQ(countOf(contentOf(folder_ / "result/episodes.csv"), "\nbad,"), 8u);
  expectRefused(kept + kept, "given twice");

  const fs::path file = folder_ / "bad_result/episodes.bin";
  const std::string whole = contentOf(file);
  std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() / 2);
  expectRefused(kept, "not a complete and undamaged file of episodes");
  std::ofstream(file, std::ios::binary) << "something else";
  expectRefused(kept, "not a complete and undamaged file of episodes");
  fs::remove(file);
  expectRefused(kept, "episodes.bin: cannot be read");
  run(options("bad") + output("bad_result") + " --keep-episodes --episode-every 7");
  expectRefused(kept, "another --alert-limit or --episode-every");
  expectRefused(kept + options("good"), "excludes --episodes");
  expectRefused(kept + " --set monitor.predictor.alert_limit_m=0.9", "--set excludes --episodes");
}

TEST_F(EvaluateFailAware, ADamagedEpisodeFileIsRefused) {
  judgeShortRun("run", " --keep-episodes");
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  const fs::path file = folder_ / "result/episodes.bin";
  const std::string whole = contentOf(file);
  const std::string episodes = " --resamples 1 --episodes '" + file.string() + "'";
  run(episodes);
  ASSERT_EQ(result_.exit_code, 0) << result_.err;
  for (std::size_t at = 20; at < whole.size(); at += whole.size() / 20) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
    std::ofstream(file, std::ios::binary) << damaged;
    expectRefused(episodes, "not a complete and undamaged file of episodes");
  }
  // A number of runs that the file's size allows, but no computer's memory.
  std::string count(8, '\0');
  count[3] = 0x10;  // 2^28
  std::ofstream(file, std::ios::binary) << whole.substr(0, whole.find('\n') + 1) << count << std::string(8, '\xff');
  fs::resize_file(file, std::uintmax_t{1} << 29u);
  expectRefused(episodes, "not a complete and undamaged file of episodes");
}

TEST_F(EvaluateFailAware, UnusableInputIsRefusedInOneLine) {
  MadeUpRun made_up;
  made_up.sweeps = 30;
  made_up.write(folder_ / "run");
  expectRefused("", "--ground-truth");
  expectRefused("--run x --run y --ground-truth z", "as many of one as of the other");
  expectRefused(options("absent"), "absent: no such folder");
  expectRefused(options("run") + " --set monitor.nonsense=1", "monitor.nonsense");
  expectRefused(options("run") + " --set filter.increment_scale=3",
                "--set filter.increment_scale=3: only keys of monitor. have");
  expectRefused(options("run") + " --alert-limit -1", "--alert-limit: '-1' is not a number above 0");
  expectRefused(options("run") + " --alert-limit 0", "--alert-limit");
  expectRefused(options("run") + " --resamples 0", "--resamples");
  std::ofstream(folder_ / "short.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  expectRefused("--ground-truth '" + (folder_ / "short.txt").string() + "' --run '" + (folder_ / "run").string() + "'",
                "do not belong together");
  std::ofstream(folder_ / "run" / "monitor_log.csv") << "stamp\n1\n";
  made_up.seal(folder_ / "run");
  expectRefused(options("run"), "run offline_odometry again");
}

TEST_F(EvaluateFailAware, HelpListsTheOptions) {
  run("--help");
  EXPECT_EQ(result_.exit_code, 0);
  for (const char* option : {"--ground-truth", "--run", "--calib", "--output", "--set", "--parameters", "--resamples",
                             "--seed", "--early", "--keep-episodes", "--episodes"}) {
    EXPECT_NE(result_.out.find(option), std::string::npos) << option;
  }
}

}  // namespace
}  // namespace fail_aware::evaluate_fail_aware_test
