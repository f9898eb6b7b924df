#include "evaluation/concordance.hpp"

#include <algorithm>
#include <random>

#include "evaluation/quantile.hpp"

namespace fail_aware {

namespace {

// -1: a fails sooner, 1: b does, 0: not known.
int sooner(const SurvivalSample& a, const SurvivalSample& b) {
  if (a.time_s < b.time_s) return a.failed ? -1 : 0;
  if (b.time_s < a.time_s) return b.failed ? 1 : 0;
  if (a.failed == b.failed) return 0;
  return a.failed ? -1 : 1;
}

double score(const std::optional<double>& of_sooner, const std::optional<double>& of_later) {
  if (!of_sooner || !of_later || *of_sooner == *of_later) return 0.5;
  return *of_sooner < *of_later ? 1.0 : 0.0;
}

}  // namespace

std::optional<double> ConcordancePairs::index() const {
  if (comparable <= 0.0) return std::nullopt;
  return score / comparable;
}

Concordance::Concordance(const std::vector<SurvivalSample>& samples,
                         const std::vector<std::optional<double>>& predicted) {
  for (const SurvivalSample& sample : samples) groups_ = std::max(groups_, sample.group + 1);
  table_.resize(groups_ * groups_);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t j = i + 1; j < samples.size(); ++j) {
      const int order = sooner(samples[i], samples[j]);
      if (order == 0) continue;
      const auto [low, high] = std::minmax(samples[i].group, samples[j].group);
      ConcordancePairs& pairs = table_[low * groups_ + high];
      pairs.comparable += 1.0;
      pairs.score += order < 0 ? score(predicted[i], predicted[j]) : score(predicted[j], predicted[i]);
    }
  }
}

ConcordancePairs Concordance::all() const {
  ConcordancePairs sum;
  for (const ConcordancePairs& pairs : table_) {
    sum.score += pairs.score;
    sum.comparable += pairs.comparable;
  }
  return sum;
}

ConcordancePairs Concordance::betweenGroups() const {
  ConcordancePairs sum = all();
  for (std::size_t g = 0; g < groups_; ++g) {
    sum.score -= table_[g * groups_ + g].score;
    sum.comparable -= table_[g * groups_ + g].comparable;
  }
  return sum;
}

std::optional<Interval> Concordance::interval(int resamples, double level, std::uint64_t seed) const {
  if (groups_ == 0) return std::nullopt;
  std::mt19937_64 random(seed);
  std::vector<double> indices;
  std::vector<double> copies(groups_);
  for (int r = 0; r < resamples; ++r) {
    std::fill(copies.begin(), copies.end(), 0.0);
    for (std::size_t i = 0; i < groups_; ++i) copies[random() % groups_] += 1.0;
    ConcordancePairs sum;
    for (std::size_t a = 0; a < groups_; ++a) {
      for (std::size_t b = a; b < groups_; ++b) {
        const double weight = copies[a] * copies[b];
        sum.score += weight * table_[a * groups_ + b].score;
        sum.comparable += weight * table_[a * groups_ + b].comparable;
      }
    }
    if (const std::optional<double> index = sum.index()) indices.push_back(*index);
  }
  if (indices.empty()) return std::nullopt;
  return Interval{quantile(indices, 0.5 * (1.0 - level)), quantile(indices, 0.5 * (1.0 + level))};
}

}  // namespace fail_aware
