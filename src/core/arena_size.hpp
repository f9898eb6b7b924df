// Threads of a TBB arena: those asked for, but no more than the machine runs (TBB warns of more).
#pragma once

namespace fail_aware {

int arenaSize(int threads);

}  // namespace fail_aware
