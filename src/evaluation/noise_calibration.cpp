#include "evaluation/noise_calibration.hpp"

#include <nlopt.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "core/estimation/increment_covariance.hpp"
#include "core/estimation/odometry_covariance.hpp"
#include "core/geometry/degree.hpp"
#include "core/io/input_error.hpp"
#include "core/stamp_difference.hpp"
#include "evaluation/consistency.hpp"

namespace fail_aware {

namespace {

constexpr double kSmallestFactor = 1e-3;  // on a parameter's start: its effect is gone
constexpr std::size_t kFewest = 10;
constexpr double kFirstRatio = 0.01;

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

using Cost = std::function<double(const std::vector<double>&)>;

// NLopt's Nelder-Mead simplex, begun anew from its result until that no longer helps: x becomes the minimum's.
void minimise(const Cost& cost, std::vector<double>& x) {
  constexpr double kFirstStep = 0.5, kTolerance = 1e-7;
  constexpr int kMaxEvaluations = 5000;
  const auto dimensions = static_cast<unsigned>(x.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> simplex(nlopt_create(NLOPT_LN_NELDERMEAD, dimensions),
                                                                       &nlopt_destroy);
  const nlopt_func value_at = [](unsigned n, const double* at, double*, void* f) {
    const double value = (*static_cast<const Cost*>(f))(std::vector<double>(at, at + n));
    return std::isfinite(value) ? value : std::numeric_limits<double>::max();
  };
  nlopt_set_min_objective(simplex.get(), value_at, const_cast<Cost*>(&cost));
  nlopt_set_initial_step1(simplex.get(), kFirstStep);
  nlopt_set_ftol_rel(simplex.get(), kTolerance);
  nlopt_set_ftol_abs(simplex.get(), kTolerance * kTolerance);
  nlopt_set_maxeval(simplex.get(), kMaxEvaluations);
  for (double value = cost(x), before = HUGE_VAL; before - value > kTolerance * (std::abs(value) + kTolerance);) {
    before = value;
    if (nlopt_optimize(simplex.get(), x.data(), &value) == NLOPT_MAXEVAL_REACHED) return;
  }
}

// The minimum over factors > 0: first one by one over decades, so as to begin in the right valley, then together by
// their logarithms.
std::vector<double> fitFactors(std::size_t count, const Cost& cost) {
  constexpr int kRounds = 3;
  std::vector<double> logs(count, 0.0);
  const auto at = [&](const std::vector<double>& x) {
    std::vector<double> factors;
    factors.reserve(x.size());
    for (const double log : x) factors.push_back(std::max(std::exp(log), kSmallestFactor));
    return factors;
  };
  double best = cost(at(logs));
  for (int round = 0; round < kRounds; ++round) {
    for (double& log : logs) {
      const double before = log;
      for (const double factor : {0.001, 0.03, 0.1, 0.3, 0.6, 1.7, 3.0, 10.0, 30.0}) {
        const double kept = log;
        log = std::max(before + std::log(factor), std::log(kSmallestFactor));
        const double value = cost(at(logs));
        if (value < best) {
          best = value;
        } else {
          log = kept;
        }
      }
    }
  }
  minimise([&](const std::vector<double>& x) { return cost(at(x)); }, logs);
  return at(logs);
}

template <class Params>
using Fields = std::vector<double Params::*>;

template <class Params>
Params scaled(Params params, const Fields<Params>& fields, const std::vector<double>& factors) {
  for (std::size_t i = 0; i < fields.size(); ++i) params.*fields[i] *= factors[i];
  return params;
}

// registration_ratio is that of a variance, the others are standard deviations.
DriftModel scaledDrift(DriftModel params, const Fields<DriftModel>& fields, std::vector<double> factors) {
  factors.front() *= factors.front();
  params = scaled(params, fields, factors);
  params.registration_ratio = std::min(params.registration_ratio, 1.0);
  return params;
}

Fields<DriftModel> driftFields() {
  using P = DriftModel;
  return {&P::registration_ratio, &P::position_per_root_metre_m, &P::heading_per_root_metre_deg,
          &P::heading_bias_deg_per_m, &P::scale_bias};
}

// The fitted parameters' squares enter the covariance linearly: C = fixed + sum (field / start)^2 per_start.
struct DriftSample {
  std::size_t run, begin, end;
  Eigen::Vector2d error_m;
  Eigen::Matrix2d fixed;
  std::vector<Eigen::Matrix2d> per_start;
};

std::vector<DriftSample> driftSamples(const std::vector<DriftRun>& runs, const DriftFitOptions& options) {
  std::vector<DriftSample> samples;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<MonitorInput>& log = runs[r].log;
    double episodes = 0.0;  // begun, and missed in gaps
    for (std::size_t b = 0; b < log.size(); ++b) {
      const double begin_s = log[b].state.stamp_s;
      const double elapsed_s = begin_s - log.front().state.stamp_s + kStampTolerance_s;
      if (elapsed_s < episodes * options.episode_every_s) continue;
      episodes = std::floor(elapsed_s / options.episode_every_s) + 1.0;
      double next_s = begin_s + options.every_s;
      for (std::size_t i = b + 1; i < log.size(); ++i) {
        const double stamp_s = log[i].state.stamp_s;
        if (stamp_s > begin_s + options.until_s + kStampTolerance_s) break;
        if (stamp_s < next_s - kStampTolerance_s) continue;
        while (next_s <= stamp_s + kStampTolerance_s) next_s += options.every_s;  // more than once after a gap
        const Eigen::Vector3d truth = runs[r].truth[b].inverse() * runs[r].truth[i].translation();
        const Eigen::Vector3d estimate = log[b].state.T_odom_cog.inverse() * log[i].state.T_odom_cog.translation();
        samples.push_back({r, b, i, (truth - estimate).head<2>(), Eigen::Matrix2d::Zero(), {}});
      }
    }
  }
  return samples;
}

// The (x, y) covariance since the episode's begin at every sample.
std::vector<Eigen::Matrix2d> covariancesAt(const std::vector<DriftRun>& runs, const std::vector<DriftSample>& samples,
                                           const DriftModel& params) {
  std::vector<Eigen::Matrix2d> covariances;
  for (std::size_t k = 0; k < samples.size();) {
    const std::size_t run = samples[k].run;
    const std::vector<MonitorInput>& log = runs[run].log;
    const auto propagate = [&](std::size_t i, OdometryCovariance& covariance) {
      const FilterState& s = log[i].state;
      return covariance.propagate(log[i - 1].state.T_odom_cog, s.T_odom_cog, incrementOf(s));
    };
    OdometryCovariance since_start(params);
    std::size_t now = 0;
    while (k < samples.size() && samples[k].run == run) {
      const std::size_t begin = samples[k].begin;
      while (now < begin) propagate(++now, since_start);
      OdometryCovariance from_begin = since_start;
      DriftSinceMark since_begin = from_begin.mark(log[begin].state.T_odom_cog);
      std::size_t i = begin;
      for (; k < samples.size() && samples[k].run == run && samples[k].begin == begin; ++k) {
        while (i < samples[k].end) {
          if (propagate(++i, from_begin)) since_begin.add(from_begin.lastStep());
        }
        covariances.push_back(since_begin.covariance().topLeftCorner<2, 2>());
      }
    }
  }
  return covariances;
}

void addCovariances(const std::vector<DriftRun>& runs, const DriftModel& start, std::vector<DriftSample>& samples) {
  const Fields<DriftModel> fields = driftFields();
  const DriftModel none = scaledDrift(start, fields, std::vector<double>(fields.size(), 0.0));
  const std::vector<Eigen::Matrix2d> fixed = covariancesAt(runs, samples, none);
  for (std::size_t k = 0; k < samples.size(); ++k) samples[k].fixed = fixed[k];
  for (const auto field : fields) {
    DriftModel one = none;
    one.*field = start.*field;
    const std::vector<Eigen::Matrix2d> with_one = covariancesAt(runs, samples, one);
    for (std::size_t k = 0; k < samples.size(); ++k) samples[k].per_start.push_back(with_one[k] - fixed[k]);
  }
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
    sample.doubt = covarianceOf(state.doubt);
    sample.modelled = state.increment_covariance - sample.doubt;
    sample.modelled.diagonal() -= floors(params, sample.distance_m);
    sample.modelled /= params.increment_scale;
    samples.push_back(sample);
  }
  return samples;
}

PoseFilter::Params fitIncrementNoise(const std::vector<IncrementSample>& samples, const PoseFilter::Params& others) {
  if (samples.size() < kFewest) {
    throw InputError("too few sweeps to calibrate with: " + std::to_string(samples.size()) + ", at least " +
                     std::to_string(kFewest) + " are needed");
  }
  using P = PoseFilter::Params;
  P begin = others;
  begin.increment_scale = 1.0;
  begin.increment_floor_m = begin.increment_per_metre_m = 0.001;
  begin.increment_floor_deg = 0.01;
  const Fields<P> fields = {&P::increment_scale, &P::increment_floor_m, &P::increment_per_metre_m,
                            &P::increment_floor_deg};
  const auto cost = [&](const std::vector<double>& factors) {
    const P params = scaled(begin, fields, factors);
    double sum = 0.0;
    for (const IncrementSample& sample : samples) {
      Matrix6d C = params.increment_scale * sample.modelled + sample.doubt;
      C.diagonal() += floors(params, sample.distance_m);
      sum += surprise<6>(sample.error, C);
    }
    return sum / static_cast<double>(samples.size());
  };
  return scaled(begin, fields, fitFactors(fields.size(), cost));
}

DriftModel fitDrift(const std::vector<DriftRun>& runs, const DriftModel& others, const DriftFitOptions& options) {
  std::vector<DriftSample> samples = driftSamples(runs, options);
  if (samples.size() < kFewest) {
    throw InputError("the runs are too short to calibrate the drift: " + std::to_string(samples.size()) +
                     " errors (5 s and more after starts 5 s apart), at least " + std::to_string(kFewest) +
                     " are needed: give a run of 25 s, or several of 15 s");
  }
  DriftModel begin = others;
  begin.position_per_root_metre_m = begin.heading_per_root_metre_deg = 0.005;
  begin.heading_bias_deg_per_m = 0.0002;
  begin.scale_bias = 0.0005;
  begin.registration_ratio = kFirstRatio;
  addCovariances(runs, begin, samples);
  const auto cost = [&](const std::vector<double>& factors) {
    double sum = 0.0;
    for (const DriftSample& sample : samples) {
      Eigen::Matrix2d C = sample.fixed;
      for (std::size_t f = 0; f < factors.size(); ++f) C += factors[f] * factors[f] * sample.per_start[f];
      sum += surprise<2>(sample.error_m, C);
    }
    return sum / static_cast<double>(samples.size());
  };
  const Fields<DriftModel> fields = driftFields();
  return scaledDrift(begin, fields, fitFactors(fields.size(), cost));
}

}  // namespace fail_aware
