#include "core/registration/information_support.hpp"

#include <algorithm>
#include <vector>

#include "core/geometry/decompositions.hpp"

namespace fail_aware {

void InformationSupport::add(const Eigen::Vector3d& position_m, double information, double by_chance) {
  Place& place =
      places_[packVoxel(fastFloor(position_m.x() / params_.cell_m), fastFloor(position_m.y() / params_.cell_m), 0)];
  place.information += information;
  place.by_chance += by_chance;
}

double InformationSupport::countedRatio() const {
  std::vector<double> sums;
  double total = 0.0, rest = 0.0;
  for (const auto& [key, place] : places_) {
    sums.push_back(std::max(0.0, place.information - place.by_chance));
    total += place.information;
    rest += sums.back();
  }
  if (!(total > 0.0)) return 0.0;
  std::sort(sums.begin(), sums.end(), std::greater<double>());
  // if the k largest are at the limit c and the rest counts fully: counted = k c + rest, c = max_place_ratio * counted
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const double free = 1.0 - static_cast<double>(k) * params_.max_place_ratio;
    if (free <= 0.0) return 0.0;  // too few places
    const double counted = rest / free;
    if (sums[k] <= params_.max_place_ratio * counted) return std::min(1.0, counted / total);
    rest -= sums[k];
  }
  return 0.0;
}

std::optional<Eigen::Vector2d> weakDirection(const Eigen::Matrix2d& information, double weight, double below_ratio) {
  const Eigen::Vector2d weakest = symmetricEigen(information).eigenvectors().col(0);
  if (!(weakest.dot(information * weakest) < below_ratio * weight)) return std::nullopt;
  return weakest;
}

}  // namespace fail_aware
