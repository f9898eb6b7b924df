#include "simulation/scene_kind.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parameters/check.hpp"

namespace fail_aware::scene_kind_test {
namespace {

TEST(ScenePlan, OnePartLastsForEver) {
  const ScenePlan plan = ScenePlan::parse("country", 60.0);
  EXPECT_EQ(plan.kindAt(-100.0), SceneKind::kCountry);
  EXPECT_EQ(plan.kindAt(1e7), SceneKind::kCountry);
}

TEST(ScenePlan, PartsFollowEachOther) {
  const ScenePlan plan = ScenePlan::parse("town:250,tunnel:100,open", 60.0);
  EXPECT_EQ(plan.kindAt(-50.0), SceneKind::kTown);
  EXPECT_EQ(plan.kindAt(249.0), SceneKind::kTown);
  EXPECT_EQ(plan.kindAt(250.0), SceneKind::kTunnel);
  EXPECT_EQ(plan.kindAt(351.0), SceneKind::kOpen);
  EXPECT_EQ(plan.partAt(300.0).begin_m, 250.0);
  EXPECT_EQ(plan.partAt(300.0).end_m, 350.0);
  EXPECT_TRUE(std::isinf(plan.partAt(400.0).end_m));
  EXPECT_EQ(plan.grade(), roadCharacter(SceneKind::kTunnel).grade);
}

TEST(ScenePlan, PartsWithoutLengthShareTheTime) {
  const ScenePlan plan = ScenePlan::parse("town,tunnel", 60.0);
  EXPECT_EQ(plan.kindAt(100.0), SceneKind::kTown);
  EXPECT_EQ(plan.kindAt(400.0), SceneKind::kTunnel);
}

TEST(ScenePlan, RefusesNonsenseByName) {
  for (const char* text : {"", "city", "town,", ",town", "town:", "town:x", "town:-5", "town:0", "town:1e400"}) {
    EXPECT_THROW(ScenePlan::parse(text, 60.0), ParameterError) << text;
  }
  try {
    ScenePlan::parse("town,city", 60.0);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("'city'"), std::string::npos);
  }
}

}  // namespace
}  // namespace fail_aware::scene_kind_test
