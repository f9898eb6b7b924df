#include "core/geometry/matrix6.hpp"

#include <Eigen/Dense>

namespace fail_aware {

Matrix6d inverseOf(const Matrix6d& A) { return A.inverse(); }

Vector6d solutionOf(const Matrix6d& H, const Vector6d& b) { return H.ldlt().solve(b); }

Matrix6d solutionOf(const Matrix6d& H, const Matrix6d& B) { return H.ldlt().solve(B); }

}  // namespace fail_aware
