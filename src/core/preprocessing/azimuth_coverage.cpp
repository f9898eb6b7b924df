#include "core/preprocessing/azimuth_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fail_aware {

namespace {

constexpr std::size_t kSectors = 72;
constexpr int kMinPointsInSector = 3;

std::size_t sectorOf(const Eigen::Vector3f& p) {
  const float turns = (std::atan2(p.y(), p.x()) + static_cast<float>(M_PI)) / static_cast<float>(2.0 * M_PI);
  return std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0f, turns) * kSectors));
}

}  // namespace

double azimuthCoverage(const std::vector<Eigen::Vector3f>& points, std::size_t stride) {
  std::array<int, kSectors> counts{};
  for (std::size_t i = 0; i < points.size(); i += stride) ++counts[sectorOf(points[i])];
  const auto seen = std::count_if(counts.begin(), counts.end(), [](int n) { return n >= kMinPointsInSector; });
  return static_cast<double>(seen) / kSectors;
}

}  // namespace fail_aware
