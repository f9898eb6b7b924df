// Validates a tree of parameter structs; the error names the dotted key.
//
// A struct's visit() gives a value's check beside its key: v("name", self.name, within(0.0, 1.0)); check.hpp has some.
// What concerns several values is in the struct's checkRules(), if it has one.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "core/parameters/check.hpp"
#include "core/parameters/parameter_map.hpp"

namespace fail_aware {

namespace detail {

template <class Params, class = void>
constexpr bool has_rules = false;
template <class Params>
constexpr bool has_rules<Params, std::void_t<decltype(std::declval<const Params&>().checkRules())>> = true;

}  // namespace detail

/// Throws ParameterError. Nested structs come first, and checks of values before rules of several.
template <class Params>
void validate(const Params& params, const std::string& prefix = "") {
  // maybe_unused: g++ 9 sees no use if `if constexpr` drops it
  const auto visit = [&](const char* name, [[maybe_unused]] const auto& field, [[maybe_unused]] const auto&... check) {
    using Field = std::decay_t<decltype(field)>;
    const std::string key = prefix + name;
    if constexpr (!detail::is_parameter_value<Field>) validate(field, key + '.');
    (check(key.c_str(), field), ...);
  };
  Params::visit(params, visit);
  if constexpr (detail::has_rules<Params>) {
    try {
      params.checkRules();
    } catch (const ParameterError& error) {
      throw ParameterError(prefix + error.what());
    }
  }
}

}  // namespace fail_aware
