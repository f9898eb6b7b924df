// Finds what stands upright in a sweep, and how each of it is met by the beams: the measurements of the vertical
// reference (vertical_reference.hpp; not in the paper).
//
// The horizontal plane is divided into columns. A column that holds a wall's surface (a plane, fitted robustly: window
// recesses, sills and leaves are left out) gives one profile, along the plane's horizontal normal. A trunk or pole
// gives two: across the direction of sight the middle between its edges, which errors of the ranges do not shift; away
// from the sensor its mean. A trunk is narrow with all that stands within half a column around it: a column's border
// also cuts slivers out of walls, whose edges are upright in odom whatever its tilt. A profile is the mean offset beam
// by beam, with the mean height of that beam's points.
//
// Frames: points in the sensor's; profiles in axes of odom, relative to the sensor.
// Failure is data: no profiles. Cost: about 4 ms for 120 000 points in a town.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fail_aware {

/// What is known of the error of a beam's ranges.
struct BeamRange {
  float too_far_m = 0.0f;  ///< to be taken from its ranges
  float sigma_m = 0.03f;   ///< what remains
};

struct UprightProfile {
  enum class Kind { kSurface, kLineAcross, kLineAway };
  struct Beam {
    std::uint16_t ring;
    float points;
    float offset_m;     ///< mean along `direction`, relative to the column
    float height_m;     ///< mean, above the sensor
    float obliqueness;  ///< change of the offset by a metre of range; 0: none
  };

  Kind kind;
  Eigen::Vector2d direction;  ///< horizontal unit vector
  /// horizontal unit vector from the sensor to the column; back to it if the sensor hangs: beams that point too high
  /// then make things lean in the other direction
  Eigen::Vector2d away;
  std::size_t first, size;  ///< of its beams
  float top_m;              ///< mean height of its highest beam, above the sensor
};

class UprightProfileFinder {
 public:
  static constexpr std::size_t kMaxBeams = 128;  ///< points of rings from here on are left out

  /// rings: one a point, or empty: found from the elevations. ranges: by ring; what is not there is not corrected.
  /// While the errors of the ranges are not known, points farther from a surface count as its points.
  void find(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<std::uint16_t>& rings,
            const std::vector<BeamRange>& ranges, const Eigen::Matrix3d& R_odom_lidar);

  const std::vector<UprightProfile>& profiles() const { return profiles_; }
  const std::vector<UprightProfile::Beam>& beams() const { return beams_; }

 private:
  struct Point {
    Eigen::Vector3f p;  ///< odom's axes, relative to the sensor
    std::uint16_t ring;
    std::uint32_t column;
    float kernel2_m2;
  };
  struct Column {
    std::uint32_t points = 0, first = 0;
    float low = 0.0f, high = 0.0f;
  };

  void sortIntoColumns(const std::vector<Eigen::Vector3f>& points_lidar, const std::vector<std::uint16_t>& rings,
                       const std::vector<BeamRange>& ranges, const Eigen::Matrix3f& R_odom_lidar);
  void readColumn(const Point* points, std::size_t count);
  void readLine(std::uint32_t column, const Eigen::Vector3f& middle);
  std::uint32_t columnOf(const Eigen::Vector3f& p) const;
  void addProfile(UprightProfile::Kind kind, const Eigen::Vector2f& direction, const Eigen::Vector3f& centre,
                  const Point* points, std::size_t count);

  bool hangs_ = false;
  std::vector<Point> unsorted_, sorted_;
  std::vector<Column> columns_;
  std::vector<Point> around_;   ///< a line's points
  std::vector<float> weights_;  ///< of one column's points, or of those around a line
  std::vector<UprightProfile> profiles_;
  std::vector<UprightProfile::Beam> beams_;
};

}  // namespace fail_aware
