// Parallel work on TBB's threads. All multithreading of the package goes through this file.
//
// TBB is not built with ThreadSanitizer. ThreadSanitizer therefore does not see that a task begins after it was
// submitted, nor that it ends before the waiting thread continues. This file tells ThreadSanitizer both; it still finds
// any other data race between tasks. In other builds this costs nothing. Results do not depend on the number of
// threads. An exception in a task is thrown to the caller.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace fail_aware {

/// Tells ThreadSanitizer that work passes to tasks and that its results pass back to the waiting thread.
class HandOver {
 public:
  HandOver() { tell(&given_); }

  template <class Task>
  void run(const Task& task) {
    hear(&given_);
    task();
    tell(&done_);
  }

  void joined() { hear(&done_); }

 private:
#if defined(__SANITIZE_THREAD__)
  static void tell(char* what) { __tsan_release(what); }
  static void hear(char* what) { __tsan_acquire(what); }
#else
  static void tell(char*) {}
  static void hear(char*) {}
#endif

  char given_ = 0, done_ = 0;
};

/// Runs both in parallel.
template <class First, class Second>
void inParallel(const First& first, const Second& second) {
  HandOver hand_over;
  tbb::parallel_invoke([&] { hand_over.run(first); }, [&] { hand_over.run(second); });
  hand_over.joined();
}

/// Calls body(0) ... body(count - 1) in parallel.
template <class Body>
void inParallelFor(std::size_t count, const Body& body) {
  HandOver hand_over;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { hand_over.run([&] { body(i); }); });
  hand_over.joined();
}

/// Sums over [begin, end) by halving it down to pieces of at most `piece`: sum_of(begin, end) for a piece, a + b for
/// two halves. The order of the additions depends only on begin, end and piece.
template <class Sum, class SumOf>
Sum sumByHalves(std::size_t begin, std::size_t end, std::size_t piece, const SumOf& sum_of) {
  if (end - begin <= piece) return sum_of(begin, end);
  const std::size_t middle = begin + (end - begin) / 2;
  Sum first, second;
  inParallel([&] { first = sumByHalves<Sum>(begin, middle, piece, sum_of); },
             [&] { second = sumByHalves<Sum>(middle, end, piece, sum_of); });
  return first + second;
}

/// Number of threads of an arena: as asked for, up to what the machine runs (TBB warns above that).
inline int arenaSize(int threads) { return std::min(threads, tbb::this_task_arena::max_concurrency()); }

/// Runs the work in that arena's threads, which may differ from the calling one.
template <class Work>
void inArena(tbb::task_arena& arena, const Work& work) {
  HandOver hand_over;
  arena.execute([&] { hand_over.run(work); });
  hand_over.joined();
}

}  // namespace fail_aware
