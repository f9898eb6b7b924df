// Shared by the command line tools: exit codes, one-line errors, the closing verdict, a progress bar.
//
// Exit codes: 0 the work is done, 1 it failed, 2 the arguments or the input are unusable.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstddef>
#include <exception>
#include <limits>
#include <ostream>
#include <string>

#include "core/io/input_error.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/parameter_map.hpp"

namespace fail_aware {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

/// "1 sweep", "2 sweeps".
std::string counted(std::size_t count, const std::string& noun);

/// One line "NAME: error: MESSAGE" on stderr; line breaks in the message become spaces. Returns `exit_code`.
int reportError(const std::string& name, std::string message, int exit_code);

/// How a user calls a tool of this build: by rosrun, or without ROS by its name.
std::string callOf(const std::string& tool);

/// The two lines that close a run, on stderr: "NAME: VERDICT" and "NAME: next: NEXT".
void reportVerdict(const std::string& name, const std::string& verdict, const std::string& next);

/// Ends a calibration. Writes `fitted` as yaml to stdout and, if `output` is not empty, to that file. On stderr: a line
/// "NAME: KEY: OLD -> NEW" for each number that differs from `given`, then `verdict` and what to do next.
void reportFitted(const std::string& name, const ParameterList& given, const ParameterList& fitted,
                  const std::string& output, const std::string& verdict);

/// Runs `work` (returns an exit code) and turns exceptions into a line and an exit code.
template <class Work>
int runTool(const std::string& name, Work&& work) {
  try {
    return work();
  } catch (const InputError& error) {
    return reportError(name, error.what(), kExitUsage);
  } catch (const ParameterError& error) {
    return reportError(name, error.what(), kExitUsage);
  } catch (const std::exception& error) {
    return reportError(name, error.what(), kExitFailed);
  } catch (...) {
    return reportError(name, "unknown failure", kExitFailed);
  }
}

/// The range of a numeric option, ends included. The error names option, value, limits. Refuses text, nan and inf.
/// A whole number is decimal, whatever zeros it begins with, if the option uses it by transform() in place of check().
CLI::Validator wholeNumber(long low, long high = std::numeric_limits<long>::max());
CLI::Validator realNumber(double low, double high = std::numeric_limits<double>::max());
CLI::Validator positiveNumber();

/// Some of a drive's scans: --first, --count.
struct ScanRange {
  long first = 0, count = -1;  ///< count < 0: to the end

  void addOptions(CLI::App& app);
  /// The scan after the last of them. Throws InputError, naming `drive`, if there is none.
  long end(std::size_t scans, const std::string& drive) const;
};

/// Parses into `app`'s options; throws InputError for bad ones. False: help was requested and printed.
bool parseArguments(CLI::App& app, int argc, const char* const* argv);

/// "120/271 (44 %), 9.8 per s, 0:15 left"
std::string progressText(std::size_t done, std::size_t total, double elapsed_s);

/// So many bad scans are named on stderr; the others are counted.
constexpr std::size_t kBadScansNamed = 5;

/// A line on stderr that is redrawn at most ten times a second; silent if stderr is not a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::size_t total);
  ProgressBar(std::size_t total, std::ostream& out, bool visible);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  void update(std::size_t done);

  /// Keeps the line and goes to the next one, so that a later error message starts on its own line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(std::size_t done, double elapsed_s);

  std::size_t total_;
  std::ostream& out_;
  bool visible_;
  bool drawn_ = false;
  Clock::time_point begin_;
  Clock::time_point last_draw_;
};

}  // namespace fail_aware
