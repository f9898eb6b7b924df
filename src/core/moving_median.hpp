// The median of the last values, up to a fixed number of them. Outliers do not move it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

namespace fail_aware {

class MovingMedian {
 public:
  explicit MovingMedian(std::size_t window) : window_(window) {}

  void add(double value) {
    values_.push_back(value);
    if (values_.size() > window_) values_.pop_front();
  }
  void clear() { values_.clear(); }
  std::size_t size() const { return values_.size(); }
  bool isFull() const { return values_.size() == window_; }

  /// The upper of the two middle values if their number is even; 0 without values.
  double median() const {
    if (values_.empty()) return 0.0;
    std::vector<double> sorted(values_.begin(), values_.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }

 private:
  std::size_t window_;
  std::deque<double> values_;
};

}  // namespace fail_aware
