// The kinds of made-up surroundings, what distinguishes their roads, and a drive's plan through them.
//
// plan text: KIND[:LENGTH_M][,KIND[:LENGTH_M]...], e.g. "town" or "town:250,tunnel". The last part has no end.
// Failure: ParameterError naming what is wrong with the text.
#pragma once

#include <string>
#include <vector>

namespace fail_aware {

enum class SceneKind { kTown, kCountry, kHighway, kTunnel, kOpen };

const char* toString(SceneKind kind);

/// What the road and its traffic are like. Lengths in m, angles in rad.
struct RoadCharacter {
  double speed_mps;      ///< limit
  double half_width_m;   ///< of the asphalt
  double lane_offset_m;  ///< own lane's centre, to the right of the road's
  double grade;          ///< hills: root mean square of the slope
  double straight_min_m, straight_max_m;
  double bend_radius_min_m, bend_radius_max_m;
  double bend_angle_min_rad, bend_angle_max_rad;
  double right_angle_ratio;  ///< of the bends, those at street corners
  double stop_spacing_m;     ///< mean distance of the stops (lights, junctions); 0: none
  double verge_roughness_m;  ///< height of the ground's bumps beside the road
  double oncoming_per_km, same_way_per_km;
  bool car_ahead;  ///< a car that keeps its distance
};

const RoadCharacter& roadCharacter(SceneKind kind);

struct ScenePart {
  SceneKind kind = SceneKind::kTown;
  double length_m = 0.0;  ///< 0 in the text: left to the plan
};

class ScenePlan {
 public:
  /// Parts without a length get what is driven in an equal share of the duration, about.
  static ScenePlan parse(const std::string& text, double duration_s);

  SceneKind kindAt(double s_m) const;
  /// The flattest of the parts': the hills are those of the whole drive.
  double grade() const;

  /// Start and end (m along the road) of the part that s lies in; the first begins and the last ends at infinity.
  struct Range {
    double begin_m, end_m;
  };
  Range partAt(double s_m) const;

 private:
  std::vector<ScenePart> parts_;
};

}  // namespace fail_aware
