// FAIL_AWARE_SOURCE_CFG is the package's cfg folder (compile definition).
#include "core/io/profile_files.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/io/input_error.hpp"
#include "core/parameters/yaml_parameters.hpp"

namespace fail_aware::profile_files_test {
namespace {

namespace fs = std::filesystem;

const fs::path kCfg = FAIL_AWARE_SOURCE_CFG;

std::vector<std::string> stemsIn(const fs::path& folder) {
  std::vector<std::string> stems;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") stems.push_back(entry.path().stem().string());
  }
  return stems;
}

void expectHas(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' not in: " << text;
}

/// Works on a copy of the package's cfg folder.
class ProfileFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    cfg_ = fs::path(::testing::TempDir()) / ("profile_files_" + name + "_" + std::to_string(getpid()));
    fs::remove_all(cfg_);
    fs::copy(kCfg, cfg_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(cfg_); }

  /// Replaces the line that begins with `key` (as it is indented there) by `replacement`, or removes it.
  void replaceLine(const std::string& file, const std::string& key, const std::string& replacement) const {
    std::ifstream in(cfg_ / file);
    std::string text;
    int replaced = 0;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind(key, 0) == 0) {
        ++replaced;
        if (!replacement.empty()) text += replacement + '\n';
      } else {
        text += line + '\n';
      }
    }
    ASSERT_EQ(replaced, 1) << file << ": " << key;
    std::ofstream(cfg_ / file) << text;
  }

  std::string refusal(ProfileFiles files = {}) const {
    if (files.cfg.empty()) files.cfg = cfg_.string();
    std::string said;
    try {
      loadPipelineParameters(files);
    } catch (const InputError& error) {
      said = error.what();
    } catch (const ParameterError& error) {
      said = error.what();
    }
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    return said;
  }

  fs::path cfg_;
};

TEST_F(ProfileFilesTest, EveryFileOfThePackageLoads) {
  const std::vector<std::string> profiles = stemsIn(kCfg / "profiles"), vehicles = stemsIn(kCfg / "vehicles"),
                                 sensors = stemsIn(kCfg / "sensors");
  for (const char* needed : {"default", "paper"}) {
    EXPECT_EQ(std::count(profiles.begin(), profiles.end(), needed), 1) << needed;
  }
  for (const char* needed : {"hdl64e", "velodyne", "ouster", "hesai"}) {
    EXPECT_EQ(std::count(sensors.begin(), sensors.end(), needed), 1) << needed;
  }
  ASSERT_FALSE(vehicles.empty());
  for (const std::string& profile : profiles) EXPECT_EQ(refusal({kCfg.string(), profile, "passat_b6", "hdl64e"}), "");
  for (const std::string& vehicle : vehicles) EXPECT_EQ(refusal({kCfg.string(), "default", vehicle, "hdl64e"}), "");
  for (const std::string& sensor : sensors) EXPECT_EQ(refusal({kCfg.string(), "default", "passat_b6", sensor}), "");
}

ProfileParameters paperProfile() {
  return loadPipelineParameters({kCfg.string(), "paper", "passat_b6", "hdl64e"}).profile;
}

TEST_F(ProfileFilesTest, ThePaperProfileIsTheArticle) {
  const ProfileParameters paper = paperProfile();
  EXPECT_TRUE(paper.model.literal);
  EXPECT_TRUE(paper.model.six_dof);
  EXPECT_TRUE(paper.history.second_differences);
  EXPECT_TRUE(paper.fusion.literal);
  EXPECT_EQ(paper.registration.reference.sweeps, 1) << "consecutive sweeps";
  EXPECT_EQ(paper.registration.icp_point_to_point.seeds, 8);
  EXPECT_TRUE(paper.registration.icp_point_to_plane.filter_normals);
  EXPECT_TRUE(paper.sweep_correction.enabled);
  EXPECT_TRUE(paper.registration.use_icp_point_to_point && paper.registration.use_icp_point_to_plane &&
              paper.registration.use_corner_svd);
  EXPECT_EQ(paper.monitor.indicator.threshold, 0.001);
}

TEST_F(ProfileFilesTest, PaperProfileOmitsOwnParts) {
  const ProfileParameters paper = paperProfile();
  const std::vector<std::string> on = {"sweep_correction.enabled",                     // the article's
                                       "registration.relocalization.search.enabled"};  // of a part that is off
  const std::string ending = ".enabled";
  std::size_t switches = 0;
  for (const auto& [key, value] : toList(paper)) {
    if (key.size() < ending.size() || key.substr(key.size() - ending.size()) != ending) continue;
    ++switches;
    EXPECT_EQ(std::get<bool>(value), std::count(on.begin(), on.end(), key) == 1) << key;
  }
  EXPECT_GT(switches, on.size());
}

TEST_F(ProfileFilesTest, ThreeFilesMakeOneSetOfParameters) {
  replaceLine("profiles/default.yaml", "  gate_sigma:", "  gate_sigma: 2.5");
  replaceLine("vehicles/passat_b6.yaml", "  mass_kg:", "  mass_kg: 1800.0");
  replaceLine("sensors/hdl64e.yaml", "lidar_in_base:", "lidar_in_base: [1.0, 2.0, 3.0, 0.0, 0.0, 0.5]");
  const PipelineParameters params = loadPipelineParameters({cfg_.string(), "default", "passat_b6", "hdl64e"});
  EXPECT_EQ(params.profile.fusion.gate_sigma, 2.5);
  EXPECT_EQ(params.vehicle.dynamics.mass_kg, 1800.0);
  EXPECT_TRUE(params.sensor.T_base_lidar().translation().isApprox(Eigen::Vector3d(1.0, 2.0, 3.0)));
}

TEST_F(ProfileFilesTest, AProfileIsLayers) {
  replaceLine("profiles/default.yaml", "  gate_sigma:", "  gate_sigma: 2.5");
  replaceLine("profiles/expert.yaml", "  min_weight:", "  min_weight: 0.02");
  std::ofstream(cfg_ / "mine.yaml") << "fusion:\n  literal: true\n  min_weight: 0.03\n";
  const auto fusion = [&](const std::string& profile) {
    return loadPipelineParameters({cfg_.string(), profile, "passat_b6", "hdl64e"}).profile.fusion;
  };
  EXPECT_EQ(fusion("default").gate_sigma, 2.5);
  EXPECT_EQ(fusion("default").min_weight, 0.02);
  const MeasurementFusion mine = fusion((cfg_ / "mine.yaml").string());
  EXPECT_TRUE(mine.literal);
  EXPECT_EQ(mine.gate_sigma, 2.5);
  EXPECT_EQ(mine.min_weight, 0.03);
}

TEST_F(ProfileFilesTest, AnUnknownKeyIsNamedWithItsPlace) {
  replaceLine("profiles/default.yaml", "fusion:", "fusion:\n  gate_sigmas: 3.0");
  const std::string said = refusal();
  expectHas(said, "fusion.gate_sigmas: unknown parameter, did you mean fusion.gate_sigma?");
  expectHas(said, (cfg_ / "profiles" / "default.yaml").string() + ":");

  replaceLine("profiles/default.yaml", "  gate_sigmas:", "");
  std::ofstream(cfg_ / "sensors" / "hdl64e.yaml", std::ios::app) << "rings: 64\n";
  expectHas(refusal({"", "paper", "passat_b6", "hdl64e"}), "rings: unknown parameter");
}

TEST_F(ProfileFilesTest, AMissingKeyOfVehicleOrSensorIsNamed) {
  replaceLine("vehicles/passat_b6.yaml", "cog_in_base:", "");
  expectHas(refusal(), "cog_in_base: missing");
  replaceLine("sensors/hdl64e.yaml", "  clockwise:", "");
  fs::copy_file(kCfg / "vehicles" / "passat_b6.yaml", cfg_ / "vehicles" / "other.yaml");
  expectHas(refusal({"", "default", "other", "hdl64e"}), "timing.clockwise: missing");
}

TEST_F(ProfileFilesTest, AFileOfAnotherKindIsNamed) {
  const std::string sensor = (kCfg / "sensors" / "velodyne.yaml").string();
  const std::string vehicle = (kCfg / "vehicles" / "passat_b6.yaml").string();
  const auto error = [this](const std::string& of_profile, const std::string& of_vehicle,
                            const std::string& of_sensor) {
    return refusal({"", of_profile, of_vehicle, of_sensor});
  };
  EXPECT_EQ(error("default", sensor, "hdl64e"),
            sensor + ": is the file of a sensor: give it as sensor, not as vehicle");
  EXPECT_EQ(error("default", "passat_b6", vehicle),
            vehicle + ": is the file of a vehicle: give it as vehicle, not as sensor");
  EXPECT_EQ(error(sensor, "passat_b6", "hdl64e"),
            sensor + ": is the file of a sensor: give it as sensor, not as profile");
  PipelineParameters params = loadPipelineParameters({});
  EXPECT_THROW(overrideParameters(params, {vehicle}, {}), InputError) << "not as parameters either";
}

TEST_F(ProfileFilesTest, AFileWithoutParametersOverridesNothingAndIsRefused) {
  const std::string empty = (cfg_ / "empty.yaml").string();
  std::ofstream(empty) << "# fusion: {gate_sigma: 2.5}\n";
  PipelineParameters params = loadPipelineParameters({});
  EXPECT_THROW(overrideParameters(params, {empty}, {}), ParameterError);
}

TEST_F(ProfileFilesTest, AValueThatCannotBeIsNamedInFull) {
  replaceLine("profiles/default.yaml", "  gate_sigma:", "  gate_sigma: -3.0");
  expectHas(refusal(), "fusion.gate_sigma = -3");
  replaceLine("profiles/default.yaml", "  gate_sigma:", "  gate_sigma: wide");
  expectHas(refusal(), "fusion.gate_sigma: must be a number");
  replaceLine("profiles/default.yaml", "  gate_sigma:", "  gate_sigma: 3.0");
  replaceLine("vehicles/passat_b6.yaml", "  mass_kg:", "  mass_kg: 0.0");
  expectHas(refusal(), "vehicle.dynamics.mass_kg = 0");
}

TEST_F(ProfileFilesTest, AnUnknownNameListsWhatThereIs) {
  std::string said = refusal({"", "papre", "passat_b6", "hdl64e"});
  expectHas(said, "papre");
  expectHas(said, "default, paper");
  said = refusal({"", "default", "golf", "hdl64e"});
  expectHas(said, "no vehicle golf");
  expectHas(said, "passat_b6");
  said = refusal({"", "default", "passat_b6", "vlp"});
  expectHas(said, "no sensor vlp");
  expectHas(said, "hdl64e");
  expectHas(refusal({"", "", "passat_b6", "hdl64e"}), "default, paper");
  expectHas(refusal({"", "/no/such/profile.yaml", "passat_b6", "hdl64e"}), "/no/such/profile.yaml");
  expectHas(refusal({"", std::string(300, 'x'), "passat_b6", "hdl64e"}), "default, paper");
}

TEST_F(ProfileFilesTest, ANameMayBeAPath) {
  const fs::path mine = cfg_ / "mine.yaml";
  std::ofstream(mine) << "fusion:\n  gate_sigma: 2.5\n";
  EXPECT_EQ(refusal({"", mine.string(), "passat_b6", "hdl64e"}), "");
  std::ofstream(mine, std::ios::app) << "more: 1\n";
  expectHas(refusal({"", mine.string(), "passat_b6", "hdl64e"}), "more: unknown parameter");
  expectHas(refusal({"", cfg_.string(), "passat_b6", "hdl64e"}), cfg_.string());  // a folder is no file
}

TEST_F(ProfileFilesTest, TheCfgFolderMustBeOne) {
  expectHas(refusal({"/no/such/folder", "default", "passat_b6", "hdl64e"}), "/no/such/folder");
  expectHas(refusal({(cfg_ / "sensors").string(), "default", "passat_b6", "hdl64e"}), "profiles/");
}

TEST_F(ProfileFilesTest, TheProgramFindsTheFolder) {
  EXPECT_TRUE(fs::equivalent(findCfg(), kCfg));
  EXPECT_EQ(toList(loadPipelineParameters(ProfileFiles())),
            toList(loadPipelineParameters({kCfg.string(), "default", "passat_b6", "hdl64e"})));
}

}  // namespace
}  // namespace fail_aware::profile_files_test
