// The measurement of the vertical reference (vertical_reference.hpp; not in the paper): an upright profile as linear
// equations in the state. By beam b, the mean offset o_b along a horizontal direction m, at the height z_b; in odom,
// tilted by (d_x, d_y) against gravity,
//   o_b = const + z_b ((d_y + j_y) m_x - (d_x + j_x) m_y + e (m . away)) + g_b a_b + noise
//   g_b = m . (direction of sight)
// a_b is the error of the beam's ranges, e what the elevations of all beams have in common (it leans everything towards
// the sensor or away from it, on all sides; a tilt leans one side towards and the other away), j what a single estimate
// is off by. The constant is unknown and is eliminated. The less straight a profile is, the less its lean counts.
// Units: m, rad. Cost: some microseconds a profile.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/preprocessing/upright_profiles.hpp"

namespace fail_aware {

/// Index of each quantity in the state of the vertical reference.
struct VerticalState {
  static constexpr Eigen::Index kTilt = 0;               ///< d: x, y, of the newest estimate
  static constexpr Eigen::Index kStart = 2;              ///< d_0: x, y, of the first one
  static constexpr Eigen::Index kElevation = 4;          ///< e
  static constexpr Eigen::Index kDriftPerElevation = 5;  ///< q
  static constexpr Eigen::Index kOtherDrift = 6;         ///< o
  static constexpr Eigen::Index kJitter = 7;             ///< j: x, y
  static constexpr Eigen::Index kBeams = 9;              ///< from here on: a_b by ring
};

/// Equations A x = b of unit variance: one for the lean, the true lean of things included in its variance, and those
/// for the straightness. Columns of A: `of` in the state.
struct ProfileEquations {
  std::vector<Eigen::Index> of;
  Eigen::VectorXd lean;
  double lean_value;
  Eigen::MatrixXd straight;
  Eigen::VectorXd straight_values;

  /// beams: of all profiles; ranges: as corrected in them, by ring; P: the state's covariance.
  ProfileEquations(const UprightProfile& profile, const std::vector<UprightProfile::Beam>& beams,
                   const std::vector<BeamRange>& ranges, const Eigen::MatrixXd& P);

  Eigen::VectorXd pick(const Eigen::VectorXd& x) const;
  double leanVariance(const Eigen::MatrixXd& P) const;
};

}  // namespace fail_aware
