// The tools' JSON: members keep the order in which they were written. nlohmann-json supports this since 3.9; with an
// older one (Ubuntu 20.04: 3.7) they are in alphabetical order.
#pragma once

#include <nlohmann/json.hpp>

namespace fail_aware {

#if NLOHMANN_JSON_VERSION_MAJOR > 3 || NLOHMANN_JSON_VERSION_MINOR >= 9
using Json = nlohmann::ordered_json;
#else
using Json = nlohmann::json;
#endif

}  // namespace fail_aware
