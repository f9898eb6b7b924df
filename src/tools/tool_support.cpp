#include "tool_support.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <sstream>
#include <type_traits>
#include <variant>

#include "core/parameters/yaml_parameters.hpp"
#include "result_files.hpp"

namespace fail_aware {

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + ' ' + noun + (count == 1 ? "" : "s");
}

int reportError(const std::string& name, std::string message, int exit_code) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (char& c : message) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::cerr << name << ": error: " << message << std::endl;
  return exit_code;
}

std::string callOf(const std::string& tool) {
#ifdef FAIL_AWARE_WITH_BAGS
  return "rosrun fail_aware_lidar_odometry " + tool;
#else
  return tool;
#endif
}

void reportVerdict(const std::string& name, const std::string& verdict, const std::string& next) {
  std::cerr << name << ": " << verdict << '\n' << name << ": next: " << next << std::endl;
}

void reportFitted(const std::string& name, const ParameterList& given, const ParameterList& fitted,
                  const std::string& output, const std::string& verdict) {
  printAndKeep(formatYaml(fitted), output);
  for (const auto& [key, value] : fitted) {
    for (const auto& [given_key, before] : given) {
      const double *const was = std::get_if<double>(&before), *const is = std::get_if<double>(&value);
      if (given_key == key && was && is && *was != *is)
        std::cerr << name << ": " << key << ": " << *was << " -> " << *is << '\n';
    }
  }
  reportVerdict(name, verdict,
                "judge it on other runs: evaluate_fail_aware --parameters " +
                    (output.empty() ? "FILE (--output FILE keeps it)" : output));
}

namespace {

/// "from LOW on" or "from LOW to HIGH".
template <class Value>
std::string limits(Value low, Value high) {
  std::ostringstream text;
  text << "from " << low;
  if (high == std::numeric_limits<Value>::max()) return text.str() + " on";
  text << " to " << high;
  return text.str();
}

/// `parse` returns the number or nothing; `fits` checks the limits. A whole number is written back: CLI11 would take
/// one that begins with a zero, as KITTI's names do, for octal.
template <class Parse, class Fits>
CLI::Validator checked(const std::string& limits, Parse&& parse, Fits&& fits) {
  const auto check = [=](std::string& text) {
    const auto value = parse(text);
    if (!value || !fits(*value)) return "'" + text + "' is not " + limits;
    if constexpr (std::is_integral_v<std::decay_t<decltype(*value)>>) text = std::to_string(*value);
    return std::string();
  };
  return CLI::Validator(check, std::string());
}

std::optional<long> wholeNumberIn(const std::string& text) {
  char* end = nullptr;
  errno = 0;
  const long value = std::strtol(text.c_str(), &end, 10);
  return text.empty() || *end != '\0' || errno != 0 ? std::nullopt : std::optional<long>(value);
}

std::optional<double> numberIn(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' || !std::isfinite(value) ? std::nullopt : std::optional<double>(value);
}

}  // namespace

CLI::Validator wholeNumber(long low, long high) {
  return checked("a whole number " + limits(low, high), wholeNumberIn,
                 [=](long value) { return value >= low && value <= high; });
}

CLI::Validator realNumber(double low, double high) {
  return checked("a number " + limits(low, high), numberIn,
                 [=](double value) { return value >= low && value <= high; });
}

CLI::Validator positiveNumber() {
  return checked("a number above 0", numberIn, [](double value) { return value > 0.0; });
}

void ScanRange::addOptions(CLI::App& app) {
  app.add_option("--first", first, "first scan, counted from 0")->transform(wholeNumber(0));
  app.add_option("--count", count, "number of scans (default: all)")->transform(wholeNumber(1));
}

long ScanRange::end(std::size_t scans, const std::string& drive) const {
  const auto all = static_cast<long>(scans);
  if (first >= all) {
    throw InputError("--first " + std::to_string(first) + ": " + drive + " has " + std::to_string(all) + " scans");
  }
  return count < 0 ? all : first + std::min(all - first, count);
}

bool parseArguments(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help() << std::flush;
    return false;
  } catch (const CLI::ParseError& error) {
    // CLI11 misses a required option first, which may be the one that is misspelt
    if (const std::vector<std::string> unknown = app.remaining(); !unknown.empty()) {
      throw InputError(std::string(CLI::ExtrasError(unknown).what()) + " (see --help)");
    }
    throw InputError(std::string(error.what()) + " (see --help)");
  }
}

std::string progressText(std::size_t done, std::size_t total, double elapsed_s) {
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

ProgressBar::ProgressBar(std::size_t total) : ProgressBar(total, std::cerr, isatty(STDERR_FILENO) != 0) {}

ProgressBar::ProgressBar(std::size_t total, std::ostream& out, bool visible)
    : total_(total), out_(out), visible_(visible), begin_(Clock::now()) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(std::size_t done) {
  if (!visible_) return;
  const Clock::time_point now = Clock::now();
  if (drawn_ && done < total_ && now - last_draw_ < std::chrono::milliseconds(100)) return;
  drawn_ = true;
  last_draw_ = now;
  draw(done, std::chrono::duration<double>(now - begin_).count());
}

void ProgressBar::finish() {
  if (drawn_ && visible_) out_ << std::endl;
  visible_ = false;
}

void ProgressBar::draw(std::size_t done, double elapsed_s) {
  constexpr std::size_t kWidth = 24;
  const std::size_t filled = total_ == 0 ? kWidth : std::min(kWidth, done * kWidth / total_);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  out_ << "\r[" << bar << "] " << progressText(done, total_, elapsed_s) << "\033[K" << std::flush;
}

}  // namespace fail_aware
