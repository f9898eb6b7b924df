#include "fail_aware_lidar_odometry/core/evaluation/nelder_mead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fail_aware {

namespace {

struct Vertex {
  std::vector<double> x;
  double value;
};

class Simplex {
 public:
  Simplex(const std::function<double(const std::vector<double>&)>& f, int max_evaluations)
      : f_(f), max_evaluations_(max_evaluations) {}

  Vertex evaluated(std::vector<double> x) {
    ++evaluations_;
    const double value = f_(x);
    return {std::move(x), std::isfinite(value) ? value : std::numeric_limits<double>::max()};
  }

  /// False: out of evaluations.
  bool minimise(Vertex& best, double step, double tolerance) {
    std::vector<Vertex> v{best};
    for (std::size_t i = 0; i < best.x.size(); ++i) {
      std::vector<double> x = best.x;
      x[i] += step;
      v.push_back(evaluated(std::move(x)));
    }
    while (true) {
      std::sort(v.begin(), v.end(), [](const Vertex& a, const Vertex& b) { return a.value < b.value; });
      best = v.front();
      if (v.back().value - v.front().value <= tolerance * (std::abs(v.front().value) + tolerance)) return true;
      if (evaluations_ >= max_evaluations_) return false;
      improve(v);
    }
  }

  int evaluations() const { return evaluations_; }

 private:
  // Replaces the worst vertex by its image in the others' centre, or draws all towards the best.
  void improve(std::vector<Vertex>& v) {
    Vertex& worst = v.back();
    const auto along = [&](double t) {  // t = 1: the worst itself, -1: its reflection
      std::vector<double> x(worst.x.size(), 0.0);
      for (std::size_t i = 0; i < x.size(); ++i) {
        double centre = 0.0;
        for (std::size_t k = 0; k + 1 < v.size(); ++k) centre += v[k].x[i] / static_cast<double>(v.size() - 1);
        x[i] = centre + t * (worst.x[i] - centre);
      }
      return x;
    };
    const Vertex reflected = evaluated(along(-1.0));
    if (reflected.value < v.front().value) {
      const Vertex expanded = evaluated(along(-2.0));
      worst = expanded.value < reflected.value ? expanded : reflected;
      return;
    }
    if (reflected.value < v[v.size() - 2].value) {
      worst = reflected;
      return;
    }
    const Vertex contracted = evaluated(along(reflected.value < worst.value ? -0.5 : 0.5));
    if (contracted.value < std::min(worst.value, reflected.value)) {
      worst = contracted;
      return;
    }
    for (std::size_t k = 1; k < v.size(); ++k) {
      std::vector<double> x = v[k].x;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.5 * (x[i] + v.front().x[i]);
      v[k] = evaluated(std::move(x));
    }
  }

  const std::function<double(const std::vector<double>&)>& f_;
  int max_evaluations_;
  int evaluations_ = 0;
};

}  // namespace

NelderMeadResult nelderMead(const std::function<double(const std::vector<double>&)>& f, std::vector<double> start,
                            double step, double tolerance, int max_evaluations) {
  Simplex simplex(f, max_evaluations);
  Vertex best = simplex.evaluated(std::move(start));
  bool converged = false;
  while (true) {
    const double before = best.value;
    converged = simplex.minimise(best, step, tolerance);
    if (!converged || before - best.value <= tolerance * (std::abs(best.value) + tolerance)) break;
  }
  return {best.x, best.value, simplex.evaluations(), converged};
}

}  // namespace fail_aware
