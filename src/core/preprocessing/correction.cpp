#include "core/preprocessing/correction.hpp"

#include <cmath>

#include "point_block.hpp"

namespace fail_aware {

namespace {

constexpr double kFarthestPoint_m = 200.0;
constexpr int kMaxOrder = 8;
constexpr double kMaxSpeed_mps = 1000.0;
constexpr double kMaxRate_radps = 100.0;

bool isUsable(const Vector6d& twist) {
  return twist.head<3>().norm() <= kMaxSpeed_mps && twist.tail<3>().norm() <= kMaxRate_radps;  // false for NaN
}

Eigen::Map<const Eigen::ArrayXf> asArray(const std::vector<float>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// The lowest order with a remainder below the tolerance; kMaxOrder + 1 if there is none. With a = |s w|, the term of
/// order k is at most |s| (|w| r + |u|) a^(k-1) / k!, and all terms from the k-th on sum to at most e^a times that.
int seriesOrder(const Vector6d& twist, double longest_s, double tolerance_m) {
  const double a = longest_s * twist.tail<3>().norm();
  double bound = (a * kFarthestPoint_m + longest_s * twist.head<3>().norm()) * std::exp(a);
  for (int order = 0; order <= kMaxOrder; ++order) {
    if (bound < tolerance_m) return order;
    bound *= a / (order + 2);
  }
  return kMaxOrder + 1;
}

/// out = Exp(s twist) in for each point and its s; `in` and `out` may be the same array.
void moveByTwist(const Eigen::Vector3f* in, const std::vector<float>& times_s, const Vector6d& twist,
                 double tolerance_m, Eigen::Vector3f* out) {
  const double longest_s = asArray(times_s).abs().maxCoeff();
  const int order = seriesOrder(twist, longest_s, tolerance_m);
  if (order > kMaxOrder) {
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const Pose T = expSe3(static_cast<double>(times_s[i]) * twist);
      out[i] = (T * in[i].cast<double>()).cast<float>();
    }
    return;
  }

  // Horner's scheme on the homogeneous point: q <- p + (s/k) (w x q + u), for k = order .. 1.
  const Eigen::Vector3f u = twist.head<3>().cast<float>(), w = twist.tail<3>().cast<float>();
  PointBlock p, q;
  PointBlock::Array s = PointBlock::Array::Zero();
  forEachBlock(times_s.size(), [&](std::size_t first, std::size_t count) {
    p.load(in + first, count);
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
    q.store(out + first, count);
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

Vector6d lidarTwist(const Pose& T_odom_cog_begin, const Pose& T_odom_cog_end, const Pose& T_cog_lidar, double dt_s) {
  return logSe3((T_odom_cog_begin * T_cog_lidar).inverse() * T_odom_cog_end * T_cog_lidar) / dt_s;
}

CorrectionStatus SweepCorrection::correct(const Sweep& sweep, const std::vector<float>& times_relative_to_stamp_s,
                                          const Pose& T_odom_cog_begin, const Pose& T_odom_cog_end, double dt_s,
                                          const Pose& T_cog_lidar, CorrectedSweep& out) const {
  const std::vector<float>& times_s = times_relative_to_stamp_s;
  out.stamp_s = sweep.stamp_s;
  out.rings = sweep.rings;
  out.points_lidar = sweep.points_lidar;
  out.times_s.clear();
  if (!params_.enabled || times_s.empty()) return CorrectionStatus::kOff;
  if (times_s.size() != sweep.size() || !asArray(times_s).allFinite()) return CorrectionStatus::kBadTimes;
  out.times_s = times_s;
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return CorrectionStatus::kNoMotion;
  const Vector6d twist_lidar = lidarTwist(T_odom_cog_begin, T_odom_cog_end, T_cog_lidar, dt_s);
  if (!isUsable(twist_lidar)) return CorrectionStatus::kNoMotion;
  moveByTwist(out.points_lidar.data(), times_s, twist_lidar, params_.max_truncation_m, out.points_lidar.data());
  return CorrectionStatus::kCorrected;
}

bool SweepCorrection::redeskew(std::vector<Eigen::Vector3f>& points_lidar,
                               const std::vector<float>& times_relative_to_stamp_s,
                               const Vector6d& delta_twist_lidar) const {
  const std::vector<float>& times_s = times_relative_to_stamp_s;
  if (times_s.empty() || times_s.size() != points_lidar.size() || !asArray(times_s).allFinite()) return false;
  if (!isUsable(delta_twist_lidar)) return false;
  moveByTwist(points_lidar.data(), times_s, delta_twist_lidar, params_.max_truncation_m, points_lidar.data());
  return true;
}

}  // namespace fail_aware
