#include "core/registration/corner_svd/corner_reference.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/geometry/rotation.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/validate.hpp"

namespace fail_aware::corner_reference_test {
namespace {

Corner cornerAt(double x, double y) {
  Corner corner;
  corner.M = {x, y, 0.0};
  corner.J = {x, y, 0.5};
  corner.N = {x + 1.0, y, 0.0};
  corner.planes[0].normal = {0, -1, 0};
  corner.planes[1].normal = {-1, 0, 0};
  return corner;
}

Pose at(double x) {
  Pose T = Pose::Identity();
  T.translation().x() = x;
  return T;
}

CornerReference::Params keeping(int sweeps) {
  CornerReference::Params params;
  params.sweeps = sweeps;
  return params;
}

TEST(CornerReference, WithOneSweepItIsTheLastSweepsCorners) {
  CornerReference reference(keeping(1));
  reference.update({cornerAt(10, 0), cornerAt(20, 0)}, at(0));
  reference.update({cornerAt(9.1, 0)}, at(1));
  ASSERT_EQ(reference.corners().size(), 1u);
  EXPECT_NEAR(reference.corners()[0].M.x(), 10.1, 1e-12) << "no mean with the sweep before";
  reference.update({}, at(2));
  EXPECT_TRUE(reference.corners().empty());
}

TEST(CornerReference, ACornerStaysForSoManySweepsUnseen) {
  CornerReference reference(keeping(3));
  reference.update({cornerAt(10, 0)}, at(0));
  for (int sweep = 1; sweep <= 2; ++sweep) {
    reference.update({}, at(0));
    EXPECT_EQ(reference.corners().size(), 1u) << sweep;
  }
  reference.update({}, at(0));
  EXPECT_TRUE(reference.corners().empty());
}

TEST(CornerReference, SeenAgainItIsTheMeanAndLivesOn) {
  CornerReference reference(keeping(2));
  for (const double x : {10.0, 10.1, 9.9, 10.2}) reference.update({cornerAt(x - 4.0, 0)}, at(4));
  ASSERT_EQ(reference.corners().size(), 1u);
  const Corner& corner = reference.corners()[0];
  EXPECT_NEAR(corner.M.x(), 10.05, 1e-12);
  EXPECT_NEAR((corner.J - corner.M).norm(), 0.5, 1e-12);
  EXPECT_NEAR((corner.N - corner.M).norm(), 1.0, 1e-12);
}

TEST(CornerReference, ItDoesNotCreepAlongWithDrift) {
  CornerReference reference(keeping(20));
  for (int sweep = 0; sweep < 50; ++sweep) reference.update({cornerAt(10 + 0.004 * sweep, 0)}, at(0));
  ASSERT_EQ(reference.corners().size(), 1u);
  EXPECT_LT(reference.corners()[0].M.x(), 10.11) << "half of the 0.2 m that the sightings moved";
}

TEST(CornerReference, SwappedPlanesAreTheSameCorner) {
  CornerReference reference(keeping(20));
  reference.update({cornerAt(10, 0)}, at(0));
  reference.update({withOtherPlane(atHeight(cornerAt(10, 0), 1.5))}, at(0));
  ASSERT_EQ(reference.corners().size(), 1u);
  EXPECT_TRUE(reference.corners()[0].M.isApprox(Eigen::Vector3d(10, 0, 0)));
  EXPECT_TRUE(reference.corners()[0].N.isApprox(Eigen::Vector3d(11, 0, 0)));
}

TEST(CornerReference, FarCornersAreForgotten) {
  CornerReference reference(keeping(20));
  reference.update({cornerAt(10, 0)}, at(0));
  reference.update({}, at(69));
  EXPECT_EQ(reference.corners().size(), 1u);
  reference.update({}, at(71));
  EXPECT_TRUE(reference.corners().empty());
}

TEST(CornerReference, AnEstimateThatIsNoNumberIsPassedOver) {
  CornerReference reference(keeping(20));
  reference.update({cornerAt(10, 0)}, at(0));
  reference.update({cornerAt(5, 0)}, at(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(reference.corners().size(), 1u);
  reference.clear();
  EXPECT_TRUE(reference.corners().empty());
}

TEST(CornerReference, BadParametersThrow) { EXPECT_THROW(validate(keeping(0)), ParameterError); }

}  // namespace
}  // namespace fail_aware::corner_reference_test
