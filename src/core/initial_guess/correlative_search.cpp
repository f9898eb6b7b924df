#include "core/initial_guess/correlative_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/degree.hpp"
#include "core/map/above_ground_points.hpp"

namespace fail_aware {

namespace {

constexpr double kCell_m = 0.5;
constexpr int kCoarse = 2;              // cells of the fine grid per cell of the coarse grid, per axis
constexpr std::size_t kEnough = 600;    // above-ground points of the sweep
constexpr std::size_t kMinPlaces = 20;  // fewer cells do not define a pose
constexpr std::size_t kRefined = 8;     // coarse candidates that are refined,
constexpr int kRefineSteps = 2;         // by this many steps to each side,
constexpr double kRefineStep = 0.25;    // each this part of a coarse step
constexpr double kSigmas = 3.0;         // search range in sigma of the prediction,
constexpr double kMinReach_m = 1.0;     // and the least search range
constexpr double kMinReach_rad = 2.0 * kDegree;
constexpr double kPriorRatio = 0.02;  // cost per unit of the squared Mahalanobis distance from the prediction

// Cells of the horizontal plane around the predicted position: whether the map saw the cell, whether it holds
// above-ground points.
struct PlanGrid {
  double cell_m;
  int size;  // cells along a side
  std::vector<std::uint8_t> cells;

  PlanGrid(double half_m, double side_m) : cell_m(side_m), size(2 * static_cast<int>(std::ceil(half_m / side_m))) {
    cells.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 0);
  }

  int index(double x_m, double y_m) const {
    const int ix = static_cast<int>(std::floor(x_m / cell_m)) + size / 2;
    const int iy = static_cast<int>(std::floor(y_m / cell_m)) + size / 2;
    return ix < 0 || iy < 0 || ix >= size || iy >= size ? -1 : iy * size + ix;
  }
  std::uint8_t at(double x_m, double y_m) const {
    const int i = index(x_m, y_m);
    return i < 0 ? 0 : cells[static_cast<std::size_t>(i)];
  }
};

constexpr std::uint8_t kSeen = 1, kNear = 3, kStands = 5;  // bit 0: seen; value / 2: quality of the fit, 0..2

void raise(PlanGrid& grid, int x, int y, std::uint8_t value) {
  if (x < 0 || y < 0 || x >= grid.size || y >= grid.size) return;
  std::uint8_t& cell = grid.cells[static_cast<std::size_t>(y * grid.size + x)];
  cell = std::max(cell, value);
}

PlanGrid gridOf(const VoxelMap& map, const Eigen::Vector3d& centre_odom, double half_m) {
  AboveGroundPointsParams above_ground;
  PlanGrid grid(half_m, kCell_m);
  std::vector<float> lowest(grid.cells.size(), 1e9f), highest(grid.cells.size(), -1e9f);
  for (const Eigen::Vector3d& p : map.points()) {
    const Eigen::Vector3d d = p - centre_odom;
    const int i = grid.index(d.x(), d.y());
    if (i < 0) continue;
    const auto cell = static_cast<std::size_t>(i);
    lowest[cell] = std::min(lowest[cell], static_cast<float>(d.z()));
    highest[cell] = std::max(highest[cell], static_cast<float>(d.z()));
  }
  for (int y = 0; y < grid.size; ++y) {
    for (int x = 0; x < grid.size; ++x) {
      const auto cell = static_cast<std::size_t>(y * grid.size + x);
      if (lowest[cell] > highest[cell]) continue;
      const bool stands = static_cast<double>(highest[cell] - lowest[cell]) >= above_ground.min_height_m;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) raise(grid, x + dx, y + dy, stands ? kNear : kSeen);
      }
      if (stands) raise(grid, x, y, kStands);
    }
  }
  return grid;
}

PlanGrid coarser(const PlanGrid& fine) {
  PlanGrid coarse(0.5 * fine.size * fine.cell_m, fine.cell_m * kCoarse);
  for (int y = 0; y < fine.size; ++y) {
    for (int x = 0; x < fine.size; ++x) {
      raise(coarse, x / kCoarse, y / kCoarse, fine.cells[static_cast<std::size_t>(y * fine.size + x)]);
    }
  }
  return coarse;
}

struct Candidate {
  double turn_rad = 0.0;
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  double ratio = 0.0, value = 0.0;
};

// Ratio of above-ground points that fit; 0..1.
double ratioOf(const std::vector<Eigen::Vector2d>& points, const PlanGrid& grid, const Eigen::Vector2d& shift_m) {
  int fits = 0, seen = 0;
  for (const Eigen::Vector2d& p : points) {
    const std::uint8_t cell = grid.at(p.x() + shift_m.x(), p.y() + shift_m.y());
    seen += cell & 1;
    fits += cell >> 1;
  }
  // a point where the map is unseen counts half: it may be valid, for instance behind a wall
  return static_cast<double>(fits) / (seen + static_cast<int>(points.size()));
}

std::vector<Eigen::Vector2d> turned(const std::vector<Eigen::Vector2d>& points, double turn_rad) {
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
  std::vector<Eigen::Vector2d> result;
  result.reserve(points.size());
  for (const Eigen::Vector2d& p : points) result.push_back(R * p);
  return result;
}

// Score of a candidate: its ratio of fitting points minus its cost relative to the prediction.
class Judge {
 public:
  /// Covariance of the predicted state.
  explicit Judge(const Matrix6d& covariance)
      : sigma_m_(std::sqrt(covariance.topLeftCorner<2, 2>().trace())),
        sigma_rad_(std::sqrt(covariance(5, 5))),
        information_(covariance.topLeftCorner<2, 2>().inverse()) {}
  double reachM(double most) const { return std::min(most, std::max(kMinReach_m, kSigmas * sigma_m_)); }
  double reachRad(double most) const { return std::min(most, std::max(kMinReach_rad, kSigmas * sigma_rad_)); }
  double value(const Candidate& c) const {
    const double turn = c.turn_rad / sigma_rad_;
    return c.ratio - kPriorRatio * (c.shift_m.dot(information_ * c.shift_m) + turn * turn);
  }

 private:
  double sigma_m_, sigma_rad_;
  Eigen::Matrix2d information_;
};

void tryAround(const Candidate& centre, double step_m, double step_rad, int shifts, int turns,
               const std::vector<Eigen::Vector2d>& points, const PlanGrid& grid, const Judge& judge,
               std::vector<Candidate>& tried) {
  for (int turn = -turns; turn <= turns; ++turn) {
    Candidate candidate = centre;
    candidate.turn_rad += turn * step_rad;
    const std::vector<Eigen::Vector2d> of = turned(points, candidate.turn_rad);
    for (int y = -shifts; y <= shifts; ++y) {
      for (int x = -shifts; x <= shifts; ++x) {
        candidate.shift_m = centre.shift_m + step_m * Eigen::Vector2d(x, y);
        candidate.ratio = ratioOf(of, grid, candidate.shift_m);
        candidate.value = judge.value(candidate);
        tried.push_back(candidate);
      }
    }
  }
}

// Horizontal positions along odom's axes; empty if they are too few for a search.
std::vector<Eigen::Vector2d> aboveGroundPoints(const std::vector<Eigen::Vector3f>& points_cog,
                                               const Eigen::Matrix3d& R_odom_cog, double range_m) {
  std::vector<Eigen::Vector3f> level;
  level.reserve(points_cog.size());
  const Eigen::Matrix3f R = R_odom_cog.cast<float>();
  for (const Eigen::Vector3f& p : points_cog) {
    if (p.norm() <= static_cast<float>(range_m)) level.push_back(R * p);
  }
  const AboveGroundPoints above_ground = findAboveGroundPoints(level, AboveGroundPointsParams(), kEnough);
  std::vector<Eigen::Vector2d> points;
  if (above_ground.places < kMinPlaces) return points;
  points.reserve(above_ground.points.size());
  for (const AboveGroundPoint& point : above_ground.points) points.push_back(point.position.head<2>());
  return points;
}

}  // namespace

bool findByCorrelation(const CorrelativeSearchParams& params, const std::vector<Eigen::Vector3f>& points_cog,
                       const VoxelMap& map, const Pose& T_odom_cog_predicted, const Matrix6d& covariance,
                       std::optional<Pose>& T_odom_cog) {
  T_odom_cog.reset();
  const std::vector<Eigen::Vector2d> points =
      aboveGroundPoints(points_cog, T_odom_cog_predicted.linear(), params.range_m);
  if (points.empty()) return false;
  const PlanGrid fine = gridOf(map, T_odom_cog_predicted.translation(), params.range_m + params.max_shift_m);
  const PlanGrid coarse = coarser(fine);
  const Judge judge(covariance);
  const double step_m = coarse.cell_m, step_rad = step_m / (0.5 * params.range_m);
  const int turns = static_cast<int>(std::ceil(judge.reachRad(params.max_turn_deg * kDegree) / step_rad));
  const int shifts = static_cast<int>(std::ceil(judge.reachM(params.max_shift_m) / step_m));
  std::vector<Candidate> candidates;
  tryAround({}, step_m, step_rad, shifts, turns, points, coarse, judge, candidates);
  const auto better = [](const Candidate& a, const Candidate& b) { return a.value > b.value; };
  const auto kept = static_cast<std::ptrdiff_t>(std::min(kRefined, candidates.size()));
  std::partial_sort(candidates.begin(), candidates.begin() + kept, candidates.end(), better);
  candidates.resize(static_cast<std::size_t>(kept));
  std::vector<Candidate> refined;
  for (const Candidate& candidate : candidates) {
    tryAround(candidate, kRefineStep * step_m, kRefineStep * step_rad, kRefineSteps, kRefineSteps, points, fine, judge,
              refined);
  }
  // the first of the best, so that the choice among equal ones does not depend on the library
  const Candidate& best = *std::min_element(refined.begin(), refined.end(), better);
  if (best.ratio < params.min_ratio) return true;
  T_odom_cog = T_odom_cog_predicted;
  T_odom_cog->translation().head<2>() += best.shift_m;
  T_odom_cog->linear() =
      Eigen::AngleAxisd(best.turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() * T_odom_cog_predicted.linear();
  return true;
}

}  // namespace fail_aware
