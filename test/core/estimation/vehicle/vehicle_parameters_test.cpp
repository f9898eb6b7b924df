#include "core/estimation/vehicle/vehicle_parameters.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "../../parameters/error_of.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::vehicle_parameters_test {
namespace {

TEST(VehicleParameters, DefaultsAreValid) { EXPECT_NO_THROW(validate(VehicleParameters())); }

TEST(VehicleParameters, DefaultsAreTheArticlesTable) {
  const VehicleParameters v;
  EXPECT_EQ(v.mass_kg, 1750.0);
  EXPECT_EQ(v.spring_front_n_per_m, 30800.0);
  EXPECT_EQ(v.spring_rear_n_per_m, 28900.0);
  EXPECT_EQ(v.damper_front_ns_per_m, 4500.0);
  EXPECT_EQ(v.damper_rear_ns_per_m, 3500.0);
  EXPECT_EQ(v.cog_above_roll_axis_m, 0.1);
  EXPECT_EQ(v.cog_above_pitch_axis_m, 0.25);
  EXPECT_EQ(v.inertia_x_kg_m2, 540.0);
  EXPECT_EQ(v.inertia_y_kg_m2, 2398.0);
  EXPECT_EQ(v.inertia_z_kg_m2, 2875.0);
  EXPECT_EQ(v.cog_height_m, 0.543);
  EXPECT_EQ(v.cog_to_front_axle_m, 1.07);
  EXPECT_EQ(v.cog_to_rear_axle_m, 1.6);
  EXPECT_EQ(v.track_front_m, 1.5);
  EXPECT_EQ(v.track_rear_m, 1.5);
}

TEST(VehicleParameters, EveryFieldIsCheckedAndNamed) {
  VehicleParameters vehicle;
  int fields = 0;
  VehicleParameters::visit(vehicle, [&](const char* name, double& value, const auto&...) {
    ++fields;
    const double good = value;
    for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      value = bad;
      try {
        validate(vehicle);
        ADD_FAILURE() << name << " = " << bad << " was accepted";
      } catch (const ParameterError& error) {
        EXPECT_EQ(std::string(error.what()).rfind(name, 0), 0u) << error.what();
      }
    }
    value = good;
  });
  EXPECT_EQ(fields, 17);
}

TEST(VehicleParameters, OnlyDampersAndLeverArmsMayBeZero) {
  VehicleParameters vehicle;
  vehicle.damper_front_ns_per_m = vehicle.damper_rear_ns_per_m = 0.0;
  vehicle.cog_above_roll_axis_m = vehicle.cog_above_pitch_axis_m = 0.0;
  EXPECT_NO_THROW(validate(vehicle));
  vehicle.cornering_stiffness_rear_n_per_rad = 0.0;
  EXPECT_THROW(validate(vehicle), ParameterError);
}

TEST(VehicleParameters, AMassInTonnesIsRefused) {
  VehicleParameters vehicle;
  vehicle.mass_kg = 50.0;
  EXPECT_EQ(errorOf([&] { validate(vehicle); }), kNoError);
  vehicle.mass_kg = 1.75;
  EXPECT_EQ(errorOf([&] { validate(vehicle); }), "mass_kg = 1.75: must be at least 50: kg, not t");
}

}  // namespace
}  // namespace fail_aware::vehicle_parameters_test
