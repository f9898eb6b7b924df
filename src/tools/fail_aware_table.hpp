// The reports of fail_aware_report.hpp as a table for people.
#pragma once

#include <ostream>

#include "json.hpp"

namespace fail_aware {

/// One column a report, in the order of the keys, which name the columns.
void printTable(std::ostream& out, const Json& reports_by_name);

}  // namespace fail_aware
