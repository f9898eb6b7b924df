#include "core/parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <vector>

namespace fail_aware::parallel_test {
namespace {

TEST(Parallel, TwoPiecesOfWorkAreBothDone) {
  int first = 0, second = 0;
  inParallel([&] { first = 1; }, [&] { second = 2; });
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 2);
}

TEST(Parallel, EachIndexIsDoneOnce) {
  std::vector<int> done(1000, 0);
  inParallelFor(done.size(), [&](std::size_t i) { ++done[i]; });
  EXPECT_EQ(done, std::vector<int>(1000, 1));
  inParallelFor(0, [](std::size_t) { FAIL(); });
}

double sumOfInverses(int threads, std::size_t count) {
  tbb::task_arena arena(threads);
  double sum = 0.0;
  inArena(arena, [&] {
    sum = sumByHalves<double>(1, count, 100, [](std::size_t begin, std::size_t end) {
      double piece = 0.0;
      for (std::size_t i = begin; i < end; ++i) piece += 1.0 / static_cast<double>(i);
      return piece;
    });
  });
  return sum;
}

TEST(Parallel, ASumByHalvesHasTheSameBitsForAnyThreads) {
  EXPECT_NEAR(sumOfInverses(1, 10001), 9.787606036044348, 1e-12);
  EXPECT_EQ(sumOfInverses(1, 10001), sumOfInverses(4, 10001));
  EXPECT_EQ(sumOfInverses(2, 1), 0.0) << "of nothing";
}

TEST(Parallel, AnArenaIsAsAskedForUpToWhatTheMachineRuns) {
  EXPECT_EQ(arenaSize(1), 1);
  EXPECT_GE(arenaSize(1000000), 1);
  EXPECT_LE(arenaSize(1000000), static_cast<int>(std::thread::hardware_concurrency()));
}

TEST(Parallel, WhatIsThrownInATaskComesOut) {
  tbb::task_arena arena(2);
  const auto throwing = [](std::size_t i) {
    if (i == 7) throw std::runtime_error("seven");
  };
  EXPECT_THROW(inArena(arena, [&] { inParallelFor(10, throwing); }), std::runtime_error);
}

}  // namespace
}  // namespace fail_aware::parallel_test
