// Measures the time of one stage after the other. Cost: a read of the steady clock.
#pragma once

#include <chrono>
#include <utility>

namespace fail_aware {

class Stopwatch {
 public:
  /// Time since the last call, or since the construction.
  double lapMs() {
    const auto begin = std::exchange(last_, std::chrono::steady_clock::now());
    return std::chrono::duration<double, std::milli>(last_ - begin).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace fail_aware
