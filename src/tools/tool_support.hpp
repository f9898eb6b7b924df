// What the command line tools share: exit codes, one-line errors, a progress bar.
//
// Exit codes: 0 the work is done, 1 it failed, 2 the arguments or the input are unusable.
#pragma once

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>

#include "fail_aware_lidar_odometry/core/io/input_error.hpp"
#include "fail_aware_lidar_odometry/core/parameters/check.hpp"

namespace fail_aware {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

/// One line "NAME: error: MESSAGE" on stderr; line breaks in the message become spaces. Returns `exit_code`.
inline int reportError(const std::string& name, std::string message, int exit_code) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (char& c : message) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::cerr << name << ": error: " << message << std::endl;
  return exit_code;
}

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

/// Parses into `app`'s options; throws InputError for bad ones. False: help was asked for and printed.
inline bool parseArguments(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help() << std::flush;
    return false;
  } catch (const CLI::ParseError& error) {
    throw InputError(std::string(error.what()) + " (see --help)");
  }
}

/// "120/271 (44 %), 9.8 per s, 0:15 left"
inline std::string progressText(std::size_t done, std::size_t total, double elapsed_s) {
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
  std::ostringstream text;
  text << done << '/' << total << " (" << (total == 0 ? 100 : done * 100 / total) << " %)";
  if (rate > 0.0) {
    const long left_s = done >= total ? 0 : std::lround(static_cast<double>(total - done) / rate);
    char rate_and_left[96];
    std::snprintf(rate_and_left, sizeof(rate_and_left), ", %.1f per s, %ld:%02ld left", rate, left_s / 60, left_s % 60);
    text << rate_and_left;
  }
  return text.str();
}

/// A line on stderr that is redrawn at most ten times a second; silent where stderr is no terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::size_t total) : ProgressBar(total, std::cerr, isatty(STDERR_FILENO) != 0) {}
  ProgressBar(std::size_t total, std::ostream& out, bool visible)
      : total_(total), out_(out), visible_(visible), begin_(Clock::now()) {}
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { finish(); }

  void update(std::size_t done) {
    if (!visible_) return;
    const Clock::time_point now = Clock::now();
    if (drawn_ && done < total_ && now - last_draw_ < std::chrono::milliseconds(100)) return;
    drawn_ = true;
    last_draw_ = now;
    draw(done, std::chrono::duration<double>(now - begin_).count());
  }

  /// Leaves the line as it is and goes to the next; a later error message starts on a line of its own.
  void finish() {
    if (drawn_ && visible_) out_ << std::endl;
    visible_ = false;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void draw(std::size_t done, double elapsed_s) {
    constexpr std::size_t kWidth = 24;
    const std::size_t filled = total_ == 0 ? kWidth : std::min(kWidth, done * kWidth / total_);
    const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
    out_ << "\r[" << bar << "] " << progressText(done, total_, elapsed_s) << "\033[K" << std::flush;
  }

  std::size_t total_;
  std::ostream& out_;
  bool visible_;
  bool drawn_ = false;
  Clock::time_point begin_;
  Clock::time_point last_draw_;
};

}  // namespace fail_aware
