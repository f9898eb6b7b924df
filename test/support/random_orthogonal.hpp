#pragma once

#include <random>

#include "core/geometry/pose.hpp"

namespace fail_aware {

/// An orthogonal matrix, any direction as likely.
Matrix6d randomOrthogonal(std::mt19937& random);

}  // namespace fail_aware
