#include "simulation/fault.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <limits>
#include <sstream>

#include "core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kToTheEnd = std::numeric_limits<double>::infinity();

double parseNumber(const std::string& word, const std::string& text, const char* name) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0' || std::isnan(value)) {
    throw ParameterError("fault = " + text + ": " + name + " '" + word + "' is not a number");
  }
  return value;
}

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

const std::vector<FaultTraits>& faultTraits() {
  static const std::vector<FaultTraits> table = {
      {FaultKind::kBlankedSector, "blanked_sector", "nothing in a sector ahead; its width in deg", 180, 1, 360, 5},
      {FaultKind::kLostRings, "lost_rings", "dead beams; ratio of all", 0.75, 0, 1, 5},
      {FaultKind::kRangeCap, "range_cap", "fog: nothing beyond this range in m", 10, 1, 120, 5},
      {FaultKind::kNoise, "noise", "noise on each coordinate; standard deviation in m", 0.2, 0, 10, 5},
      {FaultKind::kGhostPoints, "ghost_points", "false returns (rain, spray); ratio to the true ones", 0.3, 0, 1, 5},
      {FaultKind::kFrozenCloud, "frozen_cloud", "the points of the last sweep before, with new stamps", 1, 1, 1, 3},
      {FaultKind::kHalfSweep, "half_sweep", "the sweep ends early; ratio that is left", 0.5, 0, 1, 5},
      {FaultKind::kDropped, "dropped", "sweeps that never arrive; share", 1, 0, 1, 1},
      {FaultKind::kDuplicated, "duplicated", "sweeps that arrive twice, same stamp; share", 1, 0, 1, 3},
      {FaultKind::kReordered, "reordered", "pairs of sweeps swapped; share", 1, 0, 1, 3},
      {FaultKind::kStampJump, "stamp_jump", "stamps off by this many s, forward or (negative) back", 5, -1e6, 1e6,
       kToTheEnd},
      {FaultKind::kStampJitter, "stamp_jitter", "noise on the stamps; standard deviation in s", 0.003, 0, 0.02,
       kToTheEnd},
      {FaultKind::kTimeSign, "time_sign", "point times with the wrong sign", 1, 1, 1, kToTheEnd},
      {FaultKind::kTiltedMount, "tilted_mount", "the lidar tilts forward by this many deg, and half that to the right",
       3, -30, 30, kToTheEnd},
      {FaultKind::kDenseTraffic, "dense_traffic", "vehicles close around that move with the car; their number", 12, 1,
       60, 20},
      {FaultKind::kEmptyCloud, "empty_cloud", "clouds without a point", 1, 1, 1, 2},
      {FaultKind::kNan, "nan", "coordinates that are NaN; ratio of the points", 1, 0, 1, 2},
  };
  return table;
}

const FaultTraits& faultTraits(FaultKind kind) {
  const auto& table = faultTraits();
  return *std::find_if(table.begin(), table.end(), [&](const FaultTraits& traits) { return traits.kind == kind; });
}

Fault Fault::parse(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ':');) words.push_back(word);
  const auto& table = faultTraits();
  const auto traits = std::find_if(table.begin(), table.end(),
                                   [&](const FaultTraits& t) { return !words.empty() && words[0] == t.name; });
  if (traits == table.end() || words.size() > 4) {
    std::string names;
    for (const FaultTraits& t : table) names += std::string(names.empty() ? "" : ", ") + t.name;
    throw ParameterError("fault = " + text + ": must be KIND[:START[:DURATION[:SEVERITY]]], KIND one of " + names);
  }
  Fault fault;
  fault.kind = traits->kind;
  fault.duration_s = traits->duration_s;
  fault.severity = traits->severity;
  if (words.size() > 1) fault.start_s = parseNumber(words[1], text, "start");
  if (words.size() > 2 && !words[2].empty()) {
    const double duration_s = parseNumber(words[2], text, "duration");
    if (duration_s != 0.0) fault.duration_s = duration_s;
  }
  if (words.size() > 3) fault.severity = parseNumber(words[3], text, "severity");
  if (!std::isfinite(fault.start_s) || fault.start_s < 0.0 || fault.duration_s <= 0.0) {
    throw ParameterError("fault = " + text + ": start must be >= 0 and duration > 0");
  }
  if (fault.severity < traits->min_severity || fault.severity > traits->max_severity) {
    throw ParameterError("fault = " + text + ": severity (" + traits->meaning + ") must be in [" +
                         number(traits->min_severity) + ", " + number(traits->max_severity) + "]");
  }
  return fault;
}

std::string faultHelp() {
  std::ostringstream text;
  for (const FaultTraits& traits : faultTraits()) {
    text << "  " << std::left << std::setw(15) << traits.name << " " << traits.meaning;
    if (traits.min_severity < traits.max_severity) text << " (" << traits.severity << ")";
    text << "; " << (std::isfinite(traits.duration_s) ? number(traits.duration_s) + " s" : "to the end") << "\n";
  }
  return text.str();
}

int vehiclesAround(const std::vector<Fault>& faults, double begin_s) {
  double count = 0.0;
  for (const Fault& fault : faults) {
    if (fault.kind == FaultKind::kDenseTraffic && fault.active(begin_s)) count = std::max(count, fault.severity);
  }
  return static_cast<int>(std::lround(count));
}

}  // namespace fail_aware
