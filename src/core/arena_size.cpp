#include "core/arena_size.hpp"

#include <tbb/task_arena.h>

#include <algorithm>

namespace fail_aware {

int arenaSize(int threads) { return std::min(threads, tbb::this_task_arena::max_concurrency()); }

}  // namespace fail_aware
