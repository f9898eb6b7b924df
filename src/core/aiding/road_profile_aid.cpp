#include "core/aiding/road_profile_aid.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace fail_aware {

namespace {

// Larger differences between the road's speed and the filter's are not scatter: 0.1 m a sweep.
constexpr double kMaxDifference_mps = 1.0;
constexpr double kUnnoticed_mps = 1.2;     // what the filter may not have noticed of the speed
constexpr double kMovedElsewhere_m = 0.3;  // places scatter by less

/// Bit k: eighth k of the azimuth holds points.
std::bitset<8> eighthsSeen(const std::vector<Eigen::Vector3f>& points_cog) {
  constexpr std::size_t kFewest = 20;
  std::array<std::size_t, 8> points{};
  for (const Eigen::Vector3f& p : points_cog) {
    const bool steep = std::abs(p.y()) > std::abs(p.x());
    ++points[(p.x() > 0.0f ? 1u : 0u) | (p.y() > 0.0f ? 2u : 0u) | (steep ? 4u : 0u)];
  }
  std::bitset<8> seen;
  for (std::size_t i = 0; i < 8; ++i) seen[i] = points[i] >= kFewest;
  return seen;
}

Eigen::Vector3d meanHeading(const Pose& a, const Pose& b) {
  return (a.linear().col(0) + b.linear().col(0)).normalized();
}

}  // namespace

void RoadProfileAid::setPose(const Pose& T_odom_cog) {
  const auto movedElsewhere_m = [&] {
    return std::abs(T_odom_cog.linear().col(0).dot(T_odom_cog.translation() - T_odom_cog_road_->translation()));
  };
  const bool moves_all = T_odom_cog_road_ && movedElsewhere_m() > kMovedElsewhere_m;
  if (moves_all) odometry_.setPose(*T_odom_cog_road_);
  odometry_.setPose(T_odom_cog, moves_all);
}

RoadProfileAid::Result RoadProfileAid::find(const CorrectedSweep& sweep, const RegistrationScan& scan,
                                            const SweepPrediction& prediction, const EstimateTrack& track) {
  Result result;
  T_odom_cog_road_.reset();
  if (!odometry_.params().enabled) return result;
  const std::bitset<8> before = std::exchange(eighths_seen_, eighthsSeen(scan.cloud.map_points_cog));
  // different parts of a revolution show different roads
  const bool looks_elsewhere = 2 * (before & eighths_seen_).count() < (before | eighths_seen_).count();
  if (!scan.usable || track.speedObserved() || looks_elsewhere) {
    odometry_.clear();
    return result;
  }
  odometry_.add(sweep, scan.T_cog_lidar, scan.twist_cog, prediction.T_odom_cog);
  const bool known_before = odometry_.hasSpeed();
  const double assumed_mps = scan.twist_cog[0], dt_s = prediction.dt_s;
  if (!prediction.motionKnown()) has_agreed_ = false;
  const bool is_expected = track.speedWasObserved() || has_agreed_;
  if (is_expected) {
    const double sigma_m = std::hypot(track.speedSigma_mps(), kUnnoticed_mps) * dt_s;
    if (const std::optional<RoadPlace> place = odometry_.findPlace(sigma_m)) {
      T_odom_cog_road_ = prediction.T_odom_cog;
      T_odom_cog_road_->translation() += place->offset_m * prediction.T_odom_cog.linear().col(0);
      const Eigen::Vector3d forward = meanHeading(prediction.T_odom_cog_previous, prediction.T_odom_cog);
      const Eigen::Vector3d way_m = T_odom_cog_road_->translation() - prediction.T_odom_cog_previous.translation();
      result.distance = {forward.dot(way_m), place->sigma_m};
      return result;
    }
  }
  const std::optional<RoadProfileOdometry::Speed> speed =
      is_expected ? odometry_.findSpeed(assumed_mps, track.speedSigma_mps()) : odometry_.findSpeed();
  if (!speed) return result;
  if (!is_expected) odometry_.setPath(*speed);
  const bool agrees = std::abs(speed->speed_mps - assumed_mps) <= kMaxDifference_mps;
  has_agreed_ = has_agreed_ || agrees;
  result.map_is_wrong = !is_expected && !known_before && !agrees;
  if (dt_s > 0.0) {
    result.distance = {(speed->speed_mps - 0.5 * speed->acceleration_mps2 * dt_s) * dt_s, speed->sigma_mps * dt_s};
  }
  return result;
}

Measurement roadProfileMeasurement(const std::optional<RoadProfileAid::Distance>& distance,
                                   const Pose& T_odom_cog_previous, const Pose& T_odom_cog_start) {
  Measurement measurement;
  if (!distance) return measurement;
  const Eigen::Vector3d forward = meanHeading(T_odom_cog_previous, T_odom_cog_start);
  const double guessed_m = forward.dot(T_odom_cog_start.translation() - T_odom_cog_previous.translation());
  measurement.status = MeasurementStatus::kOk;
  measurement.T_odom_cog = T_odom_cog_start;
  measurement.T_odom_cog.translation() += (distance->distance_m - guessed_m) * forward;
  measurement.covariance = kUnobservedVariance * Matrix6d::Identity();
  measurement.covariance.topLeftCorner<3, 3>() +=
      (distance->sigma_m * distance->sigma_m - kUnobservedVariance) * forward * forward.transpose();
  return measurement;
}

}  // namespace fail_aware
