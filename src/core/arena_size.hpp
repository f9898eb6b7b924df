// Number of threads of a TBB arena: the requested number, limited to what the machine runs (TBB warns above that).
#pragma once

namespace fail_aware {

int arenaSize(int threads);

}  // namespace fail_aware
