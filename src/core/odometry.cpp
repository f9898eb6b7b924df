#include "fail_aware_lidar_odometry/odometry.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/io/profile_files.hpp"
#include "core/odometry_pipeline.hpp"
#include "core/types/sweep_points.hpp"

namespace fail_aware {

namespace {

PipelineParameters load(const Parameters& parameters) {
  PipelineParameters loaded =
      loadPipelineParameters({parameters.cfg, parameters.profile, parameters.vehicle, parameters.sensor});
  std::vector<std::string> assignments;
  for (const auto& [key, value] : parameters.overrides) assignments.push_back(key + "=" + value);
  overrideParameters(loaded, parameters.files, assignments);
  return loaded;
}

template <class T>
void requireOnePerPoint(const char* name, const std::vector<T>& values, std::size_t points) {
  if (values.empty() || values.size() == points) return;
  throw std::invalid_argument(std::string(name) + ": " + std::to_string(values.size()) + " values for " +
                              std::to_string(points) + " points");
}

void leaveOutUnusablePoints(Sweep& sweep) {
  std::vector<std::size_t> kept;
  kept.reserve(sweep.size());
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (isUsablePoint(sweep.points_lidar[i])) kept.push_back(i);
  }
  if (kept.size() == sweep.size()) return;
  sweep.points_dropped += sweep.size() - kept.size();
  keepPoints(kept, sweep);
}

}  // namespace

const char* toString(SweepStatus status) {
  switch (status) {
    case SweepStatus::kNotStarted: return "not_started";
    case SweepStatus::kFirst: return "first";
    case SweepStatus::kCorrected: return "corrected";
    case SweepStatus::kPredicted: return "predicted";
    case SweepStatus::kStampNotAdvancing: return "stamp_not_advancing";
  }
  return "unknown";
}

Odometry::Odometry(const Parameters& parameters, int threads)
    : pipeline_(std::make_unique<OdometryPipeline>(load(parameters), threads)) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

Result Odometry::step(Sweep sweep) {
  if (!std::isfinite(sweep.stamp_s)) throw std::invalid_argument("stamp: not finite");
  requireOnePerPoint("intensities", sweep.intensities, sweep.size());
  requireOnePerPoint("times", sweep.times_s, sweep.size());
  requireOnePerPoint("rings", sweep.rings, sweep.size());
  leaveOutUnusablePoints(sweep);
  Result result;
  result.stamp_s = sweep.stamp_s;
  SweepResult swept = pipeline_->step(sweep);
  result.status = swept.status;
  result.T_odom_base = swept.T_odom_base;
  result.covariance = swept.odometry_covariance;
  result.monitor = swept.monitor;
  result.pose_set_refused = std::move(swept.pose_set.refused);
  return result;
}

void Odometry::startRedundant(double from_stamp_s) { pipeline_->startRedundant(from_stamp_s); }

void Odometry::stopRedundant() { pipeline_->stopRedundant(); }

void Odometry::reset() { pipeline_->reset(); }

std::string Odometry::setPose(const ExternalPose& pose) { return pipeline_->setPose(pose); }

void Odometry::addSource(const std::string& name, double tolerance_s) { pipeline_->addSource(name, tolerance_s); }

std::string Odometry::offer(const std::string& source, const ExternalPose& pose) {
  return pipeline_->offer(source, pose);
}

}  // namespace fail_aware
