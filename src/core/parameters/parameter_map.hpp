// Parameter structs <-> a flat map of named values, shared by yaml files, `--set key=value` and the parameter server.
//
// A struct has a `template <class Self, class Visitor> static void visit(Self&, Visitor&&)` that calls the visitor with
// every field's name, the field and, if it has one, its check (validate.hpp). Fields are bool, int, double,
// std::string, std::vector<double> or a nested struct with its own visit; nested names are joined with dots
// ("fusion.gate_sigma"). A field that visit leaves out is a constant: no file sets it, and the reason for its value is
// beside it. Failure: ParameterError naming the key; the struct is then unchanged. Values are not validated.
#pragma once

#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/parameters/check.hpp"

namespace fail_aware {

using ParameterValue = std::variant<bool, int, double, std::string, std::vector<double>>;
using ParameterMap = std::map<std::string, ParameterValue>;
/// In the struct's order.
using ParameterList = std::vector<std::pair<std::string, ParameterValue>>;

/// A ParameterError about one key, for callers that know where the key was written.
class ParameterKeyError : public ParameterError {
 public:
  ParameterKeyError(std::string key, const std::string& text) : ParameterError(text), key_(std::move(key)) {}
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

enum class MissingKeys {
  kRefuse,  ///< the map must name every field
  kKeep     ///< fields that the map does not name keep their value
};

namespace detail {

/// A leaf field with its dotted key.
struct ParameterField {
  std::string key;
  std::variant<bool*, int*, double*, std::string*, std::vector<double>*> target;
};

template <class T>
constexpr bool is_parameter_value = std::is_same_v<T, bool> || std::is_same_v<T, int> || std::is_same_v<T, double> ||
                                    std::is_same_v<T, std::string> || std::is_same_v<T, std::vector<double>>;

template <class Struct, class Handler>
void visitLeaves(Struct& parameters, const std::string& prefix, const Handler& handler) {
  Struct::visit(parameters, [&](const char* name, auto& field, const auto&... /*check*/) {
    using Field = std::remove_const_t<std::remove_reference_t<decltype(field)>>;
    if constexpr (is_parameter_value<Field>) {
      handler(prefix + name, field);
    } else {
      static_assert(std::is_class_v<Field>,
                    "a parameter is bool, int, double, std::string, std::vector<double> or a struct");
      visitLeaves(field, prefix + name + '.', handler);
    }
  });
}

template <class Struct>
std::vector<ParameterField> fieldsOf(Struct& parameters) {
  std::vector<ParameterField> fields;
  visitLeaves(parameters, "", [&](const std::string& key, auto& field) { fields.push_back({key, &field}); });
  return fields;
}

void assignFields(const std::vector<ParameterField>& fields, const ParameterMap& values, MissingKeys missing_keys);
void assignText(const std::vector<ParameterField>& fields, const std::string& assignment);

}  // namespace detail

template <class Struct>
ParameterList toList(const Struct& parameters) {
  ParameterList list;
  detail::visitLeaves(parameters, "",
                      [&](const std::string& key, const auto& field) { list.emplace_back(key, field); });
  return list;
}

template <class Struct>
ParameterMap toMap(const Struct& parameters) {
  const ParameterList list = toList(parameters);
  return ParameterMap(list.begin(), list.end());
}

/// Refuses unknown keys, values of another type (except an int for a double) and NaN; missing keys as `missing_keys`.
template <class Struct>
void fromMap(Struct& parameters, const ParameterMap& values, MissingKeys missing_keys = MissingKeys::kRefuse) {
  Struct updated = parameters;
  detail::assignFields(detail::fieldsOf(updated), values, missing_keys);
  parameters = std::move(updated);
}

/// Sets one field from text, "fusion.gate_sigma=3.0". The field's type decides how the text is read: true|false, an
/// integer, a number (inf and -inf too), plain text, or numbers in [a, b, c].
template <class Struct>
void setParameter(Struct& parameters, const std::string& assignment) {
  Struct updated = parameters;
  detail::assignText(detail::fieldsOf(updated), assignment);
  parameters = std::move(updated);
}

/// Without the blanks at both ends.
std::string trimmed(const std::string& text);

/// Whole text -> number, independent of the locale; false if it is not a number or out of range. Never NaN.
bool parseInt(const std::string& text, int& value);
bool parseDouble(const std::string& text, double& value);

/// The shortest text that reads back as the same double, always with a dot ("1.0", "1.0e-07", "inf").
std::string formatDouble(double value);

}  // namespace fail_aware
