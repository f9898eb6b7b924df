#include "evaluation/kitti_metric.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "evaluation/trajectory_pair.hpp"

namespace fail_aware {

namespace {

KittiMetric::Average average(double length_m, std::size_t segments, double t_err_sum, double r_err_sum) {
  if (segments == 0) return {length_m, 0, 0.0, 0.0};
  const double count = static_cast<double>(segments);
  return {length_m, segments, 100.0 * t_err_sum / count, r_err_sum / count / kDegree};
}

}  // namespace

void KittiMetric::Params::validate() const {
  requireParameter(!lengths_m.empty(), "lengths_m", "(empty)", "at least one length");
  for (const double length_m : lengths_m) requirePositive("lengths_m", length_m);
  requireParameter(step >= 1, "step", step, ">= 1");
}

std::vector<double> distancesAlong(const std::vector<Pose>& poses) {
  std::vector<double> distances_m(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    distances_m[i] = distances_m[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return distances_m;
}

std::optional<std::size_t> segmentEnd(const std::vector<double>& distances_m, std::size_t first, double length_m) {
  const auto begin = distances_m.begin() + static_cast<std::ptrdiff_t>(first);
  const auto end = std::upper_bound(begin, distances_m.end(), distances_m[first] + length_m);
  if (end == distances_m.end()) return std::nullopt;
  return static_cast<std::size_t>(end - distances_m.begin());
}

std::vector<std::pair<std::size_t, std::size_t>> segmentsOf(const std::vector<double>& distances_m, double length_m,
                                                            int step) {
  std::vector<std::pair<std::size_t, std::size_t>> segments;
  for (std::size_t first = 0; first < distances_m.size(); first += static_cast<std::size_t>(step)) {
    const std::optional<std::size_t> last = segmentEnd(distances_m, first, length_m);
    if (!last) break;  // later starts end later
    segments.emplace_back(first, *last);
  }
  return segments;
}

KittiMetric kittiMetric(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                        const KittiMetric::Params& params) {
  params.validate();
  requirePosePairs(truth, estimate);
  const std::vector<double> distances_m = distancesAlong(truth);

  KittiMetric result;
  std::size_t segments = 0;
  double t_err_sum = 0.0, r_err_sum = 0.0;  // m/m and rad/m
  for (const double length_m : params.lengths_m) {
    const auto segments_here = segmentsOf(distances_m, length_m, params.step);
    double t_err_here = 0.0, r_err_here = 0.0;
    for (const auto& [first, last] : segments_here) {
      const Pose E = relativeError(truth, estimate, first, last);
      t_err_here += E.translation().norm() / length_m;
      r_err_here += logSo3(E.linear()).norm() / length_m;
    }
    result.per_length.push_back(average(length_m, segments_here.size(), t_err_here, r_err_here));
    segments += segments_here.size();
    t_err_sum += t_err_here;
    r_err_sum += r_err_here;
  }
  result.total = average(0.0, segments, t_err_sum, r_err_sum);
  return result;
}

}  // namespace fail_aware
