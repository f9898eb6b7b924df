#include "core/initial_guess/occlusion_image.hpp"

#include <gtest/gtest.h>

namespace fail_aware::occlusion_image_test {
namespace {

using Vector3 = Eigen::Vector3d;

/// A wall 10 m ahead of a lidar that is 2 m above the origin: 4 m wide, from 1 to 3 m high.
OcclusionImage wallAhead() {
  AboveGroundPoints things;
  for (double y = -2.0; y <= 2.0; y += 0.05) {
    for (double z = 1.0; z <= 3.0; z += 0.05) things.points.push_back({Vector3(10.0, y, z), 0});
  }
  return {things, Vector3(0.0, 0.0, 2.0)};
}

TEST(OcclusionImage, HidesWhatIsBehindAThing) {
  const OcclusionImage image = wallAhead();
  EXPECT_TRUE(image.hides(Vector3(20.0, 0.0, 2.0)));
  EXPECT_TRUE(image.hides(Vector3(20.0, 3.5, 0.5)));
  EXPECT_FALSE(image.hides(Vector3(20.0, 4.6, 2.0))) << "beside the wall";
  EXPECT_FALSE(image.hides(Vector3(20.0, 0.0, 4.7))) << "above the wall";
  EXPECT_FALSE(image.hides(Vector3(-20.0, 0.0, 2.0))) << "in the other direction";
}

TEST(OcclusionImage, HidesNothingOnOrBeforeAThing) {
  const OcclusionImage image = wallAhead();
  EXPECT_FALSE(image.hides(Vector3(5.0, 0.0, 2.0)));
  EXPECT_FALSE(image.hides(Vector3(10.0, 0.0, 2.0)));
  EXPECT_FALSE(image.hides(Vector3(10.8, 0.0, 2.0)));
  EXPECT_TRUE(image.hides(Vector3(11.3, 0.0, 2.0)));
}

TEST(OcclusionImage, AnswersForEveryDirection) {
  const OcclusionImage image = wallAhead();
  for (const Vector3& point : {Vector3(0.0, 0.0, 2.0), Vector3(0.0, 0.0, 90.0), Vector3(0.0, 0.0, -90.0),
                               Vector3(-1.0, 0.0, 2.0), Vector3(-1.0, -0.0, 2.0)}) {
    EXPECT_FALSE(image.hides(point)) << point.transpose();
  }
}

TEST(OcclusionImage, HidesNothingWithoutThings) {
  EXPECT_FALSE(OcclusionImage().hides(Vector3(20.0, 0.0, 0.0)));
  EXPECT_FALSE(OcclusionImage({}, Vector3::Zero()).hides(Vector3(20.0, 0.0, 0.0)));
}

}  // namespace
}  // namespace fail_aware::occlusion_image_test
