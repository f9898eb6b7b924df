// Visits every index of [0, n) once, in a fixed order that looks shuffled.
//
// A sweep's points come in the order of the head's rotation. A filter that keeps the first point of a cell would always
// keep the one on the side where the beam enters, and a map of such points rotates slowly relative to the sweeps: about
// 0.2 deg per km.
// Cost: a counter through a bijective mix of its bits, at most 2 n times.
#pragma once

#include <cstdint>

namespace fail_aware {

class ScatteredOrder {
 public:
  explicit ScatteredOrder(std::uint32_t n) : n_(n) {
    while ((std::uint64_t{1} << bits_) < n) ++bits_;
    mask_ = static_cast<std::uint32_t>((std::uint64_t{1} << bits_) - 1);
  }

  /// The next index; the order repeats after n indices. n must not be 0.
  std::uint32_t next() {
    std::uint32_t index;
    do {
      index = mixed(counter_++ & mask_);
    } while (index >= n_);
    return index;
  }

 private:
  // Each step is a bijection of numbers of `bits_` bits.
  std::uint32_t mixed(std::uint32_t x) const {
    const unsigned half = (bits_ + 1) / 2;
    x = (x * 0x9e3779b1u + 0x7f4a7c15u) & mask_;
    x ^= x >> half;
    x = (x * 0x85ebca6bu) & mask_;
    x ^= x >> half;
    x = (x * 0xc2b2ae35u) & mask_;
    return x ^ (x >> half);
  }

  std::uint32_t n_;
  unsigned bits_ = 1;  ///< n <= 2^bits_
  std::uint32_t mask_ = 1;
  std::uint32_t counter_ = 0;
};

}  // namespace fail_aware
