#include "simulation/scene_kind.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "core/geometry/degree.hpp"
#include "core/parameters/check.hpp"

namespace fail_aware {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kShortest_m = 30.0;  // for a part without a length
constexpr double kMeanSpeed = 0.6;    // mean speed as a ratio of the limit
constexpr SceneKind kKinds[] = {SceneKind::kTown, SceneKind::kCountry, SceneKind::kHighway, SceneKind::kTunnel,
                                SceneKind::kOpen};

SceneKind parseKind(const std::string& name, const std::string& text) {
  for (SceneKind kind : kKinds) {
    if (name == toString(kind)) return kind;
  }
  throw ParameterError("scene = " + text + ": '" + name + "' is none of town, country, highway, tunnel, open");
}

}  // namespace

const char* toString(SceneKind kind) {
  switch (kind) {
    case SceneKind::kTown: return "town";
    case SceneKind::kCountry: return "country";
    case SceneKind::kHighway: return "highway";
    case SceneKind::kTunnel: return "tunnel";
    case SceneKind::kOpen: return "open";
  }
  return "unknown";
}

const RoadCharacter& roadCharacter(SceneKind kind) {
  static const RoadCharacter town{12.5,        5.5,          1.75, 0.012, 50,    140, 60, 160,
                                  8 * kDegree, 30 * kDegree, 0.45, 260,   0.012, 14,  0,  true};
  static const RoadCharacter country{19.0,         3.5,          1.7, 0.028, 40,    160, 90, 350,
                                     10 * kDegree, 50 * kDegree, 0.0, 0,     0.045, 6,   0,  false};
  static const RoadCharacter highway{28.0,        11.5,         5.4, 0.015, 150,   500, 700, 2000,
                                     6 * kDegree, 25 * kDegree, 0.0, 0,     0.045, 22,  8,   true};
  static const RoadCharacter tunnel{18.0,        4.6,          1.9, 0.008, 100,  400, 500, 1500,
                                    4 * kDegree, 18 * kDegree, 0.0, 0,     0.01, 10,  0,   true};
  static const RoadCharacter open{22.0,        3.5,          1.7, 0.012, 150,   400, 250, 800,
                                  8 * kDegree, 35 * kDegree, 0.0, 0,     0.035, 4,   0,   false};
  switch (kind) {
    case SceneKind::kTown: return town;
    case SceneKind::kCountry: return country;
    case SceneKind::kHighway: return highway;
    case SceneKind::kTunnel: return tunnel;
    case SceneKind::kOpen: return open;
  }
  return town;
}

ScenePlan ScenePlan::parse(const std::string& text, double duration_s) {
  requirePositive("duration_s", duration_s);
  ScenePlan plan;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const std::size_t colon = word.find(':');
    ScenePart part;
    part.kind = parseKind(word.substr(0, colon), text);
    if (colon != std::string::npos) {
      char* end = nullptr;
      part.length_m = std::strtod(word.c_str() + colon + 1, &end);
      if (end == word.c_str() + colon + 1 || *end != '\0' || !std::isfinite(part.length_m) || part.length_m <= 0.0) {
        throw ParameterError("scene = " + text + ": '" + word + "': the length must be a number of metres > 0");
      }
    }
    plan.parts_.push_back(part);
  }
  if (plan.parts_.empty() || text.back() == ',') throw ParameterError("scene = " + text + ": a part is empty");
  const double ratio_s = duration_s / static_cast<double>(plan.parts_.size());
  for (ScenePart& part : plan.parts_) {
    const double mean_mps = kMeanSpeed * roadCharacter(part.kind).speed_mps;
    if (part.length_m == 0.0) part.length_m = std::max(ratio_s * mean_mps, kShortest_m);
  }
  plan.parts_.back().length_m = kInfinity;
  return plan;
}

SceneKind ScenePlan::kindAt(double s_m) const {
  for (const ScenePart& part : parts_) {
    if (s_m < part.length_m) return part.kind;
    s_m -= part.length_m;
  }
  return parts_.back().kind;
}

ScenePlan::Range ScenePlan::partAt(double s_m) const {
  double begin_m = 0.0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const double end_m = begin_m + parts_[i].length_m;
    if (s_m < end_m) return {i == 0 ? -kInfinity : begin_m, end_m};
    begin_m = end_m;
  }
  return {-kInfinity, kInfinity};
}

double ScenePlan::grade() const {
  double grade = kInfinity;
  for (const ScenePart& part : parts_) grade = std::min(grade, roadCharacter(part.kind).grade);
  return grade;
}

}  // namespace fail_aware
