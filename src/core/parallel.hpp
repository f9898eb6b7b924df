// Work side by side on TBB's threads. All that the package shares out to threads goes through here.
//
// TBB is not built with ThreadSanitizer, which so sees neither that a task begins after it was handed over nor that it ends
// before the one who waits goes on. Here both are told to it; what tasks share beyond that it finds. Elsewhere that costs
// nothing. Results do not depend on the number of threads, and what throws in a task throws here.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace fail_aware {

/// Of work to tasks, and of what they did back to the one who waits.
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

/// Two pieces of work.
template <class First, class Second>
void inParallel(const First& first, const Second& second) {
  HandOver hand_over;
  tbb::parallel_invoke([&] { hand_over.run(first); }, [&] { hand_over.run(second); });
  hand_over.joined();
}

/// body(0) ... body(count - 1).
template <class Body>
void inParallelFor(std::size_t count, const Body& body) {
  HandOver hand_over;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { hand_over.run([&] { body(i); }); });
  hand_over.joined();
}

/// The sum over [begin, end) by halves, down to pieces of at most `piece`: sum_of(begin, end) of a piece, a + b of two
/// halves. The order of the additions depends on the three numbers only.
template <class Sum, class SumOf>
Sum sumByHalves(std::size_t begin, std::size_t end, std::size_t piece, const SumOf& sum_of) {
  if (end - begin <= piece) return sum_of(begin, end);
  const std::size_t middle = begin + (end - begin) / 2;
  Sum first, second;
  inParallel([&] { first = sumByHalves<Sum>(begin, middle, piece, sum_of); },
             [&] { second = sumByHalves<Sum>(middle, end, piece, sum_of); });
  return first + second;
}

/// In that arena's threads, which may be others than this one.
template <class Work>
void inArena(tbb::task_arena& arena, const Work& work) {
  HandOver hand_over;
  arena.execute([&] { hand_over.run(work); });
  hand_over.joined();
}

}  // namespace fail_aware
