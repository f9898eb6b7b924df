// A run folder as offline_odometry would have written it, made up: straight on at a constant speed, with errors of
// known covariance, and its ground truth.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "../../src/tools/run_folder.hpp"
#include "core/io/measurement_log.hpp"
#include "core/io/monitor_log.hpp"
#include "core/io/trajectory_io.hpp"
#include "core/parameters/yaml_parameters.hpp"
#include "core/pipeline_parameters.hpp"
#include "simulation/random.hpp"

namespace fail_aware {

struct MadeUpRun {
  int sweeps = 400;
  double speed_mps = 10.0;
  double drift_m = 0.0;  ///< sideways, a sweep: the estimate is to the left
  double sigma_m = 0.0;  ///< true standard deviations of an increment's errors
  double sigma_up_m = 0.0;
  double sigma_yaw_rad = 0.0;
  double sigma_tilt_rad = 0.0;
  double said_sigma_m = 0.01;  ///< what the filter says of them
  double said_sigma_yaw_rad = 2e-4;
  unsigned seed = 1;
  std::size_t first = 0;  ///< scan of its drive, which ends with the run
  double drive_begin_stamp_s = 0.0;
  int pose_set_at = -1;                ///< sweep with which odom moved; -1: none
  int new_drive_at = -1;  ///< sweep with which a drive began anew
  std::vector<std::size_t> refused{};  ///< sweeps that have a scan and a true pose, and no row in the logs

  /// Writes FOLDER/monitor_log.csv, FOLDER/measurements.csv (the first measurement is the estimate, the second too, but
  /// says twice its standard deviation), FOLDER/parameters.yaml, FOLDER/poses.txt and FOLDER/summary.json.
  void write(const std::filesystem::path& folder, const PipelineParameters& params = {}) const {
    std::filesystem::create_directories(folder);
    RandomStream random(seed);  // standard libraries differ in what their distributions draw
    const Pose T_lidar_cog = params.sensor.T_base_lidar().inverse() * params.vehicle.T_base_cog();
    std::vector<Pose> truth;
    std::ofstream log(folder / "monitor_log.csv");
    log << monitorLogHeader() << '\n';
    std::ofstream measurements(folder / "measurements.csv");
    measurements << measurementLogHeader() << '\n';
    Pose T_true = Pose::Identity(), T = Pose::Identity();
    for (int i = 0; i < sweeps; ++i) {
      MonitorInput input;
      FilterState& s = input.state;
      input.row = static_cast<std::size_t>(i);
      s.stamp_s = 0.1 * i;
      s.odom_reset_count = pose_set_at >= 0 && i >= pose_set_at ? 1 : 0;
      s.sigma_yaw_rad = 1e-3 + 1e-6 * (i % 2);
      s.measurement_applied = true;
      s.map_update = MapUpdate::kInsert;
      s.motion_status = MotionStatus::kObserved;
      s.fusion.valid_inputs = 3;
      s.fusion.confirmed = true;
      s.fusion.has_measurement = true;
      s.fusion.weights = {1.0, 1.0, 1.0};
      s.fusion.nis = {6.0, 6.0, -1.0};
      if (i > 0) {
        s.dt_s = i == new_drive_at ? 0.0 : 0.1;
        Vector6d step = Vector6d::Zero(), error = Vector6d::Zero();
        step[0] = speed_mps * s.dt_s;
        error << sigma_m * random.normal(), sigma_m * random.normal() + drift_m, sigma_up_m * random.normal(),
            sigma_tilt_rad * random.normal(), sigma_tilt_rad * random.normal(), sigma_yaw_rad * random.normal();
        s.T_previous_now = poseFromVector(step + error);
        T_true = T_true * poseFromVector(step);
        T = T * s.T_previous_now;
        s.increment_covariance.diagonal().head<3>().setConstant(said_sigma_m * said_sigma_m);
        s.increment_covariance.diagonal().tail<3>().setConstant(said_sigma_yaw_rad * said_sigma_yaw_rad);
        s.motion_covariance = 1e4 * Matrix6d::Identity();  // all is known by registration
        s.registration_covariance = s.increment_covariance;
        s.registered = true;
        for (const std::size_t source : {0u, 1u}) {
          const double scale = source == 0u ? 1.0 : 4.0;
          measurements << measurementLogRow({input.row, source, s.T_previous_now, scale * s.increment_covariance})
                       << '\n';
        }
      }
      s.T_odom_cog = T;
      if (std::find(refused.begin(), refused.end(), input.row) == refused.end()) log << monitorLogRow(input) << '\n';
      truth.push_back(T_true * T_lidar_cog.inverse());
    }
    saveYaml((folder / "parameters.yaml").string(), params);
    writeKittiTrajectory((folder / "poses.txt").string(), truth);
    log.close();
    measurements.close();
    seal(folder);
  }

  /// Writes FOLDER/summary.json anew, for these files as they are.
  void seal(const std::filesystem::path& folder,
            const std::vector<std::string>& files = {"monitor_log.csv", "measurements.csv", "parameters.yaml"}) const {
    Json summary;
    summary["run"] = {{"first", first},
                      {"scans", sweeps},
                      {"drive_scans", first + static_cast<std::size_t>(sweeps)},
                      {"drive_begin_stamp_s", drive_begin_stamp_s},
                      {"without_pose", refused}};
    sealRun(folder, files, "r0123456789abcdef", summary);
  }
};

}  // namespace fail_aware
