// Runs one of the package's plot scripts on a folder of results.
#pragma once

#include <filesystem>
#include <string>

namespace fail_aware {

/// Looks in $FAIL_AWARE_SCRIPTS_DIR, else beside this executable, else where the build says. Plots are a convenience:
/// what keeps them from being drawn is said in one line on stderr ("TOOL: no plots: ...") and is no failure.
void runPlotScript(const std::string& tool, const std::string& script_name, const std::filesystem::path& folder);

}  // namespace fail_aware
