// Checks of parameters (validate.hpp). They throw, naming field, value and rule.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace fail_aware {

/// An invalid parameter. what() is one line: name, value, rule.
class ParameterError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

template <class T>
void requireParameter(bool holds, const char* name, const T& value, const char* rule) {
  if (holds) return;
  std::ostringstream text;
  text << std::boolalpha << name << " = " << value << ": must be " << rule;
  throw ParameterError(text.str());
}

/// A rule between two keys: `other_value` is that of the key that the rule names last.
template <class T, class Other>
void requireParameter(bool holds, const char* name, const T& value, const std::string& rule, const Other& other_value) {
  if (holds) return;
  std::ostringstream text;
  text << rule << ", which is " << other_value;
  requireParameter(false, name, value, text.str().c_str());
}

inline void requireWithin(const char* name, double value, double low, double high) {
  if (std::isfinite(value) && value >= low && value <= high) return;
  std::ostringstream rule;
  rule << "in [" << low << ", " << high << "]";
  requireParameter(false, name, value, rule.str().c_str());
}

/// The same as a check to be named beside a key.
inline auto within(double low, double high) {
  return [low, high](const char* name, double value) { requireWithin(name, value, low, high); };
}

inline void requireFiniteNumbers(const char* name, const std::vector<double>& values, std::size_t count) {
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() == count && finite) return;
  throw ParameterError(std::string(name) + ": must be " + std::to_string(count) + " finite numbers, " +
                       (finite ? "has " + std::to_string(values.size()) : "has one that is not"));
}

// For every parameter: its square and its inverse stay finite and nonzero.
constexpr double kSmallestParameter = 1e-12, kLargestParameter = 1e9;

inline void requirePositive(const char* name, double value) {
  requireParameter(std::isfinite(value) && value > 0.0, name, value, "finite and > 0");
  requireWithin(name, value, kSmallestParameter, kLargestParameter);
}

inline void requireNotNegative(const char* name, double value) {
  requireParameter(std::isfinite(value) && value >= 0.0, name, value, "finite and >= 0");
  requireWithin(name, value, 0.0, kLargestParameter);
}

}  // namespace fail_aware
