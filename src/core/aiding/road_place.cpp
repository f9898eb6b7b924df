#include "core/aiding/road_place.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.hpp"

namespace fail_aware {

namespace {

constexpr double kApart_m = 2.0;  // more than a wave of the profile
constexpr int kFewestSweepsBehind = 3;
constexpr double kLeastCorrelation = 0.15, kFewestCells = 100.0;
constexpr double kBeside_m = 0.75, kMostBeside = 0.7;  // a peak farther off than that, relative to the best one
constexpr double kStep_m = 0.1;                        // a quarter of the peak's width
constexpr double kMargin_m = 2.0;
constexpr double kNoiseFactor = 4.0, kLeastSigma_m = 0.05;

// The heights of the earlier profiles on a grid in the newest sweep's axes, linear along x between cells.
class RoadMap {
 public:
  explicit RoadMap(double cell_m)
      : cell_m_(cell_m),
        nx_(static_cast<int>(2.0 * (kRoadRange_m + kMargin_m) / cell_m) + 1),
        ny_(static_cast<int>(2.0 * (kRoadHalfWidth_m + cell_m) / cell_m) + 1),
        sums_(static_cast<std::size_t>(nx_ * ny_)),
        weights_(sums_) {}

  void add(const RoadProfile& profile) {
    const Eigen::Vector3d t = profile.T_newest_this.translation();
    const double yaw_rad = rpyFromRotation(profile.T_newest_this.linear()).z();
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    for (const RoadProfile::Cell& cell : profile.cells) {
      const double x = static_cast<double>(cell.x) + profile.faster_mps * static_cast<double>(cell.time_s);
      const double y = static_cast<double>(cell.y);
      const Node node = at(c * x - s * y + t.x(), s * x + c * y + t.y());
      if (!node.inside) continue;
      put(node.index, (1.0 - node.ahead) * static_cast<double>(cell.weight), cell.height);
      put(node.index + static_cast<std::size_t>(ny_), node.ahead * static_cast<double>(cell.weight), cell.height);
    }
  }

  struct Height {
    double mean = 0.0, weight = 0.0;  ///< weight 0: nothing is there
  };

  Height height(double x, double y) const {
    const Node node = at(x, y);
    if (!node.inside) return {};
    const std::size_t i = node.index, j = i + static_cast<std::size_t>(ny_);
    const double weight = (1.0 - node.ahead) * weights_[i] + node.ahead * weights_[j];
    if (weight <= 0.0) return {};
    return {((1.0 - node.ahead) * sums_[i] + node.ahead * sums_[j]) / weight, weight};
  }

 private:
  struct Node {
    bool inside;
    std::size_t index;
    double ahead;  ///< of the cell's centre, in cells
  };

  Node at(double x, double y) const {
    const double in_cells = (x + kRoadRange_m + kMargin_m) / cell_m_ - 0.5;
    const int ix = static_cast<int>(std::floor(in_cells));
    const int iy = static_cast<int>(std::floor((y + kRoadHalfWidth_m) / cell_m_ + 1.0));
    const bool inside = ix >= 0 && ix + 1 < nx_ && iy >= 0 && iy < ny_;
    return {inside, inside ? static_cast<std::size_t>(ix * ny_ + iy) : 0, in_cells - ix};
  }

  void put(std::size_t i, double weight, float height) {
    sums_[i] += weight * static_cast<double>(height);
    weights_[i] += weight;
  }

  double cell_m_;
  int nx_, ny_;
  std::vector<double> sums_, weights_;
};

struct Correlation {
  double value = 0.0, cells = 0.0;  ///< cells: effective number
};

// Both heights are uncertain, and the profile is low: a cell counts by the sum of the three variances.
Correlation correlate(const std::vector<RoadProfile::Cell>& cells, const RoadMap& map, double offset_m,
                      double profile_sigma_m) {
  double both = 0.0, here = 0.0, mapped = 0.0, sum = 0.0, sum_squares = 0.0;
  for (const RoadProfile::Cell& cell : cells) {
    const RoadMap::Height road = map.height(static_cast<double>(cell.x) + offset_m, static_cast<double>(cell.y));
    if (road.weight <= 0.0) continue;
    const double height = static_cast<double>(cell.height);
    const double variance = 1.0 / static_cast<double>(cell.weight) + 1.0 / road.weight;
    const double w = 1.0 / (variance + profile_sigma_m * profile_sigma_m);
    both += w * height * road.mean;
    here += w * height * height;
    mapped += w * road.mean * road.mean;
    sum += w;
    sum_squares += w * w;
  }
  if (!(here > 0.0) || !(mapped > 0.0)) return {};
  return {both / std::sqrt(here * mapped), sum * sum / sum_squares};
}

}  // namespace

std::optional<RoadPlace> findRoadPlace(const std::vector<RoadProfile>& profiles, double cell_m, double profile_sigma_m,
                                       double max_offset_m) {
  RoadMap map(cell_m);
  int behind = 0;
  for (const RoadProfile& profile : profiles) {
    if (std::abs(profile.T_newest_this.translation().x()) < kApart_m) continue;
    map.add(profile);
    ++behind;
  }
  if (behind < kFewestSweepsBehind) return std::nullopt;
  const int steps = static_cast<int>(std::ceil(max_offset_m / kStep_m));
  std::vector<Correlation> found;
  for (int i = -steps; i <= steps; ++i) {
    found.push_back(correlate(profiles.back().cells, map, i * kStep_m, profile_sigma_m));
  }
  const auto best = std::max_element(found.begin(), found.end(),
                                     [](const Correlation& a, const Correlation& b) { return a.value < b.value; });
  if (best == found.begin() || best + 1 == found.end()) return std::nullopt;
  if (best->value < kLeastCorrelation || best->cells < kFewestCells) return std::nullopt;
  for (auto other = found.begin(); other != found.end(); ++other) {
    const double beside_m = std::abs(static_cast<double>(other - best)) * kStep_m;
    if (beside_m > kBeside_m && other->value > kMostBeside * best->value) return std::nullopt;
  }
  const double left = (best - 1)->value, here = best->value, right = (best + 1)->value;
  const double curvature = (2.0 * here - left - right) / (kStep_m * kStep_m);
  if (!(curvature > 0.0)) return std::nullopt;
  const double aside_m = 0.5 * (right - left) / (curvature * kStep_m);  // of a parabola through the three
  RoadPlace place;
  place.offset_m =
      (static_cast<double>(best - found.begin()) - steps) * kStep_m + std::clamp(aside_m, -kStep_m, kStep_m);
  place.sigma_m =
      std::hypot(kLeastSigma_m, kNoiseFactor * std::sqrt((1.0 - here * here) / (here * best->cells * curvature)));
  place.correlation = here;
  return place;
}

}  // namespace fail_aware
