#include "core/registration/corner_svd/dbscan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace fail_aware {

namespace {

constexpr int kNoise = -1;
constexpr double kCellRatioOfEps = 0.7071;  // just under 1 / sqrt(2): a cell's diagonal is below eps
constexpr int kReach = 2;                   // in cells; farther cells hold no neighbours
constexpr double kMaxCoordinateInEps = 1e8;

struct Point {
  double x, y;
  int weight;
  int index;  // in the input
  bool core;
};

struct Cell {
  std::int32_t row, column;
  int begin, end;  // range of its points
  long long weight;
  bool has_core;
};

// Occupied cells in row-major order, with contiguous points and a list of neighbours.
class Grid {
 public:
  Grid(const std::vector<Eigen::Vector2f>& points_xy, double eps_m, const std::vector<int>& weights) {
    const double inverse_cell = 1.0 / (kCellRatioOfEps * eps_m);
    std::vector<std::pair<std::uint64_t, int>> keys;
    keys.reserve(points_xy.size());
    for (std::size_t i = 0; i < points_xy.size(); ++i) {
      const double x = static_cast<double>(points_xy[i].x()), y = static_cast<double>(points_xy[i].y());
      const double limit = kMaxCoordinateInEps * eps_m;
      if (!(std::abs(x) < limit && std::abs(y) < limit)) continue;
      keys.emplace_back(key(std::floor(y * inverse_cell), std::floor(x * inverse_cell)), static_cast<int>(i));
    }
    std::sort(keys.begin(), keys.end());

    points.reserve(keys.size());
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const std::size_t i = static_cast<std::size_t>(keys[k].second);
      const int weight = weights.empty() ? 1 : weights[i];
      if (k == 0 || keys[k].first != keys[k - 1].first) {
        const int position = static_cast<int>(k);
        cells.push_back({rowOf(keys[k].first), columnOf(keys[k].first), position, position, 0, false});
      }
      points.push_back({static_cast<double>(points_xy[i].x()), static_cast<double>(points_xy[i].y()), weight,
                        static_cast<int>(i), false});
      ++cells.back().end;
      cells.back().weight += weight;
    }
    findNeighbours();
  }

  std::vector<Point> points;
  std::vector<Cell> cells;
  std::vector<int> neighbours;  // of cell c: [first_neighbour[c], first_neighbour[c + 1]), without c
  std::vector<int> first_neighbour;

 private:
  static constexpr std::int64_t kOffset = std::int64_t{1} << 30;
  static std::uint64_t key(double row, double column) {
    return (static_cast<std::uint64_t>(static_cast<std::int64_t>(row) + kOffset) << 32) |
           static_cast<std::uint64_t>(static_cast<std::int64_t>(column) + kOffset);
  }
  static std::int32_t rowOf(std::uint64_t k) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(k >> 32) - kOffset);
  }
  static std::int32_t columnOf(std::uint64_t k) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(k & 0xffffffffU) - kOffset);
  }

  // Cells are visited in order, so the first cell in reach of each surrounding row also advances in order: one cursor
  // per row.
  void findNeighbours() {
    const int count = static_cast<int>(cells.size());
    std::array<int, 2 * kReach + 1> cursors{};
    first_neighbour.reserve(cells.size() + 1);
    for (int c = 0; c < count; ++c) {
      first_neighbour.push_back(static_cast<int>(neighbours.size()));
      for (int offset = -kReach; offset <= kReach; ++offset) {
        const std::int32_t row = cell(c).row + offset, column = cell(c).column - kReach;
        // cppcheck-suppress containerOutOfBounds ; cppcheck assumes an array of two elements
        int& cursor = cursors[static_cast<std::size_t>(offset + kReach)];
        while (cursor < count &&
               (cell(cursor).row < row || (cell(cursor).row == row && cell(cursor).column < column))) {
          ++cursor;
        }
        for (int n = cursor; n < count && cell(n).row == row && cell(n).column <= cell(c).column + kReach; ++n) {
          if (n != c) neighbours.push_back(n);
        }
      }
    }
    first_neighbour.push_back(static_cast<int>(neighbours.size()));
  }
  const Cell& cell(int c) const { return cells[static_cast<std::size_t>(c)]; }
};

double squaredDistance(const Point& a, const Point& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

class Clusters {
 public:
  Clusters(Grid& grid, double eps_m, int min_points) : grid_(grid), eps2_(eps_m * eps_m), min_points_(min_points) {
    parents_.resize(grid.cells.size());
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  std::vector<int> labels(std::size_t point_count) {
    const int cells = static_cast<int>(grid_.cells.size());
    for (int c = 0; c < cells; ++c) markCores(c);
    for (int c = 0; c < cells; ++c) connect(c);
    std::vector<int> labels(point_count, kNoise);
    labelCores(labels);
    for (int c = 0; c < cells; ++c) labelBorder(c, labels);
    return labels;
  }

 private:
  Cell& cell(int c) { return grid_.cells[static_cast<std::size_t>(c)]; }
  Point& point(int p) { return grid_.points[static_cast<std::size_t>(p)]; }

  template <class Visit>
  void forEachNeighbour(int c, Visit&& visit) {
    const std::size_t begin = static_cast<std::size_t>(grid_.first_neighbour[static_cast<std::size_t>(c)]);
    const std::size_t end = static_cast<std::size_t>(grid_.first_neighbour[static_cast<std::size_t>(c) + 1]);
    for (std::size_t i = begin; i < end; ++i) visit(grid_.neighbours[i]);
  }

  void markCores(int c) {
    for (int p = cell(c).begin; p < cell(c).end; ++p) {
      long long weight = cell(c).weight;
      forEachNeighbour(c, [&](int n) {
        for (int q = cell(n).begin; weight < min_points_ && q < cell(n).end; ++q) {
          if (squaredDistance(point(p), point(q)) <= eps2_) weight += point(q).weight;
        }
      });
      point(p).core = weight >= min_points_;
      cell(c).has_core = cell(c).has_core || point(p).core;
    }
  }

  int root(int c) {
    while (parents_[static_cast<std::size_t>(c)] != c) {
      int& parent = parents_[static_cast<std::size_t>(c)];
      parent = parents_[static_cast<std::size_t>(parent)];
      c = parent;
    }
    return c;
  }

  bool coresInReach(int a, int b) {
    for (int p = cell(a).begin; p < cell(a).end; ++p) {
      if (!point(p).core) continue;
      for (int q = cell(b).begin; q < cell(b).end; ++q) {
        if (point(q).core && squaredDistance(point(p), point(q)) <= eps2_) return true;
      }
    }
    return false;
  }

  void connect(int c) {
    if (!cell(c).has_core) return;
    forEachNeighbour(c, [&](int n) {
      if (n < c || !cell(n).has_core) return;
      const int a = root(c), b = root(n);
      if (a != b && coresInReach(c, n)) parents_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    });
  }

  void labelCores(std::vector<int>& labels) {
    std::vector<int> first_core(parents_.size(), std::numeric_limits<int>::max());  // by root: in input order
    for (std::size_t c = 0; c < grid_.cells.size(); ++c) {
      int& first = first_core[static_cast<std::size_t>(root(static_cast<int>(c)))];
      for (int p = grid_.cells[c].begin; p < grid_.cells[c].end; ++p) {
        if (point(p).core) first = std::min(first, point(p).index);
      }
    }
    std::vector<std::pair<int, int>> order;
    for (std::size_t c = 0; c < first_core.size(); ++c) {
      if (first_core[c] != std::numeric_limits<int>::max()) order.emplace_back(first_core[c], static_cast<int>(c));
    }
    std::sort(order.begin(), order.end());
    std::vector<int> label_of_root(parents_.size(), kNoise);
    for (std::size_t label = 0; label < order.size(); ++label) {
      label_of_root[static_cast<std::size_t>(order[label].second)] = static_cast<int>(label);
    }
    for (std::size_t c = 0; c < grid_.cells.size(); ++c) {
      const int label = label_of_root[static_cast<std::size_t>(root(static_cast<int>(c)))];
      for (int p = grid_.cells[c].begin; p < grid_.cells[c].end; ++p) {
        if (point(p).core) labels[static_cast<std::size_t>(point(p).index)] = label;
      }
    }
  }

  void labelBorder(int c, std::vector<int>& labels) {
    for (int p = cell(c).begin; p < cell(c).end; ++p) {
      if (point(p).core) continue;
      std::pair<double, int> nearest(eps2_, std::numeric_limits<int>::max());  // squared distance, index
      const auto visit = [&](int n) {
        for (int q = cell(n).begin; cell(n).has_core && q < cell(n).end; ++q) {
          if (point(q).core) nearest = std::min(nearest, {squaredDistance(point(p), point(q)), point(q).index});
        }
      };
      visit(c);
      forEachNeighbour(c, visit);
      if (nearest.second == std::numeric_limits<int>::max()) continue;
      labels[static_cast<std::size_t>(point(p).index)] = labels[static_cast<std::size_t>(nearest.second)];
    }
  }

  Grid& grid_;
  double eps2_;
  int min_points_;
  std::vector<int> parents_;  // union-find over cells: the core points of one cell are always connected
};

}  // namespace

std::vector<int> dbscan2d(const std::vector<Eigen::Vector2f>& points_xy, double eps_m, int min_points,
                          const std::vector<int>& weights) {
  Grid grid(points_xy, eps_m, weights);
  return Clusters(grid, eps_m, min_points).labels(points_xy.size());
}

}  // namespace fail_aware
