#include "fail_aware_lidar_odometry/core/evaluation/noise_calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "fail_aware_lidar_odometry/core/evaluation/consistency.hpp"
#include "fail_aware_lidar_odometry/core/evaluation/nelder_mead.hpp"
#include "fail_aware_lidar_odometry/core/fusion/odometry_covariance.hpp"
#include "fail_aware_lidar_odometry/core/io/input_error.hpp"

namespace fail_aware {

namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kSmallestShare = 1e-3;  // of its start, below which a parameter does not fall: its effect is gone
constexpr std::size_t kFewest = 10;

// Minus the log likelihood of an error, without constants. Infinite where C is no covariance.
template <int N>
double surprise(const Eigen::Matrix<double, N, 1>& error, const Eigen::Matrix<double, N, N>& C) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> llt(C);
  if (llt.info() != Eigen::Success) return HUGE_VAL;
  const double log_root = Eigen::Matrix<double, N, N>(llt.matrixL()).diagonal().array().log().sum();
  return log_root + 0.5 * llt.matrixL().solve(error).squaredNorm();
}

Vector6d floors(const PoseFilter::Params& params, double distance_m) {
  const double position = params.increment_floor_m + params.increment_per_metre_m * distance_m;
  const double rotation = params.increment_floor_deg * kDegree;
  Vector6d variances;
  variances.head<3>().setConstant(position * position);
  variances.tail<3>().setConstant(rotation * rotation);
  return variances;
}

// Positive parameters by their logarithms.
template <class Params>
Params fitPositive(const Params& start, const std::vector<double Params::*>& fields,
                   const std::function<double(const Params&)>& cost) {
  const auto with = [&](const std::vector<double>& logs) {
    Params params = start;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      params.*fields[i] = std::max(std::exp(logs[i]), kSmallestShare * start.*fields[i]);
    }
    return params;
  };
  std::vector<double> logs;
  for (const auto field : fields) logs.push_back(std::log(start.*field));
  return with(nelderMead([&](const std::vector<double>& x) { return cost(with(x)); }, logs, 0.5, 1e-7, 2000).x);
}

struct DriftSample {
  std::size_t run, begin, end;
  Eigen::Vector2d error_m;
};

std::vector<DriftSample> driftSamples(const std::vector<DriftRun>& runs, const DriftFitOptions& options) {
  std::vector<DriftSample> samples;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<MonitorInput>& log = runs[r].log;
    double next_begin_s = log.front().state.stamp_s;
    for (std::size_t b = 0; b < log.size(); ++b) {
      const double begin_s = log[b].state.stamp_s;
      if (begin_s < next_begin_s - 1e-6) continue;
      next_begin_s += options.episode_every_s;
      double next_s = begin_s + options.every_s;
      for (std::size_t i = b + 1; i < log.size() && log[i].state.stamp_s <= begin_s + options.until_s + 1e-6; ++i) {
        if (log[i].state.stamp_s < next_s - 1e-6) continue;
        next_s += options.every_s;
        const Eigen::Vector3d truth = runs[r].truth[b].inverse() * runs[r].truth[i].translation();
        const Eigen::Vector3d estimate = log[b].state.T_odom_cog.inverse() * log[i].state.T_odom_cog.translation();
        samples.push_back({r, b, i, (truth - estimate).head<2>()});
      }
    }
  }
  return samples;
}

double driftCost(const std::vector<DriftRun>& runs, const std::vector<DriftSample>& samples,
                 const DriftModel::Params& params) {
  double cost = 0.0;
  for (std::size_t k = 0; k < samples.size();) {
    const DriftSample first = samples[k];
    const std::vector<MonitorInput>& log = runs[first.run].log;
    OdometryCovariance covariance(params);
    const auto propagate = [&](std::size_t i) {
      const FilterState& s = log[i].state;
      covariance.propagate(log[i - 1].state.T_odom_cog, s.T_odom_cog,
                           {s.increment_covariance, s.unobserved_covariance, s.dt_s});
    };
    if (first.begin > 0) propagate(first.begin);  // for the jitter of the mark
    covariance.mark(log[first.begin].state.T_odom_cog);
    std::size_t i = first.begin;
    for (; k < samples.size() && samples[k].run == first.run && samples[k].begin == first.begin; ++k) {
      while (i < samples[k].end) propagate(++i);
      cost += surprise<2>(samples[k].error_m, covariance.sinceMark().topLeftCorner<2, 2>());
    }
  }
  return cost / static_cast<double>(samples.size());
}

}  // namespace

std::vector<IncrementSample> incrementSamples(const std::vector<Pose>& truth, const std::vector<MonitorInput>& log,
                                              const PoseFilter::Params& params) {
  std::vector<IncrementSample> samples;
  for (std::size_t i = 1; i < log.size(); ++i) {
    const FilterState& state = log[i].state;
    if (state.dt_s <= 0.0) continue;
    IncrementSample sample;
    sample.error = motionError(truth[i - 1].inverse() * truth[i], state.T_previous_now);
    sample.distance_m = state.T_previous_now.translation().norm();
    sample.modelled = state.increment_covariance;
    sample.modelled.diagonal() -= floors(params, sample.distance_m);
    sample.modelled /= params.increment_scale;
    samples.push_back(sample);
  }
  return samples;
}

PoseFilter::Params fitIncrementNoise(const std::vector<IncrementSample>& samples, const PoseFilter::Params& start) {
  if (samples.size() < kFewest) throw InputError("too few sweeps to calibrate with");
  const std::function<double(const PoseFilter::Params&)> cost = [&](const PoseFilter::Params& params) {
    double sum = 0.0;
    for (const IncrementSample& sample : samples) {
      Matrix6d C = params.increment_scale * sample.modelled;
      C.diagonal() += floors(params, sample.distance_m);
      sum += surprise<6>(sample.error, C);
    }
    return sum / static_cast<double>(samples.size());
  };
  using P = PoseFilter::Params;
  return fitPositive<P>(start, {&P::increment_scale, &P::increment_floor_m, &P::increment_per_metre_m, &P::increment_floor_deg},
                        cost);
}

DriftModel::Params fitDrift(const std::vector<DriftRun>& runs, const DriftModel::Params& start,
                            const DriftFitOptions& options) {
  const std::vector<DriftSample> samples = driftSamples(runs, options);
  if (samples.size() < kFewest) throw InputError("too few sweeps to calibrate with");
  const std::function<double(const DriftModel::Params&)> cost = [&](const DriftModel::Params& params) {
    return driftCost(runs, samples, params);
  };
  using P = DriftModel::Params;
  return fitPositive<P>(start,
                        {&P::position_per_root_metre_m, &P::heading_per_root_metre_deg, &P::heading_bias_deg_per_m,
                         &P::scale_bias},
                        cost);
}

}  // namespace fail_aware
