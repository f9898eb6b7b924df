// A fuzzer's bytes as numbers, texts and choices, read from front to back; zeros once they are used up. Written out
// here and not taken from clang, so that the corpus means the same to every compiler.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace fail_aware {

class FuzzInput {
 public:
  FuzzInput(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  /// Any value of an arithmetic type: for a double any bits, NaN and infinity among them.
  template <class T>
  T any() {
    T value{};
    take(&value, sizeof value);
    return value;
  }

  std::uint32_t below(std::uint32_t end) {
    return end <= 256     ? any<std::uint8_t>() % end
           : end <= 65536 ? any<std::uint16_t>() % end
                          : any<std::uint32_t>() % end;
  }
  bool flag() { return below(2) != 0; }
  bool oneIn(std::uint32_t n) { return below(n) == n - 1; }

  /// In [low, high].
  double within(double low, double high) { return low + (high - low) * any<std::uint16_t>() / 65535.0; }

  template <class T, std::size_t N>
  T pick(const T (&values)[N]) {
    return values[below(N)];
  }

  std::string text(std::uint32_t longest) {
    std::string text(std::min<std::size_t>(below(longest + 1), left_), '\0');
    take(text.data(), text.size());
    return text;
  }

  std::string rest() {
    std::string text(left_, '\0');
    take(text.data(), text.size());
    return text;
  }

 private:
  void take(void* to, std::size_t size) {
    size = std::min(size, left_);
    if (size == 0) return;
    std::memcpy(to, data_, size);
    data_ += size;
    left_ -= size;
  }

  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace fail_aware
