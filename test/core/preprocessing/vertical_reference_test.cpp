#include "core/preprocessing/vertical_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"

namespace fail_aware::vertical_reference_test {
namespace {

/// A spinning head in a street of walls ahead, behind and beside, and poles; level, in the sensor's frame.
class Street {
 public:
  static constexpr int kBeams = 32;

  struct Head {
    double range_sigma_m = 0.0;  ///< of the constant error of each beam's ranges
    double elevation_rad = 0.0;  ///< error of all beams' elevations: they point higher than they say
  };

  Street(const Head& head, unsigned seed) : elevation_rad_(head.elevation_rad), random_(seed) {
    std::normal_distribution<double> normal(0.0, 1.0);
    for (double& error : range_errors_m_) error = head.range_sigma_m * normal(random_);
  }

  struct Sweep {
    std::vector<Eigen::Vector3f> points;
    std::vector<std::uint16_t> rings;
  };

  Sweep sweep() {
    std::uniform_real_distribution<double> place(-20.0, 20.0);
    Sweep sweep;
    for (int wall = 0; wall < 12; ++wall) {
      const Eigen::Vector2d from(place(random_), place(random_));
      see(sweep, from, from + (wall % 2 == 0 ? Eigen::Vector2d(0.0, 4.0) : Eigen::Vector2d(4.0, 0.0)));
    }
    for (int pole = 0; pole < 6; ++pole) {
      const Eigen::Vector2d middle(place(random_), place(random_));
      const Eigen::Vector2d half = 0.08 * Eigen::Vector2d(-middle.y(), middle.x()).normalized();
      see(sweep, middle - half, middle + half);
    }
    return sweep;
  }

  /// Adds what is seen of an upright rectangle from `from` to `to`, that reaches from 1.1 m below to 0.8 m above the
  /// sensor and leans by slope towards +x.
  void see(Sweep& sweep, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double top_m = 0.8, double slope = 0.0,
           double noise_m = 0.01) {
    std::normal_distribution<double> noise(0.0, noise_m);
    constexpr double kStep = 0.3 * kDegree;
    const double first = std::atan2(from.y(), from.x());
    const double span = std::remainder(std::atan2(to.y(), to.x()) - first, 2.0 * M_PI);
    const Eigen::Vector2d along = to - from;
    for (int i = 0; i <= static_cast<int>(std::abs(span) / kStep); ++i) {
      const double azimuth = first + std::copysign(i * kStep, span);
      const Eigen::Vector2d ray(std::cos(azimuth), std::sin(azimuth));
      const double distance =
          (from.x() * along.y() - from.y() * along.x()) / (ray.x() * along.y() - ray.y() * along.x());
      if (!(distance > 4.0 && distance < 30.0)) continue;
      for (int beam = 0; beam < kBeams; ++beam) {
        const double elevation = (-16.0 + 0.6 * beam) * kDegree;
        const double z = distance * std::tan(elevation + elevation_rad_);
        if (z < -1.1 || z > top_m) continue;
        const double range = (distance + slope * z * ray.x()) / std::cos(elevation + elevation_rad_) +
                             range_errors_m_[beam] + noise(random_);
        const Eigen::Vector2d p = range * std::cos(elevation) * ray;
        sweep.points.push_back(Eigen::Vector3d(p.x(), p.y(), range * std::sin(elevation)).cast<float>());
        sweep.rings.push_back(static_cast<std::uint16_t>(beam));
      }
    }
  }

 private:
  double elevation_rad_;
  std::mt19937 random_;
  double range_errors_m_[kBeams] = {};
};

Pose tilted(double x, double pitch_rad) {
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T.translation().x() = x;
  return T;
}

struct Drive {
  double pitch_error_rad = 0.0;
  double worst_late_rad = 0.0;
  std::optional<double> first_rad;  ///< pitch error of the first sweep

  double sinceStart_deg() const { return (pitch_error_rad - first_rad.value_or(0.0)) / kDegree; }
};

struct Way {
  double mount_yaw_deg = 0.0;
  bool reverse = false;
};

/// What is added to the elevations.
double raised_deg(const VerticalReference& level) {
  std::vector<Eigen::Vector3f> near = {{0.01f, 0.0f, 0.0f}};  // where a bend does nothing
  level.apply(near);
  return static_cast<double>(near[0].z() / near[0].x()) / kDegree;
}

/// The vehicle stays level; the odometry's pitch drifts, less by what it makes of the sweeps' bend.
Drive drive(VerticalReference& level, int metres, double drift_deg_per_m, double response,
            const Street::Head& head = Street::Head(), const Way& way = Way()) {
  Street street(head, 7);
  Drive result;
  const Eigen::Matrix3d mount =
      Eigen::AngleAxisd(way.mount_yaw_deg * kDegree, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const double sign = way.reverse ? -1.0 : 1.0;
  for (int i = 0; i < metres; ++i) {
    result.pitch_error_rad += sign * (drift_deg_per_m - response * level.report().curvature_deg_per_m) * kDegree;
    Street::Sweep sweep = street.sweep();
    for (Eigen::Vector3f& p : sweep.points) p = mount.transpose().cast<float>() * p;
    Pose T = tilted(sign * i, result.pitch_error_rad);
    T.linear() *= mount;
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, T);
    if (!result.first_rad) result.first_rad = result.pitch_error_rad;
    if (i > metres / 2) result.worst_late_rad = std::max(result.worst_late_rad, std::abs(result.pitch_error_rad));
  }
  return result;
}

VerticalReferenceParams withoutBend() {
  VerticalReferenceParams params;
  params.max_curvature_deg_per_m = 0.0;
  return params;
}

TEST(VerticalReference, MeasuresDriftAndTilt) {
  VerticalReference level(withoutBend());
  const Drive result = drive(level, 200, 0.004, 0.0);
  EXPECT_NEAR(level.report().drift_deg_per_m, 0.004, 0.001);
  EXPECT_NEAR(level.report().tilt_deg, result.sinceStart_deg(), 0.05);
  EXPECT_LT(level.report().drift_sigma_deg_per_m, 0.001);
}

/// A sparse map of the first sweeps tilts: by some tenths of a degree within 12 m with 32 beams.
TEST(VerticalReference, TiltOfTheNewMapIsKnownAndTakenBack) {
  VerticalReference level{VerticalReferenceParams()};
  Street street(Street::Head(), 5);
  const double response = VerticalReferenceParams().response;
  double pitch_deg = 0.0, largest_deg = 0.0;
  for (int i = 0; i < 120; ++i) {
    Street::Sweep sweep = street.sweep();
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, tilted(i, pitch_deg * kDegree));
    if (i == 24) {
      EXPECT_GT(level.report().tilt_deg, 0.05);
      EXPECT_NEAR(level.report().tilt_deg, pitch_deg, 3.0 * level.report().tilt_sigma_deg);
    }
    largest_deg = std::max(largest_deg, pitch_deg);
    pitch_deg += (i < 12 ? 0.03 : 0.0) - response * level.report().curvature_deg_per_m;
  }
  EXPECT_GT(largest_deg, 0.25);
  EXPECT_NEAR(pitch_deg, 0.0, 0.1);
}

/// From a town to hedges that lean to one side and ahead: the scenery has changed, not the pose.
TEST(VerticalReference, SceneryThatLeansIsNoTiltSinceTheStart) {
  VerticalReference level(withoutBend());
  Street street(Street::Head(), 5);
  double largest_deg = 0.0;
  for (int i = 0; i < 150; ++i) {
    Street::Sweep sweep = street.sweep();
    Pose T = tilted(i, 0.0);
    if (i >= 75) T.linear() = rotationFromRpy(5.0 * kDegree, 5.0 * kDegree, 0.0);
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, T);
    largest_deg = std::max(largest_deg, std::abs(level.report().tilt_deg));
  }
  EXPECT_LT(largest_deg, 0.2);
}

/// Hedges and banks, each with a lean of its own: they show no vertical, so what is known of the tilt fades.
TEST(VerticalReference, SceneryThatLeansAllWaysTellsNothing) {
  VerticalReference level(withoutBend());
  drive(level, 75, 0.0, 0.0);
  const double known_deg = level.report().tilt_sigma_deg;
  Street street(Street::Head(), 5);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-20.0, 20.0), slope(-0.1, 0.1);
  for (int i = 75; i < 275; ++i) {
    Street::Sweep sweep;
    for (int wall = 0; wall < 18; ++wall) {
      const Eigen::Vector2d from(place(random), place(random)), along(0.0, 4.0), across(4.0, 0.0);
      street.see(sweep, from, from + (wall % 2 == 0 ? along : across), 0.8, slope(random));
    }
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, tilted(i, 0.0));
  }
  EXPECT_GT(level.report().tilt_sigma_deg, known_deg);
  EXPECT_LT(std::abs(level.report().tilt_deg), 2.0 * level.report().tilt_sigma_deg);
}

/// Hedges ahead and behind, below the sensor, lean away from it: an error of all elevations looks alike.
TEST(VerticalReference, HedgesThatLeanAwayAreNoElevationError) {
  VerticalReference level(withoutBend(), 0.15);
  Street street(Street::Head(), 5);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-20.0, 20.0), distance(6.0, 20.0), slope(0.08, 0.14);
  for (int i = 0; i < 60; ++i) {
    Street::Sweep sweep;
    for (int pole = 0; pole < 4; ++pole) {
      const Eigen::Vector2d middle(place(random), place(random));
      const Eigen::Vector2d half = 0.08 * Eigen::Vector2d(-middle.y(), middle.x()).normalized();
      street.see(sweep, middle - half, middle + half);
    }
    for (int hedge = 0; hedge < 16; ++hedge) {
      const double side = hedge % 2 == 0 ? 1.0 : -1.0, y = 0.5 * place(random);
      const Eigen::Vector2d from(side * distance(random), y);
      street.see(sweep, from, from + Eigen::Vector2d(0.0, 3.0), -0.2, side * slope(random));
    }
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, tilted(i, 0.0));
  }
  EXPECT_LT(std::abs(level.report().elevation_deg), 2.5 * level.report().elevation_sigma_deg);
  EXPECT_LT(std::abs(level.report().elevation_deg), 0.1);
}

/// Of a drive that begins among hedges: a few looks agree by chance on an elevation that they cannot tell.
TEST(VerticalReference, AFirstLookThatContradictsItselfDoesNotCount) {
  constexpr double kSigmaElevation_deg = 0.15;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-20.0, 20.0), slope(-0.25, 0.25);
  int looks_that_told = 0;
  for (unsigned start = 0; start < 60; ++start) {
    VerticalReference level(VerticalReferenceParams(), kSigmaElevation_deg);
    Street street(Street::Head(), start);
    Street::Sweep sweep;
    for (int wall = 0; wall < 12; ++wall) {
      const Eigen::Vector2d from(place(random), place(random)), along(0.0, 4.0), across(4.0, 0.0);
      street.see(sweep, from, from + (wall % 2 == 0 ? along : across), 0.8, slope(random));
    }
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, Pose::Identity());
    const VerticalReference::Report& report = level.report();
    const double told = std::pow(kSigmaElevation_deg, 2) - std::pow(report.elevation_sigma_deg, 2);
    EXPECT_LE(report.elevation_deg * report.elevation_deg, 9.0 * told + 1e-9) << "start " << start;
    if (told > 1e-9) ++looks_that_told;
  }
  EXPECT_GT(looks_that_told, 10);
}

TEST(VerticalReference, TiltMomentHoldsWhatIsNotCorrected) {
  VerticalReference level(withoutBend());
  EXPECT_TRUE(level.tiltMoment().isZero());
  drive(level, 200, 0.004, 0.0);
  const double tilt_rad = level.report().tilt_deg * kDegree, sigma_rad = level.report().tilt_sigma_deg * kDegree;
  EXPECT_NEAR(level.tiltMoment()(1, 1), tilt_rad * tilt_rad + sigma_rad * sigma_rad, 1e-12);
  EXPECT_GT(std::sqrt(level.tiltMoment()(1, 1)), 0.7 * kDegree);
}

TEST(VerticalReference, TiltMomentGrowsWhereNothingStandsUpright) {
  VerticalReference level{VerticalReferenceParams()};
  double before = 0.0;
  for (int i = 0; i < 100; ++i) {
    level.observe({}, {}, tilted(i, 0.0));
    EXPECT_GE(level.tiltMoment()(1, 1), before);
    before = level.tiltMoment()(1, 1);
  }
  EXPECT_GT(std::sqrt(before), 0.4 * kDegree);
}

TEST(VerticalReference, ErrorsOfTheRangesAreNoTilt) {
  Street::Head head;
  head.range_sigma_m = 0.04;  // leans walls by a degree
  VerticalReference level(withoutBend());
  const Drive result = drive(level, 200, 0.004, 0.0, head);
  EXPECT_NEAR(level.report().drift_deg_per_m, 0.004, 0.001);
  EXPECT_NEAR(level.report().tilt_deg, result.sinceStart_deg(), 0.08);
}

TEST(VerticalReference, AnErrorOfAllElevationsIsNoTilt) {
  Street::Head head;
  head.elevation_rad = 0.25 * kDegree;
  VerticalReference level(withoutBend());
  const Drive result = drive(level, 200, 0.004, 0.0, head);
  EXPECT_NEAR(level.report().tilt_deg, result.sinceStart_deg(), 0.05);
  EXPECT_NEAR(level.report().elevation_deg, 0.25, 0.05);
}

/// Walls tell of the elevations, whose correction ends the drift that they cause, however large it is.
TEST(VerticalReference, AnErrorOfAllElevationsIsTakenOffTheSweeps) {
  Street::Head head;
  head.elevation_rad = 0.25 * kDegree;
  for (const double drift_per_elevation : {0.01, 0.05}) {
    VerticalReference level{VerticalReferenceParams()};
    const double response = VerticalReferenceParams().response;
    Street street(head, 7);
    double pitch_deg = 0.0;
    for (int i = 0; i < 200; ++i) {
      Street::Sweep sweep = street.sweep();
      level.apply(sweep.points);
      level.observe(sweep.points, sweep.rings, tilted(i, pitch_deg * kDegree));
      const double left_deg = 0.25 - raised_deg(level);
      pitch_deg += drift_per_elevation * left_deg - response * level.report().curvature_deg_per_m;
    }
    EXPECT_NEAR(raised_deg(level), 0.25, 0.05) << drift_per_elevation;
    EXPECT_NEAR(level.report().elevation_deg, raised_deg(level), 0.03);
    EXPECT_NEAR(pitch_deg, 0.0, 0.1) << drift_per_elevation;
    EXPECT_LT(std::abs(level.report().curvature_deg_per_m), 0.0015) << drift_per_elevation;
  }
}

/// One step does not correct all: the map still has the error in it.
TEST(VerticalReference, ElevationsAreRaisedOverSomeMetresWithinFiveSigmas) {
  Street::Head head;
  head.elevation_rad = 0.25 * kDegree;
  VerticalReference level{VerticalReferenceParams()};
  drive(level, 2, 0.0, 0.0, head);
  EXPECT_NEAR(raised_deg(level), level.report().elevation_deg / 20.0, 1e-4);
  EXPECT_GT(raised_deg(level), 0.001);
  constexpr double kSigma_deg = 0.02;
  VerticalReference sure(VerticalReferenceParams(), kSigma_deg);
  drive(sure, 200, 0.0, 0.0, head);
  EXPECT_NEAR(raised_deg(sure), 5.0 * kSigma_deg, 1e-4);
  EXPECT_GT(sure.report().elevation_deg, raised_deg(sure) + 0.02);
}

/// Without looks the filter is a formula.
TEST(VerticalReference, SigmasOfDriftAndTiltFollowFromElevationAndWalk) {
  VerticalReferenceParams params;
  params.new_map_tilt_deg = 0.0;
  constexpr double kSigmaElevation_deg = 0.2;
  VerticalReference level(params, kSigmaElevation_deg);
  constexpr int kMetres = 50;
  for (int i = 0; i <= kMetres; ++i) {
    level.observe({}, {}, tilted(i, 0.0));
    if (i > 0) continue;
    EXPECT_NEAR(level.report().drift_sigma_deg_per_m,
                std::hypot(params.drift_per_elevation_per_m * kSigmaElevation_deg, params.sigma_other_drift_deg_per_m),
                1e-9);
  }
  const double of_drift = std::pow(params.drift_per_elevation_per_m * kSigmaElevation_deg, 2) +
                          std::pow(params.sigma_other_drift_deg_per_m, 2);
  const double of_walks = kMetres * std::pow(params.tilt_walk_deg, 2) +
                          std::pow(kMetres, 3) / 3.0 * std::pow(params.drift_walk_deg_per_m, 2);
  const double tilt_sigma_deg = std::sqrt(kMetres * kMetres * of_drift + of_walks);
  EXPECT_NEAR(level.report().tilt_sigma_deg, tilt_sigma_deg, 0.01 * tilt_sigma_deg);
}

TEST(VerticalReference, TheElevationOfALidarThatHangsHasTheSameSign) {
  Street::Head head;
  head.elevation_rad = 0.25 * kDegree;
  VerticalReference level(withoutBend());
  Street street(head, 7);
  const Eigen::Matrix3d upside_down = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (int i = 0; i < 200; ++i) {
    Street::Sweep sweep = street.sweep();
    Pose T = tilted(i, 0.0);
    T.linear() = upside_down;
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, T);
  }
  EXPECT_NEAR(level.report().elevation_deg, 0.25, 0.08);
}

TEST(VerticalReference, AnElevationThatIsKnownStays) {
  Street::Head head;
  head.elevation_rad = 0.25 * kDegree;
  VerticalReference level(withoutBend(), 0.001);
  drive(level, 100, 0.004, 0.0, head);
  EXPECT_NEAR(level.report().elevation_deg, 0.0, 0.01);
  EXPECT_LE(level.report().elevation_sigma_deg, 0.001);
}

TEST(VerticalReference, SweepsWithoutRingsSufficeToo) {
  VerticalReference level(withoutBend());
  Street street(Street::Head(), 7);
  double pitch_deg = 0.0;
  for (int i = 0; i < 200; ++i) {
    pitch_deg += 0.004;
    std::vector<Eigen::Vector3f> points = street.sweep().points;
    level.apply(points);
    level.observe(points, {}, tilted(i, pitch_deg * kDegree));
  }
  EXPECT_NEAR(level.report().tilt_deg, pitch_deg, 0.08);
}

TEST(VerticalReference, BendEndsTheDrift) {
  VerticalReference level{VerticalReferenceParams()};
  const double response = VerticalReferenceParams().response;
  const Drive result = drive(level, 300, 0.004, response);
  EXPECT_LT(result.worst_late_rad, 0.1 * kDegree);  // 1.2 deg without
  EXPECT_NEAR(response * level.report().curvature_deg_per_m, 0.004, 0.0015);
}

TEST(VerticalReference, BendEndsTheDriftHoweverTheSensorIsTurned) {
  for (const Way& way : {Way{180.0, false}, Way{90.0, false}, Way{-60.0, false}, Way{0.0, true}}) {
    VerticalReference level{VerticalReferenceParams()};
    const Drive result = drive(level, 300, 0.004, VerticalReferenceParams().response, Street::Head(), way);
    EXPECT_NEAR(level.report().drift_deg_per_m, 0.004, 0.001) << way.mount_yaw_deg << way.reverse;
    EXPECT_LT(result.worst_late_rad, 0.1 * kDegree) << way.mount_yaw_deg << way.reverse;
  }
}

/// The pose jitters while the vehicle stands: that is no way.
TEST(VerticalReference, StandstillChangesNothing) {
  VerticalReference level{VerticalReferenceParams()}, other{VerticalReferenceParams()};
  drive(level, 50, 0.004, 1.0);
  drive(other, 50, 0.004, 1.0);
  const Street::Sweep sweep = Street(Street::Head(), 7).sweep();
  for (int i = 0; i < 1000; ++i) {
    level.observe(sweep.points, sweep.rings, tilted(49.0 + 0.002 * (i % 2), 0.0));
  }
  EXPECT_EQ(level.report().looks, other.report().looks);
  EXPECT_EQ(level.report().tilt_sigma_deg, other.report().tilt_sigma_deg);
  EXPECT_EQ(raised_deg(level), raised_deg(other));
}

TEST(VerticalReference, LowAndThickThingsCountLittle) {
  // after half of the way low rough banks, ahead and behind, lean by 2 deg beside upright walls
  VerticalReference level(withoutBend());
  Street street(Street::Head(), 3);
  for (int i = 0; i < 100; ++i) {
    Street::Sweep sweep = street.sweep();
    for (const double x : {-18.0, 18.0}) {
      if (i >= 50) street.see(sweep, {x, -15.0}, {x, 15.0}, -0.4, std::tan(2.0 * kDegree), 0.025);
    }
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, tilted(i, 0.0));
  }
  EXPECT_NEAR(level.report().tilt_deg, 0.0, 0.1);
  EXPECT_NEAR(level.report().drift_deg_per_m, 0.0, 0.001);
}

TEST(VerticalReference, NothingUprightChangesNothing) {
  VerticalReference level{VerticalReferenceParams()};
  std::vector<Eigen::Vector3f> ground;
  for (float x = -30.0f; x < 30.0f; x += 0.5f) {
    for (float y = -30.0f; y < 30.0f; y += 0.5f) ground.emplace_back(x, y, -1.7f);
  }
  for (int i = 0; i < 100; ++i) level.observe(ground, {}, tilted(i, 1e-4 * i));
  EXPECT_GT(level.report().looks, 20u);
  EXPECT_EQ(level.report().curvature_deg_per_m, 0.0);
  std::vector<Eigen::Vector3f> points = ground;
  level.apply(points);
  EXPECT_EQ(points, ground);
}

TEST(VerticalReference, BendIsBoundedAndRaisesWhatIsFar) {
  VerticalReferenceParams params;
  params.max_curvature_deg_per_m = 0.002;
  VerticalReference level(params, 1e-6);
  drive(level, 200, 0.02, 0.0);
  EXPECT_DOUBLE_EQ(level.report().curvature_deg_per_m, 0.002);
  std::vector<Eigen::Vector3f> points = {{10.0f, 0.0f, -1.0f}, {0.0f, -40.0f, 0.0f}, {80.0f, 0.0f, 2.0f}};
  level.apply(points);
  const double curvature = 0.002 * kDegree;
  EXPECT_NEAR(points[0].z(), -1.0 + 0.5 * curvature * 100.0, 1e-5);
  EXPECT_NEAR(points[1].z(), 0.5 * curvature * 1600.0, 1e-5);
  EXPECT_NEAR(points[2].z(), 2.0 + 0.5 * curvature * 80.0 * 40.0, 1e-5);
}

TEST(VerticalReference, ResetBeginsAnew) {
  VerticalReference once{VerticalReferenceParams()}, again{VerticalReferenceParams()};
  drive(again, 200, 0.004, 1.0);
  again.reset();
  EXPECT_EQ(again.report().looks, 0u);
  drive(once, 100, 0.004, 1.0);
  drive(again, 100, 0.004, 1.0);
  EXPECT_EQ(once.report().curvature_deg_per_m, again.report().curvature_deg_per_m);
  EXPECT_EQ(once.report().tilt_deg, again.report().tilt_deg);
}

/// A pose that is set from outside: the vehicle jumps in odom, its heading is another, and it stands otherwise there.
TEST(VerticalReference, AnotherOdomIsNoWayAndNoTilt) {
  VerticalReferenceParams params;
  params.new_map_tilt_deg = 0.0;  // the map begins anew, too
  VerticalReference level(params);
  drive(level, 200, 0.004, 1.0);
  const VerticalReference::Report before = level.report();
  const double raised_before_deg = raised_deg(level);
  Street street(Street::Head(), 11);
  const auto inOdom = [](int metre) {
    Pose T = tilted(metre, 2.0 * kDegree);
    T = Pose(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitZ())) * T;
    T.translation() += Eigen::Vector3d(5000.0, -300.0, 40.0);
    return T;
  };
  const auto observe = [&](int metre) {
    Street::Sweep sweep = street.sweep();
    level.apply(sweep.points);
    level.observe(sweep.points, sweep.rings, inOdom(metre), 1);
  };
  observe(0);
  EXPECT_NEAR(level.report().tilt_deg, 0.0, 1e-9);
  EXPECT_NEAR(raised_deg(level), raised_before_deg, 1e-4);
  EXPECT_NEAR(level.report().drift_deg_per_m, before.drift_deg_per_m, 1e-5)
      << "that is the sensor's, but for one more look";
  EXPECT_NEAR(level.report().drift_sigma_deg_per_m, before.drift_sigma_deg_per_m, 1e-6);
  for (int i = 1; i <= 60; ++i) {
    observe(i);
    EXPECT_NEAR(level.report().curvature_deg_per_m, before.curvature_deg_per_m, 0.0015) << i;
  }
}

TEST(VerticalReference, BadInputIsHarmless) {
  VerticalReference level{VerticalReferenceParams()};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 20; ++i) {
    level.observe({{nan, 0.0f, 0.0f}, {1e30f, 1.0f, 0.0f}, {0.0f, 0.0f, 0.0f}}, {}, tilted(i, 0.0));
    level.observe({}, {}, tilted(i, 0.0));
  }
  Pose bad = tilted(20.0, 0.0);
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  level.observe({}, {}, bad);
  EXPECT_EQ(level.report().curvature_deg_per_m, 0.0);
  EXPECT_EQ(raised_deg(level), 0.0);
}

}  // namespace
}  // namespace fail_aware::vertical_reference_test
