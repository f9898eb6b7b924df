#include "core/pipeline_parameters.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "core/geometry/rotation.hpp"
#include "core/parameters/parameter_map.hpp"
#include "core/parameters/validate.hpp"
#include "parameters/error_of.hpp"

namespace fail_aware::pipeline_parameters_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string refusal(const PipelineParameters& params) {
  return errorOf([&] { validate(params); });
}

/// What is said of one assignment "key=value".
std::string refusalOf(const std::string& assignment) {
  PipelineParameters params;
  setParameter(params, assignment);
  return refusal(params);
}

bool startsWith(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

TEST(PipelineParameters, TheDefaultsAreValid) {
  EXPECT_EQ(refusal(PipelineParameters()), kNoError);
  EXPECT_NO_THROW(validate(ProfileParameters()));
  EXPECT_NO_THROW(validate(RegistrationParameters()));
}

TEST(PipelineParameters, KeysAreUnique) {
  std::set<std::string> keys;
  for (const auto& [key, value] : toList(PipelineParameters())) EXPECT_TRUE(keys.insert(key).second) << key;
  for (const char* key :
       {"sensor.timing.source", "sensor.vertical_angle.angle_deg", "sensor.azimuth.angle_deg", "sensor.lidar_in_base",
        "vehicle.dynamics.mass_kg", "vehicle.cog_in_base", "sweep_correction.enabled", "model.six_dof",
        "history.window_sweeps", "registration.reference.voxels.voxel_size_m",
        "registration.icp_point_to_plane.kernel_m", "monitor.indicator.threshold"}) {
    EXPECT_EQ(keys.count(key), 1u) << key;
  }
  for (const auto& [key, value] : toList(ProfileParameters())) EXPECT_EQ(keys.count(key), 1u) << key;
}

TEST(PipelineParameters, MessagesCarryTheFullName) {
  for (const char* key : {"sensor.timing.sweep_period_s",
                          "sensor.vertical_angle.angle_deg",
                          "sensor.azimuth.angle_deg",
                          "vehicle.dynamics.mass_kg",
                          "model.sigma_x_m",
                          "filter.increment_scale",
                          "filter.dead_reckoning.acceleration_mps2",
                          "registration.cloud.map_voxel_m",
                          "registration.reference.range_m",
                          "registration.reference.voxels.voxel_size_m",
                          "registration.initialization.standstill_m",
                          "registration.icp_point_to_point.kernel_m",
                          "registration.icp_point_to_point.observability.min_information_ratio",
                          "registration.icp_point_to_plane.kernel_m",
                          "registration.icp_point_to_plane.observability.min_information_ratio",
                          "registration.corner_extraction.max_corner_gap_m",
                          "fusion.gate_sigma",
                          "monitor.rate_window_s",
                          "monitor.indicator.threshold",
                          "monitor.predictor.alert_limit_m",
                          "monitor.thresholds.failing_s"}) {
    const std::string said = refusalOf(std::string(key) + "=-99.5");
    EXPECT_TRUE(startsWith(said, std::string(key) + " = -99.5: must be ")) << key << ": " << said;
  }
}

// Every number, text and list in the tree is checked, and the message names it.
TEST(PipelineParameters, EveryFieldRefusesWhatCannotBe) {
  PipelineParameters params;
  detail::visitLeaves(params, "", [&](const std::string& key, auto& field) {
    using Field = std::decay_t<decltype(field)>;
    const Field valid = field;
    std::vector<Field> bad;
    if constexpr (std::is_same_v<Field, double>) bad = {kNan, -1e30, 1e30, std::numeric_limits<double>::infinity()};
    if constexpr (std::is_same_v<Field, int>) {
      bad = {std::numeric_limits<int>::min()};
      if (key.rfind(".seed") != key.size() - 5) bad.push_back(std::numeric_limits<int>::max());
    }
    if constexpr (std::is_same_v<Field, std::string>) bad = {"", "nonsense"};
    if constexpr (std::is_same_v<Field, std::vector<double>>) {
      bad = {{}, {1.0, 2.0}, std::vector<double>(valid.size(), kNan), std::vector<double>(valid.size() + 1, 0.0)};
    }
    for (const Field& value : bad) {
      field = value;
      const std::string said = refusal(params);
      EXPECT_TRUE(startsWith(said, key + " = ") || startsWith(said, key + ": ")) << key << " is refused with: " << said;
    }
    field = valid;
  });
  EXPECT_EQ(refusal(params), kNoError);
}

TEST(PipelineParameters, OneOfTheIcpsMustBeUsed) {
  PipelineParameters params;
  params.profile.registration.use_corner_svd = params.profile.registration.use_icp_point_to_plane = false;
  EXPECT_EQ(refusal(params), kNoError);
  params.profile.registration.use_corner_svd = true;
  params.profile.registration.use_icp_point_to_point = false;
  EXPECT_TRUE(startsWith(refusal(params), "registration.use_icp_point_to_point = false")) << refusal(params);
}

TEST(PipelineParameters, AStructAloneNamesWhatItKnows) {
  RegistrationParameters registration;
  registration.icp_point_to_plane.observability.min_information_ratio = -1.0;
  try {
    validate(registration);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_TRUE(startsWith(error.what(), "icp_point_to_plane.observability.min_information_ratio = -1"))
        << error.what();
  }
}

TEST(PipelineParameters, ASweepBeginsWhereTheHeadsOwnZeroSays) {
  SensorParameters sensor;
  sensor.timing.start_azimuth_deg = -180.0;
  EXPECT_EQ(sensor.correctedTiming().start_azimuth_deg, -180.0);
  sensor.azimuth.angle_deg = -0.5;
  EXPECT_NEAR(sensor.correctedTiming().start_azimuth_deg, 179.5, 1e-12);
  sensor.timing.start_azimuth_deg = 360.0;
  sensor.azimuth.angle_deg = 10.0;
  EXPECT_NEAR(sensor.correctedTiming().start_azimuth_deg, 10.0, 1e-12);
  EXPECT_NO_THROW(validate(sensor.correctedTiming()));
}

TEST(PipelineParameters, TheLidarsAnglesAreRadians) {
  PipelineParameters params;
  params.sensor.lidar_in_base = {1.2, 0.0, 1.9, 0.0, 3.14159, -3.14159};
  EXPECT_EQ(refusal(params), kNoError);
  params.sensor.lidar_in_base[5] = 90.0;
  EXPECT_EQ(refusal(params), "sensor.lidar_in_base = 90: must be in [-3.15, 3.15] where it is an angle: rad, not deg");
  params.sensor.lidar_in_base = {0.0, -1730.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(startsWith(refusal(params), "sensor.lidar_in_base = -1730: must be in [-100, 100]")) << refusal(params);
}

TEST(PipelineParameters, PlacesInTheBaseFrame) {
  SensorParameters sensor;
  EXPECT_TRUE(sensor.T_base_lidar().isApprox(Pose::Identity()));
  sensor.lidar_in_base = {-0.6, 0.1, 1.73, 0.01, -0.02, 0.3};
  const Pose T_base_lidar = sensor.T_base_lidar();
  EXPECT_TRUE(T_base_lidar.translation().isApprox(Eigen::Vector3d(-0.6, 0.1, 1.73)));
  EXPECT_TRUE(T_base_lidar.linear().isApprox(rotationFromRpy(0.01, -0.02, 0.3)));

  VehicleFileParameters vehicle;
  EXPECT_TRUE(vehicle.T_base_cog().isApprox(Pose::Identity()));
  vehicle.cog_in_base = {0.265, -0.1, 0.543};
  const Pose T_base_cog = vehicle.T_base_cog();
  EXPECT_TRUE(T_base_cog.translation().isApprox(Eigen::Vector3d(0.265, -0.1, 0.543)));
  EXPECT_TRUE(T_base_cog.linear().isIdentity());
}

}  // namespace
}  // namespace fail_aware::pipeline_parameters_test
