// The driver's target speed: from the speed limit, the bends ahead, and the stops.
//
// The driver takes bends at `lateral_mps2` and brakes before them at `brake_mps2`. The scene's character sets the
// distance between stops; the driver waits there for 2 to 6 s. No failure modes. A call costs about 50 look-ups
// of the road.
#pragma once

#include <cstdint>

#include "core/parameters/check.hpp"
#include "simulation/random.hpp"
#include "simulation/road.hpp"

namespace fail_aware {

class SpeedProfile {
 public:
  struct Params {
    double speed_mps = 0.0;  ///< 0: the scene's speed limit
    double lateral_mps2 = 2.2;
    double brake_mps2 = 1.8;

    template <class Self, class Visitor>
    static void visit(Self& self, Visitor&& v) {
      v("speed_mps", self.speed_mps);
      v("lateral_mps2", self.lateral_mps2);
      v("brake_mps2", self.brake_mps2);
    }
    void validate() const;
  };

  SpeedProfile(std::uint64_t seed, const Params& params) : params_(params), random_(combineKeys(seed, 31)) {}

  /// Target speed at s on the road, at time t and this speed; t must increase from call to call.
  double target(const Road& road, double s_m, double speed_mps, double t_s);

 private:
  void planStop(const Road& road, double s_m);
  double limit(const Road& road, double s_m) const;

  Params params_;
  RandomStream random_;
  bool has_stop_ = false;
  double next_stop_m_ = 0.0;
  double wait_s_ = 0.0;
  double wait_until_s_ = -1.0;  ///< >= 0: the car is waiting at the stop
};

}  // namespace fail_aware
