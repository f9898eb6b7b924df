#include "evaluation/azimuth_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/degree.hpp"
#include "core/io/input_error.hpp"
#include "trajectory_poses.hpp"

namespace fail_aware::azimuth_calibration_test {
namespace {

constexpr double kAhead_m = 0.8;

/// A drive in a frame that sits ahead of the rear axle and whose x axis is off the vehicle's: in it the vehicle travels
/// `azimuth_deg` to the left of x. The rear axle slips outwards by slip_s2_per_m times the lateral acceleration.
struct Drive {
  double azimuth_deg = 0.0;
  double slip_s2_per_m = 0.0;
  double noise_m = 0.0;     ///< sideways, a sweep
  double curvatures = 0.4;  ///< largest yaw rate, rad/s
  double least_mps = 5.0, most_mps = 15.0;
  int sweeps = 400;

  std::vector<Pose> trajectory(unsigned seed) const {
    constexpr double kDt_s = 0.1;
    constexpr int kSteps = 20;  // in a sweep
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const Pose T_axle_frame = at(kAhead_m, 0.0, 1.7, -azimuth_deg * kDegree);
    Pose T_axle = at(3.0, -4.0, 0.0, 1.0), T = Pose::Identity();
    std::vector<Pose> poses = {T};
    for (int i = 1; i < sweeps; ++i) {
      const Pose T_before = T_axle;
      for (int k = 0; k < kSteps; ++k) {
        const double t = 0.1 * (i + static_cast<double>(k) / kSteps) + seed;
        const double speed = 0.5 * (least_mps + most_mps) + 0.5 * (most_mps - least_mps) * std::sin(0.23 * t);
        const double yaw_rate = curvatures * std::sin(0.41 * t) * 5.0 / speed;
        const double slip = -slip_s2_per_m * speed * yaw_rate;
        T_axle = T_axle * at(speed * std::cos(slip) * kDt_s / kSteps, speed * std::sin(slip) * kDt_s / kSteps, 0.0,
                             yaw_rate * kDt_s / kSteps);
      }
      const Pose motion = T_axle_frame.inverse() * T_before.inverse() * T_axle * T_axle_frame;
      T = T * motion * at(0.0, noise_m * normal(random));
      poses.push_back(T);
    }
    return poses;
  }
};

TEST(AzimuthCalibration, FindsTheAzimuthWhateverTheLeverAndTheSlip) {
  for (const double slip_s2_per_m : {0.0, 0.004}) {
    Drive drive;
    drive.azimuth_deg = 0.7;
    drive.slip_s2_per_m = slip_s2_per_m;
    const std::vector<Pose> poses = drive.trajectory(0);
    double distance_m = 0.0;
    for (std::size_t i = 1; i < poses.size(); ++i)
      distance_m += (poses[i].translation() - poses[i - 1].translation()).norm();
    const DirectionOfTravel found = directionOfTravel({poses});
    EXPECT_NEAR(found.direction_deg, 0.7, 0.002) << slip_s2_per_m;
    EXPECT_LT(found.sigma_deg, 0.002);
    EXPECT_EQ(found.motions, drive.sweeps - 1);
    EXPECT_NEAR(found.distance_m, distance_m, 1.0);
  }
}

TEST(AzimuthCalibration, SaysHowSureItIs) {
  Drive drive;
  drive.azimuth_deg = -0.3;
  drive.noise_m = 0.01;
  double squares = 0.0, said = 0.0;
  constexpr unsigned kDrives = 40;
  for (unsigned seed = 0; seed < kDrives; ++seed) {
    const DirectionOfTravel found = directionOfTravel({drive.trajectory(seed)});
    squares += std::pow(found.direction_deg + 0.3, 2);
    said += found.sigma_deg * found.sigma_deg;
  }
  EXPECT_LT(std::sqrt(squares / kDrives), 0.05);
  EXPECT_NEAR(std::sqrt(squares / said), 1.0, 0.3);
}

TEST(AzimuthCalibration, DrivesAreTakenTogether) {
  Drive left;
  left.azimuth_deg = 0.4;
  left.noise_m = 0.01;
  const DirectionOfTravel one = directionOfTravel({left.trajectory(1)});
  const DirectionOfTravel four =
      directionOfTravel({left.trajectory(1), left.trajectory(2), left.trajectory(3), left.trajectory(4)});
  EXPECT_EQ(four.motions, 4 * one.motions) << "none between two drives";
  EXPECT_NEAR(four.direction_deg, 0.4, 0.04);
  EXPECT_LT(four.sigma_deg, one.sigma_deg);
}

TEST(AzimuthCalibration, StraightOnAtOneSpeedWillDo) {
  Drive straight;
  straight.azimuth_deg = 0.25;
  straight.curvatures = 0.0;
  straight.least_mps = straight.most_mps = 10.0;
  EXPECT_NEAR(directionOfTravel({straight.trajectory(1)}).direction_deg, 0.25, 1e-6);
}

TEST(AzimuthCalibration, FalseMotionsCountLittle) {
  Drive drive;
  drive.azimuth_deg = 0.25;
  drive.noise_m = 0.005;
  std::vector<Pose> poses = drive.trajectory(1);
  for (std::size_t i = 10; i < poses.size(); i += 20) poses[i].translation().y() += 1.0;  // and back, in the next
  EXPECT_NEAR(directionOfTravel({poses}).direction_deg, 0.25, 0.06);
}

TEST(AzimuthCalibration, GapsAndJumpsAreLeftOut) {
  Drive drive;
  drive.azimuth_deg = 0.25;
  drive.noise_m = 0.005;
  for (const double jump_m : {7.0, 60.0, 200.0}) {
    std::vector<Pose> poses = drive.trajectory(1);
    poses.erase(poses.begin() + 100, poses.begin() + 110);
    const Pose jump = at(jump_m, 0.6 * jump_m, 0.0, 0.3);
    for (std::size_t i = 200; i < poses.size(); ++i) poses[i] = jump * poses[i];
    const DirectionOfTravel found = directionOfTravel({poses});
    EXPECT_NEAR(found.direction_deg, 0.25, 0.03) << jump_m;
    EXPECT_LT(found.sigma_deg, 0.04) << jump_m;
    EXPECT_EQ(found.motions, static_cast<int>(poses.size()) - 3) << jump_m;
  }
}

TEST(AzimuthCalibration, HugeMotionsAreNoMotions) {
  std::vector<Pose> poses = {Pose::Identity()};
  for (int i = 1; i < 100; ++i) poses.push_back(at(1e200 * i, 1e150 * i));
  EXPECT_THROW(directionOfTravel({poses}), InputError);
}

TEST(AzimuthCalibration, ASteadyBendIsSaidToTellNothing) {
  std::vector<Pose> circle = {Pose::Identity()};
  for (int i = 0; i < 200; ++i) circle.push_back(circle.back() * at(1.0, 0.0, 0.0, 0.02));
  EXPECT_GT(directionOfTravel({circle}).curvature_ratio, 0.99);
  Drive both_sides;
  EXPECT_LT(directionOfTravel({both_sides.trajectory(1)}).curvature_ratio, 0.2);
}

TEST(AzimuthCalibration, AWayThatIsNotAheadIsRefused) {
  for (const double yaw_deg : {60.0, 90.0, 180.0, -120.0}) {
    Drive drive;
    drive.azimuth_deg = yaw_deg;
    EXPECT_THROW(directionOfTravel({drive.trajectory(1)}), InputError) << yaw_deg;
  }
}

TEST(AzimuthCalibration, StandingTellsNothing) {
  Drive drive;
  drive.sweeps = 51;
  std::vector<Pose> poses = drive.trajectory(1);
  poses.resize(101, poses.back());
  EXPECT_EQ(directionOfTravel({poses}).motions, 50);
  poses.erase(poses.begin());
  EXPECT_THROW(directionOfTravel({poses}), InputError);
  EXPECT_THROW(directionOfTravel({}), InputError);
}

}  // namespace
}  // namespace fail_aware::azimuth_calibration_test
