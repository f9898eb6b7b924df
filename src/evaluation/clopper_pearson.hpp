// The exact confidence interval of a proportion (Clopper and Pearson, Biometrika 26, 1934): `part` of `whole`
// independent trials succeeded. Low bound p: P(X >= part | p) = (1 - level) / 2; high bound p: P(X <= part | p) = (1 -
// level) / 2.
//
// Failure: nothing without trials. Cost: O(whole) for each of 60 bisections.
#pragma once

#include <cstddef>
#include <optional>

#include "evaluation/concordance.hpp"

namespace fail_aware {

/// part <= whole; level in (0, 1).
std::optional<Interval> clopperPearson(std::size_t part, std::size_t whole, double level = 0.95);

}  // namespace fail_aware
