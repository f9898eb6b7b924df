#include "core/arena_size.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace fail_aware::arena_size_test {
namespace {

TEST(ArenaSize, IsAsAskedForUpToWhatTheMachineRuns) {
  EXPECT_EQ(arenaSize(1), 1);
  EXPECT_GE(arenaSize(1000000), 1);
  EXPECT_LE(arenaSize(1000000), static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace fail_aware::arena_size_test
