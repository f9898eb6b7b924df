#include "simulation/terrain.hpp"

#include <cmath>

#include "simulation/random.hpp"

namespace fail_aware {

namespace {

constexpr double kLongestHill_m = 900.0, kShortestHill_m = 120.0;
constexpr double kLongestBump_m = 14.0, kShortestBump_m = 5.0;
// The road's unevenness: power spectral density G n0^2 / n^2 over the spatial frequency n, n0 = 0.1 /m, of a good road
// (ISO 8608, class B).
constexpr double kRoughness_m3 = 64e-6, kReferenceFrequency_per_m = 0.1;
constexpr double kLongestRoughness_m = 12.0, kShortestRoughness_m = 0.6;
constexpr int kRoughnessWaves = 40;
constexpr int kTile = 512;  // cells along the side of the square that repeats itself
constexpr double kTileCell_m = 0.15;

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

// Waves that fit the tile, so that it joins itself.
std::vector<float> makeRoughness(RandomStream random) {
  constexpr double kSide_m = kTile * kTileCell_m;
  std::vector<double> heights_m(static_cast<std::size_t>(kTile) * kTile);
  const double step =
      std::pow(kShortestRoughness_m / kLongestRoughness_m, 1.0 / kRoughnessWaves);  // of the wavelengths
  for (int i = 0; i < kRoughnessWaves; ++i) {
    const double length_m = kLongestRoughness_m * std::pow(step, i + 0.5);
    const double direction = random.uniform(-M_PI, M_PI), phase = random.uniform(-M_PI, M_PI);
    const double kx = 2.0 * M_PI / kTile * std::round(kSide_m / length_m * std::cos(direction));
    const double ky = 2.0 * M_PI / kTile * std::round(kSide_m / length_m * std::sin(direction));
    const double variance_m2 = kRoughness_m3 * kReferenceFrequency_per_m * kReferenceFrequency_per_m * length_m *
                               (std::sqrt(1.0 / step) - std::sqrt(step));
    const double amplitude_m = std::sqrt(2.0 * variance_m2);
    for (int x = 0; x < kTile; ++x) {
      for (int y = 0; y < kTile; ++y) {
        heights_m[static_cast<std::size_t>(x * kTile + y)] += amplitude_m * std::sin(kx * x + ky * y + phase);
      }
    }
  }
  return {heights_m.begin(), heights_m.end()};
}

}  // namespace

Terrain::Terrain(std::uint64_t seed, double grade) {
  const double count = static_cast<double>(hills_.size());
  // each wave has the same slope: the rms of the sum of N waves of slope g is g sqrt(N / 2)
  spread(hills_, kLongestHill_m, kShortestHill_m, RandomStream(combineKeys(seed, 1)),
         [&](double length_m) { return grade * std::sqrt(2.0 / count) * length_m / (2.0 * M_PI); });
  spread(bumps_, kLongestBump_m, kShortestBump_m, RandomStream(combineKeys(seed, 2)),
         [&](double) { return std::sqrt(2.0 / static_cast<double>(bumps_.size())); });
  roughness_m_ = makeRoughness(RandomStream(combineKeys(seed, 3)));
}

template <std::size_t N>
double Terrain::sum(const std::array<Wave, N>& waves, const Eigen::Vector2d& p) {
  double height = 0.0;
  for (const Wave& wave : waves) height += wave.amplitude * std::sin(wave.k.dot(p) + wave.phase);
  return height;
}

double Terrain::height(const Eigen::Vector2d& p) const { return sum(hills_, p); }
double Terrain::bumps(const Eigen::Vector2d& p) const { return sum(bumps_, p); }

// Linear between the cells.
double Terrain::roadRoughness(const Eigen::Vector2d& p) const {
  const double x = p.x() / kTileCell_m, y = p.y() / kTileCell_m;
  const double x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
  const auto at = [&](double column, double row) {
    const auto wrapped = [](double i) { return static_cast<std::size_t>(static_cast<std::int64_t>(i) & (kTile - 1)); };
    return static_cast<double>(roughness_m_[wrapped(column) * kTile + wrapped(row)]);
  };
  return (1.0 - fx) * ((1.0 - fy) * at(x0, y0) + fy * at(x0, y0 + 1.0)) +
         fx * ((1.0 - fy) * at(x0 + 1.0, y0) + fy * at(x0 + 1.0, y0 + 1.0));
}

Eigen::Vector2d Terrain::gradient(const Eigen::Vector2d& p) const {
  Eigen::Vector2d gradient(0.0, 0.0);
  for (const Wave& wave : hills_) gradient += wave.amplitude * std::cos(wave.k.dot(p) + wave.phase) * wave.k;
  return gradient;
}

}  // namespace fail_aware
