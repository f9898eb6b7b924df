// The kinds of simulated surroundings, the character of their roads, and the sequence of kinds in a drive.
//
// Plan text: KIND[:LENGTH_M][,KIND[:LENGTH_M]...], e.g. "town" or "town:250,tunnel". The last part has no end.
// Failure: ParameterError naming what is wrong with the text.
#pragma once

#include <string>
#include <vector>

namespace fail_aware {

enum class SceneKind { kTown, kCountry, kHighway, kTunnel, kOpen };

const char* toString(SceneKind kind);

/// Character of the road and its traffic. Lengths in m, angles in rad.
struct RoadCharacter {
  double speed_mps;      ///< speed limit
  double half_width_m;   ///< of the asphalt
  double lane_offset_m;  ///< own lane's centre, to the right of the road's centre
  double grade;          ///< hills: root mean square of the slope
  double straight_min_m, straight_max_m;
  double bend_radius_min_m, bend_radius_max_m;
  double bend_angle_min_rad, bend_angle_max_rad;
  double right_angle_ratio;  ///< ratio of the bends that are street corners
  double stop_spacing_m;     ///< mean distance between stops (lights, junctions); 0: none
  double verge_roughness_m;  ///< height of the bumps on the ground beside the road
  double oncoming_per_km, same_way_per_km;
  bool car_ahead;  ///< a car ahead that keeps its distance
};

const RoadCharacter& roadCharacter(SceneKind kind);

struct ScenePart {
  SceneKind kind = SceneKind::kTown;
  double length_m = 0.0;  ///< 0: not given in the text; the plan chooses it
};

class ScenePlan {
 public:
  /// A part without a length gets about the distance driven in an equal part of the duration.
  static ScenePlan parse(const std::string& text, double duration_s);

  SceneKind kindAt(double s_m) const;
  /// The smallest grade of the parts: the hills are the same in the whole drive.
  double grade() const;

  /// Start and end (m along the road) of the part that contains s; the first begins and the last ends at infinity.
  struct Range {
    double begin_m, end_m;
  };
  Range partAt(double s_m) const;

 private:
  std::vector<ScenePart> parts_;
};

}  // namespace fail_aware
