// How much the leans of upright profiles count in a look of the vertical reference (vertical_reference.hpp; not in the
// paper). Walls and poles stand upright and agree with each other. Hedges, banks and the sides of cars do not: what is
// seen of them leans away from the sensor, often on all sides alike, which looks like an error of the beams'
// elevations. They end below a sensor on the roof, where walls, lorries and trunks pass it.
//
// So surfaces that end below the sensor, other surfaces, and trunks and poles are judged apart: where the residuals of
// one kind have no peak, or few of them are near it, the variances of that kind grow, and the others count as before.
// Cost: some microseconds.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/preprocessing/profile_equations.hpp"
#include "core/preprocessing/upright_profiles.hpp"

namespace fail_aware {

struct LeanWeights {
  std::vector<double> kernel;  ///< of a profile's straightness: by its lean's residual
  std::vector<double> lean;    ///< of its lean: the same over what the variances of its kind grow by
};

/// Weights of the `profiles` (not empty) and their `equations` at the state x. P_predicted: the covariance of x, where
/// x is a prediction that the profiles have not corrected yet; it widens the kernel, and surfaces that end below the
/// sensor do not count then if there are others. nullptr: x is what the profiles say.
LeanWeights leanWeights(const std::vector<UprightProfile>& profiles, const std::vector<ProfileEquations>& equations,
                        const Eigen::VectorXd& x, const Eigen::MatrixXd* P_predicted);

}  // namespace fail_aware
