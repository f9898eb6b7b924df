// Random numbers as a function of a key: the simulator's noise does not depend on the order or the thread of the calls.
// Integer arithmetic only (SplitMix64's mixing), so that all machines agree. No failure modes. Cost: a few ns a number.
#pragma once

#include <cstdint>

namespace fail_aware {

/// SplitMix64's finalizer: every bit of the result depends on every bit of x.
constexpr std::uint64_t mixBits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

constexpr std::uint64_t combineKeys(std::uint64_t key, std::uint64_t next) { return mixBits(key ^ mixBits(next)); }

template <class... Rest>
constexpr std::uint64_t combineKeys(std::uint64_t key, std::uint64_t next, Rest... rest) {
  return combineKeys(combineKeys(key, next), static_cast<std::uint64_t>(rest)...);
}

/// In [0, 1).
constexpr double uniformFromBits(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; }

/// Mean 0, standard deviation 1, never beyond 3.5: the sum of four 16-bit uniforms.
constexpr float normalFromBits(std::uint64_t bits) {
  const auto sum = (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
  return (static_cast<float>(sum) / 65535.0f - 2.0f) * 1.7320508f;
}

class RandomStream {
 public:
  explicit RandomStream(std::uint64_t key) : key_(key) {}

  std::uint64_t bits() { return combineKeys(key_, count_++); }
  double uniform() { return uniformFromBits(bits()); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal() { return static_cast<double>(normalFromBits(bits())); }
  bool chance(double probability) { return uniform() < probability; }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }

 private:
  std::uint64_t key_;
  std::uint64_t count_ = 0;
};

}  // namespace fail_aware
