#include "core/preprocessing/correction.hpp"

#include <algorithm>
#include <cmath>

#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr double kFarthestPoint_m = 200.0;
constexpr double kMaxTruncation_m = 1e-4;  // of the power series there: far below range noise
constexpr int kMaxOrder = 8;
constexpr double kMaxSpeed_mps = 1000.0;
constexpr double kMaxRate_radps = 100.0;

bool isUsable(const Vector6d& twist) {
  return twist.head<3>().norm() <= kMaxSpeed_mps && twist.tail<3>().norm() <= kMaxRate_radps;  // false for NaN
}

Eigen::Map<const Eigen::ArrayXf> asArray(const std::vector<float>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// The lowest order with a remainder below kMaxTruncation_m; kMaxOrder + 1 if there is none. With a = |s w|, the term
/// of order k is at most |s| (|w| r + |u|) a^(k-1) / k!, and all terms from the k-th on sum to at most e^a times that.
int seriesOrder(const Vector6d& twist, double longest_s) {
  const double a = longest_s * twist.tail<3>().norm();
  double bound = (a * kFarthestPoint_m + longest_s * twist.head<3>().norm()) * std::exp(a);
  for (int order = 0; order <= kMaxOrder; ++order) {
    if (bound < kMaxTruncation_m) return order;
    bound *= a / (order + 2);
  }
  return kMaxOrder + 1;
}

/// p <- Exp(s twist) p for each point and its s.
void moveByTwist(const std::vector<float>& times_s, const Vector6d& twist, std::vector<Eigen::Vector3f>& points) {
  const double longest_s = asArray(times_s).abs().maxCoeff();
  const int order = seriesOrder(twist, longest_s);
  if (order > kMaxOrder) {
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const Pose T = expSe3(static_cast<double>(times_s[i]) * twist);
      points[i] = (T * points[i].cast<double>()).cast<float>();
    }
    return;
  }

  // Horner's scheme on the homogeneous point: q <- p + (s/k) (w x q + u), for k = order .. 1.
  const Eigen::Vector3f u = twist.head<3>().cast<float>(), w = twist.tail<3>().cast<float>();
  PointBlock p, q;
  PointBlock::Array s = PointBlock::Array::Zero();
  forEachBlock(times_s.size(), [&](std::size_t first, std::size_t count) {
    p.load(&points[first], count);
    q = p;
    for (std::size_t i = 0; i < count; ++i) s.data()[i] = times_s[first + i];
    for (int k = order; k > 0; --k) {
      const PointBlock::Array step = s * (1.0f / static_cast<float>(k));
      const PointBlock::Array x = p.x + step * (w.y() * q.z - w.z() * q.y + u.x());
      const PointBlock::Array y = p.y + step * (w.z() * q.x - w.x() * q.z + u.y());
      q.z = p.z + step * (w.x() * q.y - w.y() * q.x + u.z());
      q.x = x;
      q.y = y;
    }
    q.store(&points[first], count);
  });
}

}  // namespace

const char* toString(CorrectionStatus status) {
  switch (status) {
    case CorrectionStatus::kCorrected: return "corrected";
    case CorrectionStatus::kOff: return "off";
    case CorrectionStatus::kBadTimes: return "bad_times";
    case CorrectionStatus::kNoMotion: return "no_motion";
  }
  return "unknown";
}

double middleOf(const std::vector<float>& times_s) {
  if (times_s.empty()) return 0.0;
  const auto [first, last] = std::minmax_element(times_s.begin(), times_s.end());
  return 0.5 * (static_cast<double>(*first) + static_cast<double>(*last));
}

Vector6d lidarTwist(const Pose& T_odom_cog_begin, const Pose& T_odom_cog_end, const Pose& T_cog_lidar, double dt_s) {
  return logSe3((T_odom_cog_begin * T_cog_lidar).inverse() * T_odom_cog_end * T_cog_lidar) / dt_s;
}

CorrectionStatus correctSweep(const SweepCorrectionParams& params, const Sweep& sweep,
                              const std::vector<float>& times_relative_to_stamp_s, const Pose& T_odom_cog_begin,
                              const Pose& T_odom_cog_end, double dt_s, const Pose& T_cog_lidar, CorrectedSweep& out) {
  const std::vector<float>& times_s = times_relative_to_stamp_s;
  out.stamp_s = sweep.stamp_s;
  out.rings = sweep.rings;
  out.points_lidar = sweep.points_lidar;
  out.times_s.clear();
  if (!params.enabled || times_s.empty()) return CorrectionStatus::kOff;
  if (times_s.size() != sweep.size() || !asArray(times_s).allFinite()) return CorrectionStatus::kBadTimes;
  out.times_s = times_s;
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return CorrectionStatus::kNoMotion;
  const Vector6d twist_lidar = lidarTwist(T_odom_cog_begin, T_odom_cog_end, T_cog_lidar, dt_s);
  if (!isUsable(twist_lidar)) return CorrectionStatus::kNoMotion;
  moveByTwist(times_s, twist_lidar, out.points_lidar);
  return CorrectionStatus::kCorrected;
}

bool redeskewBy(std::vector<Eigen::Vector3f>& points_lidar, const std::vector<float>& times_relative_to_stamp_s,
                const Vector6d& delta_twist_lidar) {
  const std::vector<float>& times_s = times_relative_to_stamp_s;
  if (times_s.empty() || times_s.size() != points_lidar.size() || !asArray(times_s).allFinite()) return false;
  if (!isUsable(delta_twist_lidar)) return false;
  moveByTwist(times_s, delta_twist_lidar, points_lidar);
  return true;
}

}  // namespace fail_aware
