#include "core/registration/corner_svd/corner_extraction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "core/geometry/degree.hpp"
#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::corner_extraction_test {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr double kSensorHeight = 1.73;

struct Wall {
  Eigen::Vector2d begin, end;
  double height = 6.0;  // above ground, m
};

// A 64-beam head over flat ground, in the world of `walls`: -24.8..2 deg, 0.18 deg apart in azimuth, 2 cm noise.
class Scanner {
 public:
  explicit Scanner(std::vector<Wall> walls) : walls_(std::move(walls)) {}

  Points scan(const Pose& T_world_lidar, std::uint32_t seed) {
    std::mt19937 generator(seed);
    Points points;
    for (int column = 0; column < 2000; ++column) {
      const double azimuth = column * 0.18 * kDegree;
      for (int ring = 0; ring < 64; ++ring) {
        const double elevation = (-24.8 + 26.8 / 63.0 * ring) * kDegree;
        const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                  std::sin(elevation));
        const double range = cast(T_world_lidar.translation(), T_world_lidar.linear() * ray);
        if (range > 100.0) continue;
        double noise = -6.0;
        for (int i = 0; i < 12; ++i) {
          noise += static_cast<double>(static_cast<std::uint32_t>(generator())) / 4294967296.0;
        }
        points.push_back(((range + 0.02 * noise) * ray).cast<float>());
      }
    }
    return points;
  }

 private:
  double cast(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    double nearest = ray.z() < 0.0 ? (-kSensorHeight - from.z()) / ray.z() : 1e9;
    for (const Wall& wall : walls_) {
      const Eigen::Vector2d along = wall.end - wall.begin, to = wall.begin - from.head<2>();
      const double determinant = ray.x() * along.y() - ray.y() * along.x();
      if (std::abs(determinant) < 1e-9) continue;
      const double range = (to.x() * along.y() - to.y() * along.x()) / determinant;
      const double share = (to.x() * ray.y() - to.y() * ray.x()) / determinant;
      const double height = from.z() + range * ray.z() + kSensorHeight;
      if (range > 0.1 && range < nearest && share >= 0.0 && share <= 1.0 && height < wall.height) nearest = range;
    }
    return nearest;
  }
  std::vector<Wall> walls_;
};

Pose poseAt(double x, double y, double roll, double pitch, double yaw) {
  Pose T = Pose::Identity();
  T.linear() = rotationFromRpy(roll, pitch, yaw);
  T.translation() = Eigen::Vector3d(x, y, 0.0);
  return T;
}

// Two walls that meet at `apex` with the given angle between them, seen from the origin on the inside.
std::vector<Wall> wallsAtAngle(const Eigen::Vector2d& apex, double angle_deg, double length_m) {
  const double bisector = std::atan2(-apex.y(), -apex.x()), half = 0.5 * angle_deg * kDegree;
  const Eigen::Vector2d a(std::cos(bisector - half), std::sin(bisector - half));
  const Eigen::Vector2d b(std::cos(bisector + half), std::sin(bisector + half));
  return {{apex, apex + length_m * a}, {apex, apex + length_m * b}};
}

std::vector<Corner> extract(const std::vector<Wall>& walls, const CornerExtractor::Params& params = {}) {
  return CornerExtractor(params).extract(Scanner(walls).scan(Pose::Identity(), 1), Eigen::Matrix3d::Identity());
}

const std::vector<Wall> kLShape{{{4, 7}, {12, 7}}, {{12, 7}, {12, -3}}};

TEST(CornerExtraction, FindsALShapedCorner) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Pose T_world_lidar = poseAt(0.3 * seed, 0.5, 0.02, -0.03, 0.2 * seed);
    Scanner scanner(kLShape);
    const Points points = scanner.scan(T_world_lidar, seed);
    const std::vector<Corner> corners = CornerExtractor({}).extract(points, T_world_lidar.linear());
    ASSERT_EQ(corners.size(), 1u);
    const Corner corner = movedCorner(T_world_lidar, corners[0]);
    EXPECT_LT((corner.M - Eigen::Vector3d(12, 7, 0)).norm(), 0.03);
    EXPECT_LT((corner.J - Eigen::Vector3d(12, 7, 0.5)).norm(), 0.03);
    EXPECT_LT((corner.N - Eigen::Vector3d(13, 7, 0)).norm(), 0.03) << "in the wall along x, on the side of growing x";
    EXPECT_GT(corner.planes[0].normal.dot(Eigen::Vector3d(0, -1, 0)), 0.9999) << "towards the sensor";
    EXPECT_GT(corner.planes[1].normal.dot(Eigen::Vector3d(-1, 0, 0)), 0.9999);
    EXPECT_NEAR(corner.planes[0].rms_m, 0.02, 0.01);
    EXPECT_GT(corner.points(), 2000);
    // the walls: 8 m along x and 10 m along y, and the ground in line with them as far as their last cell goes; from
    // the ground, or near it, to 6 m or to where the highest beam is
    const Corner::Rectangle &along_x = corner.planes[0].rectangle, &along_y = corner.planes[1].rectangle;
    for (const Corner::Rectangle* rectangle : {&along_x, &along_y}) {
      EXPECT_GT(rectangle->low.z(), -kSensorHeight - 0.2);
      EXPECT_LT(rectangle->low.z(), -kSensorHeight + 0.6);
      EXPECT_GT(rectangle->high.z(), 0.0);
    }
    EXPECT_NEAR(std::min(along_x.low.x(), along_x.high.x()), 4.0, CornerExtractor::Params().cell_m);
    EXPECT_NEAR(std::max(along_x.low.x(), along_x.high.x()), 12.0, CornerExtractor::Params().cell_m);
    EXPECT_NEAR(along_x.low.y(), 7.0, 0.05);
    EXPECT_NEAR(along_x.high.y(), 7.0, 0.05);
    EXPECT_NEAR(std::min(along_y.low.y(), along_y.high.y()), -3.0, CornerExtractor::Params().cell_m);
    EXPECT_NEAR(along_y.high.x(), 12.0, 0.05);
  }
}

TEST(CornerExtraction, TheArticlesLiteralSettingsFindItToo) {
  CornerExtractor::Params params;
  params.cluster_cells = false;
  params.min_beams_per_cell = 20;
  params.max_planes_per_cluster = 2;
  params.max_corner_gap_m = 1000.0;
  params.min_points_near_corner = 0;
  params.ransac.stop_early = false;
  params.ransac.max_sample_points = 1000000;
  const std::vector<Corner> corners = extract(kLShape, params);
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_LT((corners[0].M - Eigen::Vector3d(12, 7, 0)).norm(), 0.03);
}

TEST(CornerExtraction, AStraightWallHasNoCorner) {
  EXPECT_TRUE(extract({{{-10, 6}, {15, 6}}}).empty());
  EXPECT_TRUE(extract({}).empty());
}

TEST(CornerExtraction, TheAngleBetweenTheWallsDecides) {
  for (const double angle_deg : {40.0, 50.0, 90.0, 130.0, 140.0}) {
    const std::vector<Corner> corners = extract(wallsAtAngle({10, 2}, angle_deg, 6.0));
    EXPECT_EQ(corners.size(), angle_deg > 45.0 && angle_deg < 135.0 ? 1u : 0u) << angle_deg;
  }
}

TEST(CornerExtraction, LowThingsAreNoWalls) {
  std::vector<Wall> box = kLShape;
  for (Wall& wall : box) wall.height = 0.9;
  EXPECT_TRUE(extract(box).empty());
}

// A facade with two wings: one cluster, three planes, two corners that exist, and none where far walls would meet.
TEST(CornerExtraction, EveryRealCornerOfOneClusterAndNoVirtualOne) {
  const std::vector<Wall> house{{{-8, 9}, {-8, 5}}, {{-8, 9}, {8, 9}}, {{8, 9}, {8, 5}}};
  const std::vector<Corner> corners = extract(house);
  ASSERT_EQ(corners.size(), 2u);
  for (const Corner& corner : corners) {
    EXPECT_NEAR(std::abs(corner.M.x()), 8.0, 0.03);
    EXPECT_NEAR(corner.M.y(), 9.0, 0.03);
  }
  CornerExtractor::Params article;
  article.max_planes_per_cluster = 2;
  EXPECT_LE(extract(house, article).size(), 1u);
}

// A bevelled corner: the two long walls would meet at (12, 7), where there is nothing.
TEST(CornerExtraction, DistantWallsMakeNoCorner) {
  const std::vector<Wall> walls{{{2, 7}, {9.5, 7}}, {{9.5, 7}, {12, 5.5}}, {{12, 5.5}, {12, -3}}};
  const auto countNearVirtual = [](const std::vector<Corner>& corners) {
    return std::count_if(corners.begin(), corners.end(),
                         [](const Corner& corner) { return (corner.M - Eigen::Vector3d(12, 7, 0)).norm() < 0.5; });
  };
  EXPECT_EQ(countNearVirtual(extract(walls)), 0);
  CornerExtractor::Params anywhere;
  anywhere.max_corner_gap_m = 1000.0;
  EXPECT_EQ(countNearVirtual(extract(walls, anywhere)), 1);
}

TEST(CornerExtraction, SameInputSameCornersWhateverCameBefore) {
  Scanner scanner(kLShape);
  const Points points = scanner.scan(Pose::Identity(), 1), others = scanner.scan(poseAt(1, -1, 0, 0, 1), 2);
  CornerExtractor extractor({});
  const std::vector<Corner> first = extractor.extract(points, Eigen::Matrix3d::Identity());
  extractor.extract(others, Eigen::Matrix3d::Identity());
  const std::vector<Corner> again = extractor.extract(points, Eigen::Matrix3d::Identity());
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].M, again[i].M);
}

TEST(CornerExtraction, UnusablePointsAreIgnored) {
  Points points = Scanner(kLShape).scan(Pose::Identity(), 1);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity, 3e38F, 50.0F}) {
    points.emplace_back(bad, 1.0F, 1.0F);
    points.emplace_back(1.0F, bad, 1.0F);
    points.emplace_back(5.0F, 5.0F, bad);
    points.emplace_back(bad, bad, bad);
  }
  const std::vector<Corner> corners = CornerExtractor({}).extract(points, Eigen::Matrix3d::Identity());
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_LT((corners[0].M - Eigen::Vector3d(12, 7, 0)).norm(), 0.03);
  EXPECT_TRUE(
      CornerExtractor({}).extract(Points(5000, Eigen::Vector3f::Constant(nan)), Eigen::Matrix3d::Identity()).empty());
  EXPECT_TRUE(CornerExtractor({}).extract(Points(5000, {8.0F, 3.0F, 0.0F}), Eigen::Matrix3d::Identity()).empty());
  EXPECT_TRUE(CornerExtractor({}).extract(points, Eigen::Matrix3d::Constant(std::nan(""))).empty());
}

TEST(CornerExtraction, PointsAtTheGridsEdgeStayInside) {
  CornerExtractor::Params params;
  params.max_range_m = 10.0;
  for (const double cell_m : {0.1, 0.3, 0.4, 7.0}) {
    params.cell_m = cell_m;
    Points points;
    for (int i = 0; i < 4000; ++i) {
      const float angle = 0.00157F * static_cast<float>(i);
      points.emplace_back(9.9999995F * std::cos(angle), 9.9999995F * std::sin(angle), 0.001F * static_cast<float>(i));
    }
    CornerExtractor(params).extract(points, Eigen::Matrix3d::Identity());  // run under a sanitizer to be of use
  }
}

TEST(CornerExtraction, BadParametersThrow) {
  CornerExtractor::Params params;
  params.max_range_m = 1.0;
  EXPECT_THROW(validate(params), ParameterError);
  params = {};
  params.min_beams_per_cell = 65;
  EXPECT_THROW(validate(params), ParameterError);
}

}  // namespace
}  // namespace fail_aware::corner_extraction_test
