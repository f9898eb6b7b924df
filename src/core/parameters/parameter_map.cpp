#include "core/parameters/parameter_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <numeric>
#include <sstream>

namespace fail_aware {
namespace {

std::string typeName(const ParameterValue& value) {
  static constexpr const char* kNames[] = {"a bool", "an int", "a number", "text", "a list of numbers"};
  return kNames[value.index()];
}

std::string described(const ParameterValue& value) {
  const std::string* text = std::get_if<std::string>(&value);
  return text == nullptr ? typeName(value) : "the text \"" + *text + '"';
}

/// How to write a number that yaml reads as text.
std::string numberHint(const ParameterValue& value) {
  const std::string* text = std::get_if<std::string>(&value);
  double number = 0.0;
  return text != nullptr && parseDouble(*text, number) ? "; write " + formatDouble(number) : "";
}

[[noreturn]] void throwWrongType(const std::string& key, const std::string& wanted, const std::string& given) {
  throw ParameterKeyError(key, key + ": must be " + wanted + ", not " + given);
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

bool startsWith(const std::string& text, const std::string& start) { return text.compare(0, start.size(), start) == 0; }

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// The known key that the user probably meant, or an empty string.
std::string nearestKey(const std::string& key, const std::vector<std::string>& known_keys) {
  if (key.empty()) return "";
  for (const std::string& known : known_keys) {
    if (endsWith(known, '.' + key)) return known;
  }
  std::string nearest;
  std::size_t nearest_distance = std::max<std::size_t>(2, key.size() / 3) + 1;
  for (const std::string& known : known_keys) {
    const std::size_t distance = editDistance(key, known);
    if (distance < nearest_distance) {
      nearest = known;
      nearest_distance = distance;
    }
  }
  return nearest;
}

using Fields = std::vector<detail::ParameterField>;

std::vector<std::string> keysOf(const Fields& fields) {
  std::vector<std::string> keys;
  keys.reserve(fields.size());
  for (const auto& field : fields) keys.push_back(field.key);
  return keys;
}

const detail::ParameterField& findField(const Fields& fields, const std::string& key) {
  for (const auto& field : fields) {
    if (field.key == key) return field;
  }
  for (const auto& field : fields) {
    if (startsWith(field.key, key + '.')) {
      throw ParameterKeyError(key, key + ": is a group of parameters, such as " + field.key);
    }
  }
  const std::string meant = nearestKey(key, keysOf(fields));
  throw ParameterKeyError(key, key + ": unknown parameter" + (meant.empty() ? "" : ", did you mean " + meant + "?"));
}

struct AssignValue {
  const std::string& key;
  const ParameterValue& value;

  template <class T>
  void operator()(T* target) const {
    if (const T* same = std::get_if<T>(&value)) {
      *target = *same;
    } else {
      throwWrongType(key, typeName(T{}), described(value));
    }
  }

  void operator()(double* target) const {
    if (const int* whole = std::get_if<int>(&value)) {
      *target = *whole;
    } else if (const double* number = std::get_if<double>(&value)) {
      if (std::isnan(*number)) throwWrongType(key, "a number", "NaN");
      *target = *number;
    } else {
      throwWrongType(key, "a number", described(value) + numberHint(value));
    }
  }

  void operator()(std::vector<double>* target) const {
    const auto* list = std::get_if<std::vector<double>>(&value);
    if (list == nullptr) throwWrongType(key, "a list of numbers", described(value));
    if (std::any_of(list->begin(), list->end(), [](double x) { return std::isnan(x); })) {
      throwWrongType(key, "a list of numbers", "one with NaN");
    }
    *target = *list;
  }
};

struct AssignText {
  const std::string& key;
  const std::string& text;

  [[noreturn]] void fail(const char* wanted) const { throwWrongType(key, wanted, '"' + text + '"'); }

  void operator()(bool* target) const {
    if (text != "true" && text != "false") fail("true or false");
    *target = text == "true";
  }
  void operator()(int* target) const {
    if (!parseInt(text, *target)) fail("an int");
  }
  void operator()(double* target) const {
    if (!parseDouble(text, *target)) fail("a number");
  }
  void operator()(std::string* target) const { *target = text; }
  void operator()(std::vector<double>* target) const {
    if (text.size() < 2 || text.front() != '[' || text.back() != ']') fail("numbers in [a, b, c]");
    const std::string inside = trimmed(text.substr(1, text.size() - 2));
    std::vector<double> numbers;
    for (std::size_t begin = 0; !inside.empty() && begin <= inside.size();) {
      const std::size_t comma = std::min(inside.find(',', begin), inside.size());
      double number = 0.0;
      if (!parseDouble(trimmed(inside.substr(begin, comma - begin)), number)) fail("numbers in [a, b, c]");
      numbers.push_back(number);
      begin = comma + 1;
    }
    *target = numbers;
  }
};

}  // namespace

namespace detail {

void assignFields(const std::vector<ParameterField>& fields, const ParameterMap& values, MissingKeys missing_keys) {
  for (const auto& [key, value] : values) std::visit(AssignValue{key, value}, findField(fields, key).target);
  if (missing_keys == MissingKeys::kKeep) return;
  for (const auto& field : fields) {
    if (values.count(field.key) == 0) throw ParameterKeyError(field.key, field.key + ": missing");
  }
}

void assignText(const std::vector<ParameterField>& fields, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw ParameterError("\"" + assignment + "\": must be key=value");
  }
  const std::string key = trimmed(assignment.substr(0, equals));
  const std::string text = trimmed(assignment.substr(equals + 1));
  std::visit(AssignText{key, text}, findField(fields, key).target);
}

}  // namespace detail

std::string trimmed(const std::string& text) {
  static constexpr const char* kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool parseInt(const std::string& text, int& value) {
  const std::size_t digits = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  if (digits == text.size() || text.find_first_not_of("0123456789", digits) != std::string::npos) return false;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  int parsed = 0;
  if (!(stream >> std::dec >> parsed)) return false;
  value = parsed;
  return true;
}

bool parseDouble(const std::string& text, double& value) {
  if (text == "inf" || text == "+inf" || text == "-inf") {
    value = std::copysign(std::numeric_limits<double>::infinity(), text[0] == '-' ? -1.0 : 1.0);
    return true;
  }
  if (text.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double parsed = 0.0;
  if (!(stream >> parsed) || stream.peek() != std::istringstream::traits_type::eof()) return false;
  value = parsed;
  return true;
}

std::string formatDouble(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  const double size = std::abs(value);
  const int whole_digits = size >= 1.0 && size < 1e9 ? static_cast<int>(std::log10(size)) + 1 : 1;
  std::string text;
  for (int digits = whole_digits; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(digits);
    stream << value;
    text = stream.str();
    double read_back = 0.0;
    if (parseDouble(text, read_back) && read_back == value) break;
  }
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

}  // namespace fail_aware
