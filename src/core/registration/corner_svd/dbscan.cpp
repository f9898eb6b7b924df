#include "core/registration/corner_svd/dbscan.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace fail_aware {

namespace {

constexpr int kNoise = -1;
constexpr double kCellRatioOfEps = 0.7071;  // just under 1 / sqrt(2): a cell's diagonal is below eps
constexpr int kReach = 2;                   // in cells; farther cells hold no neighbours
constexpr double kMaxCoordinateInEps = 1e8;

using Place = std::pair<int, int>;  // row, column

struct Point {
  Place place;
  std::size_t index;  // in the input
  double x, y;
  int weight;
};

// The points of an occupied cell, the core points first; all are mutual neighbours, so its core points share a label.
struct Cell {
  Place place;
  Point *begin, *cores_end, *end;
  long long weight = 0;
  int label = kNoise;
  std::vector<Cell*> around{};  // the occupied cells in reach, without this one
};

double squaredDistance(const Point& a, const Point& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

// By cell, without points that are not finite or too far away.
std::vector<Point> sortedPoints(const std::vector<Eigen::Vector2f>& points_xy, double eps_m,
                                const std::vector<int>& weights) {
  const double inverse_cell = 1.0 / (kCellRatioOfEps * eps_m), limit = kMaxCoordinateInEps * eps_m;
  std::vector<Point> points;
  points.reserve(points_xy.size());
  for (std::size_t i = 0; i < points_xy.size(); ++i) {
    const double x = static_cast<double>(points_xy[i].x()), y = static_cast<double>(points_xy[i].y());
    if (!(std::abs(x) < limit && std::abs(y) < limit)) continue;
    const Place place(static_cast<int>(std::floor(y * inverse_cell)), static_cast<int>(std::floor(x * inverse_cell)));
    points.push_back({place, i, x, y, weights.empty() ? 1 : weights[i]});
  }
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.place < b.place; });
  return points;
}

std::vector<Cell> cellsOf(std::vector<Point>& points) {
  std::vector<Cell> cells;
  for (Point& point : points) {
    if (cells.empty() || cells.back().place != point.place) cells.push_back({point.place, &point, &point, &point});
    ++cells.back().end;
    cells.back().weight += point.weight;
  }
  const auto before = [](const Cell& cell, const Place& place) { return cell.place < place; };
  for (Cell& cell : cells) {
    const auto [row, column] = cell.place;
    for (int r = row - kReach; r <= row + kReach; ++r) {
      auto other = std::lower_bound(cells.begin(), cells.end(), Place(r, column - kReach), before);
      for (; other != cells.end() && other->place <= Place(r, column + kReach); ++other) {
        if (&*other != &cell) cell.around.push_back(&*other);
      }
    }
  }
  return cells;
}

void findCores(double eps2, int min_points, Cell& cell) {
  const auto is_core = [&](const Point& point) {
    long long weight = cell.weight;
    for (const Cell* other : cell.around) {
      for (const Point* q = other->begin; weight < min_points && q != other->end; ++q) {
        if (squaredDistance(point, *q) <= eps2) weight += q->weight;
      }
    }
    return weight >= min_points;
  };
  cell.cores_end = std::partition(cell.begin, cell.end, is_core);
}

bool coresInReach(double eps2, const Cell& a, const Cell& b) {
  for (const Point* p = a.begin; p != a.cores_end; ++p) {
    for (const Point* q = b.begin; q != b.cores_end; ++q) {
      if (squaredDistance(*p, *q) <= eps2) return true;
    }
  }
  return false;
}

// Flood fill from a cell to all that are connected with it.
void fill(double eps2, int label, Cell& start) {
  start.label = label;
  std::vector<const Cell*> open{&start};
  while (!open.empty()) {
    const Cell& cell = *open.back();
    open.pop_back();
    for (Cell* other : cell.around) {
      if (other->label != kNoise || !coresInReach(eps2, cell, *other)) continue;
      other->label = label;
      open.push_back(other);
    }
  }
}

int labelOfBorder(double eps2, const Point& point, const Cell& cell) {
  std::pair<double, std::size_t> nearest(eps2, std::numeric_limits<std::size_t>::max());  // squared distance, index
  int label = kNoise;
  const auto visit = [&](const Cell& other) {
    for (const Point* q = other.begin; q != other.cores_end; ++q) {
      const std::pair<double, std::size_t> here(squaredDistance(point, *q), q->index);
      if (!(here < nearest)) continue;
      nearest = here;
      label = other.label;
    }
  };
  visit(cell);
  for (const Cell* other : cell.around) visit(*other);
  return label;
}

}  // namespace

std::vector<int> dbscan2d(const std::vector<Eigen::Vector2f>& points_xy, double eps_m, int min_points,
                          const std::vector<int>& weights) {
  const double eps2 = eps_m * eps_m;
  std::vector<Point> points = sortedPoints(points_xy, eps_m, weights);
  std::vector<Cell> cells = cellsOf(points);
  std::vector<Cell*> cell_of_core(points_xy.size(), nullptr);
  for (Cell& cell : cells) {
    findCores(eps2, min_points, cell);
    for (const Point* p = cell.begin; p != cell.cores_end; ++p) cell_of_core[p->index] = &cell;
  }
  std::vector<int> labels(points_xy.size(), kNoise);
  int clusters = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (cell_of_core[i] == nullptr) continue;
    if (cell_of_core[i]->label == kNoise) fill(eps2, clusters++, *cell_of_core[i]);
    labels[i] = cell_of_core[i]->label;
  }
  for (const Cell& cell : cells) {
    for (const Point* p = cell.cores_end; p != cell.end; ++p) labels[p->index] = labelOfBorder(eps2, *p, cell);
  }
  return labels;
}

}  // namespace fail_aware
