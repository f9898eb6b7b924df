#include "simulation/lidar_head.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace fail_aware {

namespace {

using Elevations = std::vector<double>;

Elevations evenly(int beams, double lowest_deg, double highest_deg) {
  Elevations elevations;
  for (int ring = 0; ring < beams; ++ring)
    elevations.push_back(lowest_deg + (highest_deg - lowest_deg) * ring / (beams - 1));
  return elevations;
}

Elevations hdl64e() {
  Elevations elevations;
  for (int ring = 0; ring < 32; ++ring) elevations.push_back(-8.83 - 15.5 + 0.5 * ring);
  for (int ring = 32; ring < 64; ++ring) elevations.push_back(2.0 - (63 - ring) / 3.0);
  return elevations;
}

Elevations vlp32c() {
  Elevations elevations = {-25.0, -15.639, -11.31, -8.843, -7.254, -6.148, -5.333, -4.667};
  for (int step = -12; step <= 5; ++step) elevations.push_back(step / 3.0);
  elevations.insert(elevations.end(), {2.333, 3.333, 4.667, 7.0, 10.333, 15.0});
  return elevations;
}

Elevations pandar64() {
  Elevations elevations = {-25.0, -19.0};
  for (int degree = -14; degree <= -7; ++degree) elevations.push_back(degree);
  for (int step = -36; step <= 12; ++step) elevations.push_back(step / 6.0);
  elevations.insert(elevations.end(), {3.0, 5.0, 8.0, 11.0, 15.0});
  return elevations;
}

using Heads = std::vector<std::pair<std::string, std::function<Elevations()>>>;

const Heads& heads() {
  static const Heads kHeads = {{"hdl64e", hdl64e},
                               {"hdl32e", [] { return evenly(32, -30.67, 10.67); }},
                               {"vlp32c", vlp32c},
                               {"vlp16", [] { return evenly(16, -15.0, 15.0); }},
                               {"os1_64", [] { return evenly(64, -22.5, 22.5); }},
                               {"os1_128", [] { return evenly(128, -22.5, 22.5); }},
                               {"pandar64", pandar64}};
  return kHeads;
}

}  // namespace

std::vector<std::string> lidarHeadNames() {
  std::vector<std::string> names;
  for (const auto& head : heads()) names.push_back(head.first);
  return names;
}

std::vector<double> lidarHeadElevationsDeg(const std::string& name) {
  const auto found = std::find_if(heads().begin(), heads().end(), [&](const auto& head) { return head.first == name; });
  return found == heads().end() ? Elevations() : found->second();
}

}  // namespace fail_aware
