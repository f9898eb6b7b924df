#include "bridge/marker_conversion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace fail_aware::marker_conversion_test {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std_msgs::Header sweepHeader() {
  std_msgs::Header header;
  header.stamp = ros::Time(12, 345);
  header.frame_id = "odom";
  return header;
}

bool isFiniteMarker(const Marker& m) {
  double sum = m.pose.position.x + m.pose.position.y + m.pose.position.z + m.scale.x + m.scale.y + m.scale.z;
  for (const geometry_msgs::Point& p : m.points) sum += p.x + p.y + p.z;
  return std::isfinite(sum);
}

/// What holds for whatever is published: rviz shows it without a warning, and the next array replaces it.
void expectDisplayable(const MarkerArray& array) {
  std::set<std::pair<std::string, int>> places;
  for (const Marker& m : array.markers) {
    SCOPED_TRACE(m.ns + " " + std::to_string(m.id));
    EXPECT_EQ(m.header.frame_id, "odom");
    EXPECT_EQ(m.header.stamp, sweepHeader().stamp);
    EXPECT_TRUE(places.emplace(m.ns, m.id).second) << "two markers in one place";
    EXPECT_TRUE(isFiniteMarker(m));
    if (m.action == Marker::DELETE) continue;
    ASSERT_EQ(m.action, Marker::ADD);
    const auto& q = m.pose.orientation;
    EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1.0, 1e-9);
    const bool is_line = m.type == Marker::LINE_LIST || m.type == Marker::LINE_STRIP;
    const bool is_text = m.type == Marker::TEXT_VIEW_FACING;
    EXPECT_NE(is_text, m.scale.x > 0.0) << "a text has a height only";
    EXPECT_NE(is_text || is_line, m.scale.y > 0.0) << "a line has a width only";
    EXPECT_NE(is_line, m.scale.z > 0.0);
    EXPECT_GT(m.color.a, 0.0f);
    EXPECT_GT(m.lifetime.toSec(), 0.0);
    EXPECT_TRUE(m.colors.empty() || m.colors.size() == m.points.size());
    const bool is_list = is_line || m.type == Marker::SPHERE_LIST || m.type == Marker::TRIANGLE_LIST;
    EXPECT_EQ(is_list, !m.points.empty());
    EXPECT_TRUE(m.type != Marker::LINE_LIST || m.points.size() % 2 == 0);
    EXPECT_TRUE(m.type != Marker::TRIANGLE_LIST || m.points.size() % 3 == 0);
  }
}

/// Which places an array occupies, drawn or deleted.
std::set<std::pair<std::string, int>> placesOf(const MarkerArray& array) {
  std::set<std::pair<std::string, int>> places;
  for (const Marker& m : array.markers) places.emplace(m.ns, m.id);
  return places;
}

const Marker& find(const MarkerArray& array, const std::string& ns, int id) {
  for (const Marker& m : array.markers) {
    if (m.ns == ns && m.id == id) return m;
  }
  ADD_FAILURE() << "no marker " << ns << " " << id;
  static const Marker none;
  return none;
}

SeedTrack trackAt(double x, double end_x, bool won) {
  SeedTrack track;
  track.T_odom_cog_seed.translation().x() = x;
  track.T_odom_cog_end.translation().x() = end_x;
  track.won = won;
  return track;
}

// Walls 4 m and 6 m long from the apex, 1 m below to 3 m above M.
Corner houseCorner(double x, double y) {
  Corner corner;
  corner.M = {x, y, 0.0};
  corner.J = {x, y, 0.5};
  corner.N = {x + 1.0, y, 0.0};
  corner.planes[0].normal = {0, -1, 0};
  corner.planes[1].normal = {-1, 0, 0};
  corner.planes[0].rectangle = {{x, y, -1.0}, {x + 4.0, y, 3.0}};
  corner.planes[1].rectangle = {{x, y, -1.0}, {x, y + 6.0, 2.0}};
  return corner;
}

TEST(SeedMarkers, OffsetsFromTheBestAreMagnified) {
  const MarkerArray array = seedMarkers({trackAt(10.1, 10.0, true), trackAt(9.8, 10.02, false)}, sweepHeader());
  expectDisplayable(array);
  EXPECT_EQ(array.markers.size(), 2 * kMaxSeedMarkers);
  EXPECT_NEAR(find(array, "seeds before", 0).pose.position.x, 10.0 + kSeedMagnification * 0.1, 1e-9);
  EXPECT_NEAR(find(array, "seeds before", 1).pose.position.x, 10.0 - kSeedMagnification * 0.2, 1e-9);
  EXPECT_NEAR(find(array, "seeds after", 0).pose.position.x, 10.0, 1e-9);
  EXPECT_NEAR(find(array, "seeds after", 1).pose.position.x, 10.0 + kSeedMagnification * 0.02, 1e-9);
  EXPECT_NE(find(array, "seeds after", 0).color, find(array, "seeds after", 1).color) << "the best stands out";
  EXPECT_EQ(find(array, "seeds before", 2).action, static_cast<int>(Marker::DELETE));
}

TEST(SeedMarkers, WithoutSeedsOrWithBadOnesAllOldOnesGo) {
  std::vector<SeedTrack> bad(20, trackAt(kNan, 0.0, true));
  for (const auto& tracks : {std::vector<SeedTrack>(), bad}) {
    const MarkerArray array = seedMarkers(tracks, sweepHeader());
    expectDisplayable(array);
    EXPECT_EQ(placesOf(array), placesOf(seedMarkers({trackAt(1, 1, true)}, sweepHeader())));
    for (const Marker& m : array.markers) EXPECT_EQ(m.action, static_cast<int>(Marker::DELETE));
  }
}

TEST(SeedMarkers, NoneWonIsShownToo) {
  const MarkerArray array = seedMarkers({trackAt(kNan, 1, false), trackAt(2, 3, false)}, sweepHeader());
  expectDisplayable(array);
  EXPECT_EQ(find(array, "seeds before", 0).action, static_cast<int>(Marker::DELETE));
  EXPECT_EQ(find(array, "seeds before", 1).action, static_cast<int>(Marker::ADD));
}

TEST(CornerMarkers, PointsLineAndWallsOfACorner) {
  const MarkerArray array = cornerMarkers({houseCorner(5, 7)}, {houseCorner(5, 7), houseCorner(9, 1)}, sweepHeader());
  expectDisplayable(array);
  EXPECT_EQ(find(array, "corners", 0).points.size(), 3u);
  const Marker& line = find(array, "corners", 1);
  ASSERT_EQ(line.points.size(), 2u);
  EXPECT_NEAR(line.points[0].z, -1.0, 1e-12);
  EXPECT_NEAR(line.points[1].z, 3.0, 1e-12);
  const Marker& walls = find(array, "corner planes", 0);
  ASSERT_EQ(walls.points.size(), 12u) << "two triangles a wall";
  std::set<std::pair<double, double>> first_wall;  // (x, z)
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(walls.points[i].y, 7.0, 1e-12);
    first_wall.emplace(walls.points[i].x, walls.points[i].z);
  }
  const std::set<std::pair<double, double>> expected{{5, -1}, {5, 3}, {9, -1}, {9, 3}};
  EXPECT_EQ(first_wall, expected);
  EXPECT_EQ(find(array, "corner reference", 0).points.size(), 4u);
}

TEST(CornerMarkers, NoneBadAndVeryMany) {
  const auto places = placesOf(cornerMarkers({houseCorner(5, 7)}, {}, sweepHeader()));
  Corner bad = houseCorner(1, 1), flat = houseCorner(2, 2);
  bad.planes[1].rectangle.high.x() = kNan;
  flat.J = flat.M;
  for (const auto& corners : {std::vector<Corner>(), std::vector<Corner>{bad, flat}}) {
    const MarkerArray array = cornerMarkers(corners, corners, sweepHeader());
    expectDisplayable(array);
    EXPECT_EQ(placesOf(array), places);
    for (const Marker& m : array.markers) EXPECT_EQ(m.action, static_cast<int>(Marker::DELETE)) << m.ns;
  }
  const std::vector<Corner> many(5000, houseCorner(1, 2));
  const MarkerArray array = cornerMarkers(many, many, sweepHeader());
  expectDisplayable(array);
  EXPECT_EQ(placesOf(array), places);
  EXPECT_EQ(find(array, "corners", 0).points.size(), 3 * kMaxCornerMarkers);
}

TEST(UncertaintyMarkers, EllipsesHaveTheSigmasOfTheirAxes) {
  const Eigen::Rotation2Dd turn(0.5);
  const Eigen::Matrix2d covariance =
      turn.toRotationMatrix() * Eigen::Vector2d(0.04, 0.0009).asDiagonal() * turn.toRotationMatrix().transpose();
  const MarkerArray array = uncertaintyMarkers(covariance, {3.0, 4.0, 0.5}, 0.6, sweepHeader());
  expectDisplayable(array);
  for (const int sigmas : {1, 2, 3}) {
    double largest = 0.0, smallest = 1e9;
    for (const geometry_msgs::Point& p : find(array, "uncertainty", sigmas).points) {
      const double r = std::hypot(p.x - 3.0, p.y - 4.0);
      largest = std::max(largest, r);
      smallest = std::min(smallest, r);
      EXPECT_EQ(p.z, 0.5);
    }
    EXPECT_NEAR(largest, 0.2 * sigmas, 1e-9);
    EXPECT_NEAR(smallest, 0.03 * sigmas, 1e-9);
  }
  const Marker& limit = find(array, "alert limit", 0);
  EXPECT_NEAR(std::hypot(limit.points[5].x - 3.0, limit.points[5].y - 4.0), 0.6, 1e-9);
}

TEST(UncertaintyMarkers, WhatIsNoCovarianceHasNoEllipse) {
  for (const double xx : {-1.0, kNan}) {
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
    covariance(0, 0) = xx;
    const MarkerArray array = uncertaintyMarkers(covariance, {0, 0, 0}, 0.6, sweepHeader());
    expectDisplayable(array);
    EXPECT_EQ(find(array, "uncertainty", 2).action, static_cast<int>(Marker::DELETE));
    EXPECT_EQ(find(array, "alert limit", 0).action, static_cast<int>(Marker::ADD));
  }
  expectDisplayable(uncertaintyMarkers(Eigen::Matrix2d::Zero(), {0, 0, 0}, 0.6, sweepHeader()));
  expectDisplayable(uncertaintyMarkers(Eigen::Matrix2d::Zero(), {kNan, 0, 0}, 0.6, sweepHeader()));
}

Marker textOf(FailAwareState state, const TimeToFailure& time, std::uint32_t reasons) {
  MonitorOutput output;
  output.state = state;
  output.time_to_failure = time;
  output.reasons = reasons;
  const Marker marker = timeToFailureMarker(output, {1.0, 2.0, 0.0}, sweepHeader());
  MarkerArray array;
  array.markers.push_back(marker);
  expectDisplayable(array);
  return marker;
}

TEST(RoadAheadMarker, LiesAcrossTheRoadWhereItGetsWeak) {
  MonitorOutput output;
  output.min_information_ahead = 0.001;
  output.information_ahead_distance_m = 40.0;
  Pose T_odom_base = Pose::Identity();
  T_odom_base.translation().x() = 100.0;
  EXPECT_EQ(roadAheadMarker(output, T_odom_base, sweepHeader()).action, static_cast<int>(Marker::DELETE))
      << "no reason";
  output.reasons = kReasonWeakRoadAhead;
  const Marker line = roadAheadMarker(output, T_odom_base, sweepHeader());
  MarkerArray array;
  array.markers.push_back(line);
  expectDisplayable(array);
  ASSERT_EQ(line.points.size(), 2u);
  EXPECT_EQ(line.points[0].x, 140.0);
  EXPECT_EQ(line.points[0].y, -line.points[1].y);
  T_odom_base.translation().x() = kNan;
  EXPECT_EQ(roadAheadMarker(output, T_odom_base, sweepHeader()).action, static_cast<int>(Marker::DELETE));
}

TEST(TimeToFailureMarker, SaysStateTimeAndReasons) {
  const Marker degraded = textOf(FailAwareState::kDegraded, TimeToFailure::fromSeconds(7.26, 60.0),
                                 kReasonSweepIncomplete | kReasonMissingIcpPlane);
  EXPECT_EQ(degraded.text, "DEGRADED  7.3 s\nSWEEP_INCOMPLETE\nMISSING_ICP_PLANE");
  EXPECT_EQ(textOf(FailAwareState::kOk, TimeToFailure::fromSeconds(100.0, 60.0), 0).text, "OK  > 60 s");
  EXPECT_EQ(textOf(FailAwareState::kFailed, TimeToFailure::reached(), 0).text, "FAILED  0 s");
  EXPECT_EQ(textOf(FailAwareState::kUnknown, TimeToFailure::unknown(), 0).text, "UNKNOWN  time unknown");
  EXPECT_GT(degraded.pose.position.z, 2.0) << "above the vehicle";
}

TEST(TimeToFailureMarker, EachStateHasItsColour) {
  std::set<std::pair<float, float>> colours;
  for (int i = 0; i < 5; ++i) {
    const auto colour = textOf(static_cast<FailAwareState>(i), TimeToFailure::unknown(), ~0u).color;
    colours.emplace(colour.r, colour.g);
  }
  EXPECT_EQ(colours.size(), 5u);
}

TEST(TimeToFailureMarker, WithoutAPlaceItIsDeleted) {
  const Marker marker = timeToFailureMarker(MonitorOutput(), {kNan, 0, 0}, sweepHeader());
  EXPECT_EQ(marker.action, static_cast<int>(Marker::DELETE));
  EXPECT_TRUE(isFiniteMarker(marker));
}

}  // namespace
}  // namespace fail_aware::marker_conversion_test
