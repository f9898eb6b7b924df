// Validates a tree of parameter structs; the error names the dotted key.
#pragma once

#include <string>
#include <type_traits>

#include "core/parameters/check.hpp"
#include "core/parameters/parameter_map.hpp"

namespace fail_aware {

// The structs name their fields without a prefix; this function adds the prefix to the message. Innermost structs come
// first, so a struct that also checks its nested structs without the prefix finds no more errors in them.
template <class Params>
void validateAs(const std::string& prefix, const Params& params) {
  // maybe_unused: g++ 9 sees no use if `if constexpr` drops it
  Params::visit(params, [&]([[maybe_unused]] const char* name, [[maybe_unused]] const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (!detail::is_parameter_value<Field>) validateAs(prefix + name + '.', field);
  });
  try {
    params.validate();
  } catch (const ParameterError& error) {
    throw ParameterError(prefix + error.what());
  }
}

template <class Params>
void validateNested(const Params& params) {
  Params::visit(params, []([[maybe_unused]] const char* name, [[maybe_unused]] const auto& field) {
    using Field = std::decay_t<decltype(field)>;
    if constexpr (!detail::is_parameter_value<Field>) validateAs(std::string(name) + '.', field);
  });
}

}  // namespace fail_aware
