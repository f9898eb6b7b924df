// The vehicle's constants (paper, section "Kinematic and Dynamic Vehicle Model", table of model parameters).
//
// Defaults: the paper's Volkswagen Passat B6. The paper does not give the cornering stiffnesses. These come from the
// open-source driver assistance openpilot for a saloon of this mass and axle positions (its `scale_tire_stiffness`:
// Honda Civic 192150 and 202500 N/rad per axle at 1462 kg, scaled by the axle's load), rounded to 1000 N/rad.
// cfg/vehicles/passat_b6.yaml explains each value.
#pragma once

#include "core/parameters/check.hpp"

namespace fail_aware {

inline constexpr double kGravity_mps2 = 9.81;

struct VehicleParameters {
  double mass_kg = 1750.0;                                ///< m
  double spring_front_n_per_m = 30800.0;                  ///< K_spring f
  double spring_rear_n_per_m = 28900.0;                   ///< K_spring r
  double damper_front_ns_per_m = 4500.0;                  ///< D_shock f
  double damper_rear_ns_per_m = 3500.0;                   ///< D_shock r
  double cog_above_roll_axis_m = 0.1;                     ///< d_roll
  double cog_above_pitch_axis_m = 0.25;                   ///< d_pitch
  double inertia_x_kg_m2 = 540.0;                         ///< I_x
  double inertia_y_kg_m2 = 2398.0;                        ///< I_y
  double inertia_z_kg_m2 = 2875.0;                        ///< I_z
  double cog_height_m = 0.543;                            ///< COG_z, above the ground at rest
  double cog_to_front_axle_m = 1.07;                      ///< l_f
  double cog_to_rear_axle_m = 1.6;                        ///< l_r
  double track_front_m = 1.5;                             ///< t_f
  double track_rear_m = 1.5;                              ///< t_r
  double cornering_stiffness_front_n_per_rad = 230000.0;  ///< C_f, both front tyres together
  double cornering_stiffness_rear_n_per_rad = 243000.0;   ///< C_r, both rear tyres together

  double wheelbase_m() const { return cog_to_front_axle_m + cog_to_rear_axle_m; }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("mass_kg", self.mass_kg, requirePositive);
    v("spring_front_n_per_m", self.spring_front_n_per_m, requirePositive);
    v("spring_rear_n_per_m", self.spring_rear_n_per_m, requirePositive);
    v("damper_front_ns_per_m", self.damper_front_ns_per_m, requireNotNegative);
    v("damper_rear_ns_per_m", self.damper_rear_ns_per_m, requireNotNegative);
    v("cog_above_roll_axis_m", self.cog_above_roll_axis_m, requireNotNegative);
    v("cog_above_pitch_axis_m", self.cog_above_pitch_axis_m, requireNotNegative);
    v("inertia_x_kg_m2", self.inertia_x_kg_m2, requirePositive);
    v("inertia_y_kg_m2", self.inertia_y_kg_m2, requirePositive);
    v("inertia_z_kg_m2", self.inertia_z_kg_m2, requirePositive);
    v("cog_height_m", self.cog_height_m, requirePositive);
    v("cog_to_front_axle_m", self.cog_to_front_axle_m, requirePositive);
    v("cog_to_rear_axle_m", self.cog_to_rear_axle_m, requirePositive);
    v("track_front_m", self.track_front_m, requirePositive);
    v("track_rear_m", self.track_rear_m, requirePositive);
    v("cornering_stiffness_front_n_per_rad", self.cornering_stiffness_front_n_per_rad, requirePositive);
    v("cornering_stiffness_rear_n_per_rad", self.cornering_stiffness_rear_n_per_rad, requirePositive);
  }
  void checkRules() const { requireParameter(mass_kg >= 50.0, "mass_kg", mass_kg, "at least 50: kg, not t"); }
};

}  // namespace fail_aware
