#include "simulation/terrain.hpp"

#include <cmath>

#include "simulation/random.hpp"

namespace fail_aware {

namespace {

constexpr double kLongestHill_m = 900.0, kShortestHill_m = 120.0;
constexpr double kLongestBump_m = 14.0, kShortestBump_m = 5.0;
constexpr double kLongestRoughness_m = 12.0, kShortestRoughness_m = 1.2;
constexpr double kRoughness_m = 0.002;  // at the shortest wave; increases with the wavelength

/// Wavelengths from longest to shortest in equal ratios, random directions; amplitude(wavelength).
template <std::size_t N, class Wave, class Amplitude>
void spread(std::array<Wave, N>& waves, double longest_m, double shortest_m, RandomStream random,
            Amplitude&& amplitude) {
  for (std::size_t i = 0; i < N; ++i) {
    const double ratio = static_cast<double>(i) / static_cast<double>(N - 1);
    const double length_m = longest_m * std::pow(shortest_m / longest_m, ratio);
    const double direction = random.uniform(-M_PI, M_PI);
    waves[i].k = 2.0 * M_PI / length_m * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    waves[i].amplitude = amplitude(length_m);
    waves[i].phase = random.uniform(-M_PI, M_PI);
  }
}

}  // namespace

Terrain::Terrain(std::uint64_t seed, double grade) {
  const double count = static_cast<double>(hills_.size());
  // each wave has the same slope: the rms of the sum of N waves of slope g is g sqrt(N / 2)
  spread(hills_, kLongestHill_m, kShortestHill_m, RandomStream(combineKeys(seed, 1)),
         [&](double length_m) { return grade * std::sqrt(2.0 / count) * length_m / (2.0 * M_PI); });
  spread(bumps_, kLongestBump_m, kShortestBump_m, RandomStream(combineKeys(seed, 2)),
         [&](double) { return std::sqrt(2.0 / static_cast<double>(bumps_.size())); });
  spread(roughness_, kLongestRoughness_m, kShortestRoughness_m, RandomStream(combineKeys(seed, 3)),
         [&](double length_m) { return kRoughness_m * std::sqrt(length_m / kShortestRoughness_m) / 2.0; });
}

template <std::size_t N>
double Terrain::sum(const std::array<Wave, N>& waves, const Eigen::Vector2d& p) {
  double height = 0.0;
  for (const Wave& wave : waves) height += wave.amplitude * std::sin(wave.k.dot(p) + wave.phase);
  return height;
}

double Terrain::height(const Eigen::Vector2d& p) const { return sum(hills_, p); }
double Terrain::bumps(const Eigen::Vector2d& p) const { return sum(bumps_, p); }
double Terrain::roadRoughness(const Eigen::Vector2d& p) const { return sum(roughness_, p); }

Eigen::Vector2d Terrain::gradient(const Eigen::Vector2d& p) const {
  Eigen::Vector2d gradient(0.0, 0.0);
  for (const Wave& wave : hills_) gradient += wave.amplitude * std::cos(wave.k.dot(p) + wave.phase) * wave.k;
  return gradient;
}

}  // namespace fail_aware
