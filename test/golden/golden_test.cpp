// Golden behaviour: pose and covariance of every sweep of a small made-up drive, as committed in test/golden/. Any
// change beyond 1e-6 (m, rad, and their squares) fails. Was it meant? scripts/update_golden, and say why in the commit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "../support/street_parameters.hpp"
#include "../support/synthetic_street.hpp"
#include "fail_aware_lidar_odometry/core/odometry_pipeline.hpp"

namespace fail_aware {
namespace {

constexpr double kTolerance = 1e-6;
constexpr int kSweeps = 25;
const char* const kFile = FAIL_AWARE_SOURCE_DIR "/test/golden/street.csv";

/// Coordinates to about a millimetre: the mathematical library's last bits are not this package's behaviour.
void quantise(Sweep& sweep) {
  for (Eigen::Vector3f& point : sweep.points_lidar) {
    point = (point * 1024.0f).array().round().matrix() / 1024.0f;
  }
}

/// One row a sweep: x y z roll pitch yaw of base_link in odom; upper triangles, row by row, of the filter's covariance
/// and of the odometry's since the start.
std::vector<std::vector<double>> drive() {
  const synthetic::Street street;
  const synthetic::Drive drive;
  OdometryPipeline pipeline(synthetic::streetParameters(), 1);
  pipeline.startRedundant();
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < kSweeps; ++i) {
    Sweep sweep =
        street.scan([&](double time_s) { return drive.T_street_base(time_s); }, 0.1 * i, static_cast<std::uint32_t>(i));
    quantise(sweep);
    const SweepResult result = pipeline.step(sweep);
    const Vector6d pose = vectorFromPose(result.T_odom_base);
    std::vector<double> row(pose.data(), pose.data() + 6);
    for (const Matrix6d& covariance : {result.state.covariance, result.monitor.covariance_since_start}) {
      for (int r = 0; r < 6; ++r) {
        for (int c = r; c < 6; ++c) row.push_back(covariance(r, c));
      }
    }
    rows.push_back(row);
  }
  return rows;
}

void write(const std::vector<std::vector<double>>& rows) {
  std::ofstream file(kFile);
  char number[32];
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::snprintf(number, sizeof number, "%.12g", row[i]);
      file << (i == 0 ? "" : ",") << number;
    }
    file << '\n';
  }
}

std::vector<std::vector<double>> read() {
  std::vector<std::vector<double>> rows;
  std::ifstream file(kFile);
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

TEST(Golden, poseAndCovarianceOfEverySweepAreAsCommitted) {
  const std::vector<std::vector<double>> now = drive();
  if (std::getenv("FAIL_AWARE_UPDATE_GOLDEN") != nullptr) write(now);
  const std::vector<std::vector<double>> committed = read();
  ASSERT_EQ(now.size(), committed.size()) << kFile;
  for (std::size_t i = 0; i < now.size(); ++i) {
    ASSERT_EQ(now[i].size(), committed[i].size()) << "sweep " << i;
    for (std::size_t k = 0; k < now[i].size(); ++k) {
      ASSERT_NEAR(now[i][k], committed[i][k], kTolerance)
          << "sweep " << i << ", column " << k << "; if that was meant: scripts/update_golden";
    }
  }
}

}  // namespace
}  // namespace fail_aware
