#include "core/registration/corner_svd/corner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/rotation.hpp"

namespace fail_aware::corner_test {
namespace {

// A house's corner at (x, y): one wall along x, one along y, both seen.
Corner cornerAt(double x, double y) {
  Corner corner;
  corner.M = {x, y, 0.0};
  corner.J = corner.M + Eigen::Vector3d(0, 0, 0.5);
  corner.N = corner.M + Eigen::Vector3d(1, 0, 0);
  corner.planes[0].normal = {0, -1, 0};
  corner.planes[1].normal = {-1, 0, 0};
  corner.planes[0].rms_m = 0.01;
  corner.planes[1].rms_m = 0.02;
  corner.planes[0].points = 100;
  corner.planes[1].points = 200;
  corner.planes[0].rectangle = {{x, y, -1.0}, {x + 4.0, y, 2.0}};
  corner.planes[1].rectangle = {{x, y, -1.0}, {x, y + 3.0, 2.0}};
  return corner;
}

TEST(Corner, MovesAsABody) {
  Pose T = Pose::Identity();
  T.linear() = rotationFromRpy(0.1, 0.2, 0.3);
  T.translation() = Eigen::Vector3d(1, 2, 3);
  const Corner moved = movedCorner(T, cornerAt(4, 5));
  EXPECT_TRUE(moved.N.isApprox(T * Eigen::Vector3d(5, 5, 0)));
  EXPECT_TRUE(moved.planes[1].normal.isApprox(T.linear() * Eigen::Vector3d(-1, 0, 0)));
  EXPECT_NEAR((moved.J - moved.M).norm(), 0.5, 1e-12);
  EXPECT_TRUE(moved.planes[0].rectangle.low.isApprox(T * Eigen::Vector3d(4, 5, -1)));
  EXPECT_TRUE(moved.planes[0].rectangle.high.isApprox(T * Eigen::Vector3d(8, 5, 2)));
}

TEST(Corner, ItsWallsStayWhereTheyAre) {
  const Corner corner = cornerAt(4, 5), slid = atHeight(corner, 1.0), swapped = withOtherPlane(corner);
  EXPECT_EQ(slid.planes[1].rectangle.high, corner.planes[1].rectangle.high);
  EXPECT_EQ(swapped.planes[0].rectangle.high, corner.planes[1].rectangle.high);
  EXPECT_EQ(swapped.planes[1].rectangle.low, corner.planes[0].rectangle.low);
}

TEST(Corner, SlidesAlongItsTiltedLine) {
  Pose tilt = Pose::Identity();
  tilt.linear() = rotationFromRpy(0.0, 0.1, 0.0);
  const Corner corner = movedCorner(tilt, cornerAt(4, 5)), slid = atHeight(corner, 2.0);
  EXPECT_NEAR(slid.M.z(), 2.0, 1e-12);
  EXPECT_NEAR((slid.M - corner.M).cross(corner.lineDirection()).norm(), 0.0, 1e-12);
  EXPECT_TRUE((slid.N - slid.M).isApprox(corner.N - corner.M));
}

TEST(Corner, TheOtherPlaneHasNOnTheSideOfGrowingX) {
  Pose turn = Pose::Identity();
  turn.linear() = rotationFromRpy(0, 0, 0.6);
  const Corner corner = movedCorner(turn, cornerAt(4, 5)), other = withOtherPlane(corner);
  EXPECT_NEAR((other.N - other.M).norm(), 1.0, 1e-12);
  EXPECT_GT(other.N.x(), other.M.x());
  EXPECT_NEAR((other.N - other.M).dot(corner.planes[1].normal), 0.0, 1e-12);
  EXPECT_EQ(other.planes[0].points, corner.planes[1].points);
  EXPECT_TRUE(withOtherPlane(other).N.isApprox(corner.N));
}

TEST(Corner, OnlyTheNearestOfEachOtherMatch) {
  const std::vector<Corner> now{cornerAt(0.0, 0.0), cornerAt(0.3, 0.0), cornerAt(10, 0)};
  const std::vector<Corner> before{cornerAt(20, 0), cornerAt(0.25, 0.0)};
  const std::vector<CornerPair> pairs = matchCorners(now, before, 0.5, 15.0);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].first, 1u);
  EXPECT_EQ(pairs[0].second, 1u);
  EXPECT_EQ(pairs[0].corner.N, now[1].N);
}

TEST(Corner, HeightDoesNotCountAsDistance) {
  Corner high = atHeight(cornerAt(1, 1), 3.0);
  const std::vector<CornerPair> pairs = matchCorners({high}, {cornerAt(1, 1)}, 0.1, 15.0);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].corner.M, cornerAt(1, 1).M);
}

TEST(Corner, WallsThatLookElsewhereDoNotMatch) {
  Pose turn = Pose::Identity();
  for (const double deg : {10.0, 20.0, 90.0, 180.0}) {
    turn.linear() = rotationFromRpy(0, 0, deg * 3.14159265 / 180.0);
    const bool match = matchCorners({movedCorner(turn, cornerAt(0, 0))}, {cornerAt(0, 0)}, 0.5, 15.0).size() == 1;
    EXPECT_EQ(match, deg < 15.0) << deg;
  }
}

TEST(Corner, PlanesInTheOtherOrderAreRecognised) {
  const std::vector<CornerPair> pairs = matchCorners({withOtherPlane(cornerAt(0, 0))}, {cornerAt(0, 0)}, 0.5, 15.0);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_TRUE(pairs[0].corner.N.isApprox(cornerAt(0, 0).N));
}

TEST(Corner, ACornerThatIsNotFiniteMatchesNothing) {
  Corner bad = cornerAt(0, 0);
  bad.M.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(matchCorners({bad}, {cornerAt(0, 0)}, 0.5, 15.0).empty());
  EXPECT_TRUE(matchCorners({}, {cornerAt(0, 0)}, 0.5, 15.0).empty());
}

}  // namespace
}  // namespace fail_aware::corner_test
