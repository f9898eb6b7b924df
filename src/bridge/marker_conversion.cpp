#include "bridge/marker_conversion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/geometry/decompositions.hpp"
#include "core/geometry/rotation.hpp"
#include "fail_aware_lidar_odometry/bridge/pose_conversion.hpp"

namespace fail_aware {

namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kTextHeight_m = 1.7;
constexpr double kTextAbove_m = 8.0;

struct Colour {
  float r, g, b, a = 1.0f;
};
constexpr Colour kWhite{1.0f, 1.0f, 1.0f}, kGrey{0.6f, 0.6f, 0.6f}, kGreen{0.2f, 0.9f, 0.3f},
    kYellow{1.0f, 0.85f, 0.1f}, kOrange{1.0f, 0.5f, 0.0f}, kRed{1.0f, 0.15f, 0.1f}, kBlue{0.2f, 0.6f, 1.0f},
    kMagenta{1.0f, 0.2f, 0.9f}, kWall{1.0f, 0.3f, 0.9f, 0.5f};

std_msgs::ColorRGBA toMessage(const Colour& colour) {
  std_msgs::ColorRGBA message;
  message.r = colour.r;
  message.g = colour.g;
  message.b = colour.b;
  message.a = colour.a;
  return message;
}

geometry_msgs::Point toPointMessage(const Eigen::Vector3d& p) {
  geometry_msgs::Point message;
  message.x = p.x();
  message.y = p.y();
  message.z = p.z();
  return message;
}

Marker makeMarker(const std_msgs::Header& header, const std::string& ns, int id, int type, double scale,
                  const Colour& colour) {
  Marker marker;
  marker.header = header;
  marker.ns = ns;
  marker.id = id;
  marker.type = type;
  marker.action = Marker::ADD;
  marker.pose.orientation.w = 1.0;
  // Lines have a width, texts a height: rviz 1.14.4 warns of a scale that it does not use.
  const bool is_line = type == Marker::LINE_LIST || type == Marker::LINE_STRIP;
  const bool is_text = type == Marker::TEXT_VIEW_FACING;
  if (!is_text) marker.scale.x = scale;
  if (!is_text && !is_line) marker.scale.y = scale;
  if (!is_line) marker.scale.z = scale;
  marker.color = toMessage(colour);
  marker.lifetime = ros::Duration(kMarkerLifetime_s);
  return marker;
}

/// Adds the marker; one without points deletes the previous marker.
void addList(Marker marker, MarkerArray& array) {
  if (marker.points.empty()) marker.action = Marker::DELETE;
  array.markers.push_back(std::move(marker));
}

void addPoint(const Eigen::Vector3d& p, Marker& marker) { marker.points.push_back(toPointMessage(p)); }

void addColouredPoint(const Eigen::Vector3d& p, const Colour& colour, Marker& marker) {
  addPoint(p, marker);
  marker.colors.push_back(toMessage(colour));
}

bool isDrawable(const Corner& corner) {
  bool finite = corner.M.allFinite() && corner.J.allFinite() && corner.N.allFinite();
  for (const Corner::Plane& plane : corner.planes) {
    finite = finite && plane.rectangle.low.allFinite() && plane.rectangle.high.allFinite();
  }
  return finite && (corner.J - corner.M).norm() > 0.0;
}

std::array<Eigen::Vector3d, 4> verticesOf(const Corner::Rectangle& rectangle, const Eigen::Vector3d& line) {
  const Eigen::Vector3d along = (rectangle.high - rectangle.low).dot(line) * line;
  return {rectangle.low, rectangle.low + along, rectangle.high, rectangle.high - along};
}

void addWall(const std::array<Eigen::Vector3d, 4>& vertices, Marker& marker) {
  // a colour per vertex: then rviz draws both sides alike, without lighting
  for (const std::size_t i : {0u, 1u, 2u, 0u, 2u, 3u}) addColouredPoint(vertices[i], kWall, marker);
}

/// Adds the corner's line, as high as its walls.
void addLine(const Corner& corner, Marker& marker) {
  const Eigen::Vector3d line = corner.lineDirection();
  double low = 0.0, high = Corner::kLineLength;
  for (const Corner::Plane& plane : corner.planes) {
    for (const Eigen::Vector3d& vertex : {plane.rectangle.low, plane.rectangle.high}) {
      low = std::min(low, (vertex - corner.M).dot(line));
      high = std::max(high, (vertex - corner.M).dot(line));
    }
  }
  addPoint(corner.M + low * line, marker);
  addPoint(corner.M + high * line, marker);
}

Pose magnified(const Pose& T_odom_about, const Pose& T_odom_seed) {
  Pose T = Pose::Identity();
  const Pose offset = T_odom_about.inverse() * T_odom_seed;
  T.linear() = T_odom_about.linear() * expSo3(kSeedMagnification * logSo3(offset.linear()));
  T.translation() = T_odom_about * (kSeedMagnification * offset.translation());
  return T;
}

Marker seedArrow(const std_msgs::Header& header, const char* ns, std::size_t id, const Colour& colour) {
  Marker marker = makeMarker(header, ns, static_cast<int>(id), Marker::ARROW, 0.06, colour);
  marker.scale.x = 1.5;  // its length
  return marker;
}

Colour colourOf(FailAwareState state) {
  switch (state) {
    case FailAwareState::kUnknown: return kGrey;
    case FailAwareState::kOk: return kGreen;
    case FailAwareState::kDegraded: return kYellow;
    case FailAwareState::kFailing: return kOrange;
    case FailAwareState::kFailed: return kRed;
  }
  return kRed;
}

std::string timeText(const TimeToFailure& time) {
  char text[32] = "time unknown";
  if (time.status == TimeToFailureStatus::kReached) return "0 s";
  if (time.status == TimeToFailureStatus::kWithinHorizon) std::snprintf(text, sizeof text, "%.1f s", time.seconds);
  if (time.status == TimeToFailureStatus::kBeyondHorizon) std::snprintf(text, sizeof text, "> %.0f s", time.seconds);
  return text;
}

}  // namespace

MarkerArray seedMarkers(const std::vector<SeedTrack>& tracks, const std_msgs::Header& header) {
  const auto usable = [](const SeedTrack& t) { return isFinite(t.T_odom_cog_seed) && isFinite(t.T_odom_cog_end); };
  const SeedTrack* about = nullptr;  // the best seed; if none won, the first
  for (const SeedTrack& track : tracks) {
    if (usable(track) && (about == nullptr || (track.won && !about->won))) about = &track;
  }
  MarkerArray array;
  for (std::size_t i = 0; i < kMaxSeedMarkers; ++i) {
    Marker before = seedArrow(header, "seeds before", i, kWhite), after = seedArrow(header, "seeds after", i, kOrange);
    if (i >= tracks.size() || !usable(tracks[i])) {
      before.action = after.action = Marker::DELETE;
    } else {
      before.pose = toPoseMessage(magnified(about->T_odom_cog_end, tracks[i].T_odom_cog_seed));
      after.pose = toPoseMessage(magnified(about->T_odom_cog_end, tracks[i].T_odom_cog_end));
      if (tracks[i].won) after.color = toMessage(kGreen);
    }
    array.markers.push_back(before);
    array.markers.push_back(after);
  }
  return array;
}

MarkerArray cornerMarkers(const std::vector<Corner>& corners_odom, const std::vector<Corner>& reference_odom,
                          const std_msgs::Header& header) {
  Marker points = makeMarker(header, "corners", 0, Marker::SPHERE_LIST, 0.25, kWhite);
  Marker lines = makeMarker(header, "corners", 1, Marker::LINE_LIST, 0.1, kWhite);
  Marker walls = makeMarker(header, "corner planes", 0, Marker::TRIANGLE_LIST, 1.0, kWall);
  Marker reference = makeMarker(header, "corner reference", 0, Marker::LINE_LIST, 0.06, kGrey);
  for (std::size_t i = 0; i < std::min(corners_odom.size(), kMaxCornerMarkers); ++i) {
    const Corner& corner = corners_odom[i];
    if (!isDrawable(corner)) continue;
    addColouredPoint(corner.M, kWhite, points);
    addColouredPoint(corner.J, kBlue, points);
    addColouredPoint(corner.N, kMagenta, points);
    addLine(corner, lines);
    for (const Corner::Plane& plane : corner.planes) {
      addWall(verticesOf(plane.rectangle, corner.lineDirection()), walls);
    }
  }
  for (std::size_t i = 0; i < std::min(reference_odom.size(), kMaxCornerMarkers); ++i) {
    const Corner& corner = reference_odom[i];
    if (!isDrawable(corner)) continue;
    addPoint(corner.M - 0.5 * corner.lineDirection(), reference);
    addPoint(corner.M + 0.5 * corner.lineDirection(), reference);
  }
  MarkerArray array;
  for (const Marker& marker : {points, lines, walls, reference}) addList(marker, array);
  return array;
}

MarkerArray uncertaintyMarkers(const Eigen::Matrix2d& covariance_odom, const Eigen::Vector3d& position_odom,
                               double alert_limit_m, const std_msgs::Header& header) {
  constexpr int kCorners = 48;
  MarkerArray array;
  const auto addRing = [&](const char* ns, int id, const Colour& colour, const Eigen::Matrix2d& axes) {
    Marker ring = makeMarker(header, ns, id, Marker::LINE_STRIP, 0.04, colour);
    for (int i = 0; i <= kCorners && axes.allFinite() && position_odom.allFinite(); ++i) {
      const double angle = 2.0 * M_PI * (i % kCorners) / kCorners;
      Eigen::Vector3d p = position_odom;
      p.head<2>() += axes * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      addPoint(p, ring);
    }
    addList(ring, array);
  };
  Eigen::Matrix2d root = Eigen::Matrix2d::Constant(std::nan(""));
  if (covariance_odom.allFinite()) {
    const auto eigen = symmetricEigen(covariance_odom);
    root = eigen.eigenvectors() * eigen.eigenvalues().cwiseSqrt().asDiagonal();  // NaN if an eigenvalue is negative
  }
  for (const int sigmas : {1, 2, 3}) addRing("uncertainty", sigmas, kBlue, sigmas * root);
  addRing("alert limit", 0, kRed, alert_limit_m * Eigen::Matrix2d::Identity());
  return array;
}

Marker roadAheadMarker(const MonitorOutput& output, const Pose& T_odom_base, const std_msgs::Header& header) {
  constexpr double kHalfWidth_m = 5.0;
  Marker line = makeMarker(header, "road ahead", 0, Marker::LINE_STRIP, 0.3, kOrange);
  const bool weak = (output.reasons & kReasonWeakRoadAhead) != 0;
  if (weak && isFinite(T_odom_base) && std::isfinite(output.information_ahead_distance_m)) {
    for (const double side_m : {-kHalfWidth_m, kHalfWidth_m}) {
      addPoint(T_odom_base * Eigen::Vector3d(output.information_ahead_distance_m, side_m, 0.0), line);
    }
  } else {
    line.action = Marker::DELETE;
  }
  return line;
}

Marker timeToFailureMarker(const MonitorOutput& output, const Eigen::Vector3d& position_odom,
                           const std_msgs::Header& header) {
  Marker marker =
      makeMarker(header, "time to failure", 0, Marker::TEXT_VIEW_FACING, kTextHeight_m, colourOf(output.state));
  if (!position_odom.allFinite()) {
    marker.action = Marker::DELETE;
    return marker;
  }
  marker.pose.position = toPointMessage(position_odom + Eigen::Vector3d(0.0, 0.0, kTextAbove_m));
  std::string reasons = reasonText(output.reasons);
  std::replace(reasons.begin(), reasons.end(), '|', '\n');
  marker.text = std::string(toString(output.state)) + "  " + timeText(output.time_to_failure);
  if (!reasons.empty()) marker.text += '\n' + reasons;
  return marker;
}

}  // namespace fail_aware
