#include "core/estimation/sweep_scheduler.hpp"

#include <gtest/gtest.h>

namespace fail_aware::sweep_scheduler_test {
namespace {

SweepScheduler::Sweep sweep(std::uint64_t number, double arrived_s = 0.0, double set_back_s = 0.0) {
  return {number, "lidar", arrived_s, set_back_s};
}

SweepScheduler ofThreeThatMayWait() {
  SweepScheduler scheduler;
  SweepScheduler::Params params;
  params.queue_size = 3;
  scheduler.setParams(params);
  return scheduler;
}

/// The number of the next sweep, which is closed at once; 0: none.
std::uint64_t next(SweepScheduler& scheduler) {
  const auto opened = scheduler.open(0.0);
  scheduler.close();
  return opened ? opened->stamp_ns : 0;
}

TEST(SweepScheduler, SweepsAreOpenedOneByOneInTheirOrder) {
  SweepScheduler scheduler;
  EXPECT_FALSE(scheduler.open(0.0));
  for (std::uint64_t i = 1; i <= 3; ++i) scheduler.offer(sweep(i));
  EXPECT_EQ(scheduler.open(0.0)->stamp_ns, 1u);
  EXPECT_FALSE(scheduler.open(0.0)) << "one is open";
  EXPECT_EQ(scheduler.current()->stamp_ns, 1u);
  scheduler.close();
  EXPECT_EQ(next(scheduler), 2u);
  EXPECT_EQ(next(scheduler), 3u);
  EXPECT_EQ(next(scheduler), 0u);
  EXPECT_EQ(scheduler.takeDropped(), 0);
}

TEST(SweepScheduler, OverloadDropsTheOldestAndCountsIt) {
  SweepScheduler scheduler = ofThreeThatMayWait();
  for (std::uint64_t i = 1; i <= 4; ++i) scheduler.offer(sweep(i));
  EXPECT_EQ(scheduler.counts().overload, 2u) << "two may wait now";
  EXPECT_EQ(scheduler.takeDropped(), 2);
  EXPECT_EQ(scheduler.takeDropped(), 0) << "told once";
  EXPECT_EQ(next(scheduler), 3u);
}

TEST(SweepScheduler, LongOverloadLeavesTheNewestOnly) {
  SweepScheduler scheduler = ofThreeThatMayWait();
  std::uint64_t number = 0;
  const auto offer = [&](int sweeps) {
    for (int k = 0; k < sweeps; ++k) scheduler.offer(sweep(++number));
  };
  offer(6);
  for (int round = 0; round < 3; ++round) {
    offer(2);
    EXPECT_EQ(next(scheduler), number);
  }
  EXPECT_EQ(scheduler.counts().overload, 9u);
  EXPECT_EQ(next(scheduler), 0u) << "caught up";
  offer(3);
  EXPECT_EQ(scheduler.counts().overload, 9u) << "three may wait again";
}

TEST(SweepScheduler, DroppedSweepLeavesItsSetBackToTheNext) {
  SweepScheduler scheduler;
  SweepScheduler::Params params;
  params.queue_size = 1;
  scheduler.setParams(params);
  scheduler.offer(sweep(1, 0.0, 0.25));
  scheduler.offer(sweep(2));
  EXPECT_EQ(scheduler.open(0.0)->set_back_s, 0.25);
}

TEST(SweepScheduler, RefusedCloudsAreCountedByTheirCause) {
  using Cause = SweepScheduler::Cause;
  SweepScheduler scheduler;
  for (Cause cause :
       {Cause::kDuplicate, Cause::kReordered, Cause::kFarAhead, Cause::kUnusableStamp, Cause::kWrongFrame}) {
    scheduler.refuse(cause);
  }
  const SweepScheduler::Counts& counts = scheduler.counts();
  EXPECT_EQ(counts.duplicate + counts.reordered + counts.far_ahead + counts.unusable_stamp + counts.wrong_frame, 5u);
  EXPECT_EQ(scheduler.takeDropped(), 5);
  EXPECT_EQ(scheduler.lastRefused(), "another frame");
}

TEST(SweepScheduler, SourcesAtWorkAreWaitedForLonger) {
  SweepScheduler scheduler;
  scheduler.setParams({3, 0.25, 0.6, 10.0});
  EXPECT_FALSE(scheduler.isOverdue(100.0, false)) << "none is open";
  scheduler.offer(sweep(1, 5.0));
  scheduler.open(5.2);
  EXPECT_EQ(scheduler.longest_s(), 0.6);
  EXPECT_FALSE(scheduler.isOverdue(5.4, false));
  EXPECT_TRUE(scheduler.isOverdue(5.46, false));
  EXPECT_FALSE(scheduler.isOverdue(5.46, true));
  EXPECT_TRUE(scheduler.isOverdue(5.61, true)) << "what it waited for its turn is taken off";
  scheduler.setSearches(true);
  EXPECT_EQ(scheduler.longest_s(), 10.0);
  EXPECT_FALSE(scheduler.isOverdue(15.1, true));
  EXPECT_TRUE(scheduler.isOverdue(15.3, true));
  scheduler.close();
  scheduler.offer(sweep(2, 5.0));
  scheduler.open(5.2);
  EXPECT_FALSE(scheduler.searches()) << "of each sweep anew";
}

TEST(SweepScheduler, NewDriveLosesWhatWaitsAndWhatIsOpen) {
  SweepScheduler scheduler;
  scheduler.offer(sweep(1));
  scheduler.open(0.0);
  scheduler.offer(sweep(2));
  scheduler.clear();
  EXPECT_FALSE(scheduler.current());
  EXPECT_EQ(scheduler.counts().reset, 2u);
  EXPECT_EQ(next(scheduler), 0u);
}

}  // namespace
}  // namespace fail_aware::sweep_scheduler_test
