// What the threads have in common that refine something while the window goes on.
#pragma once

#include <algorithm>
#include <chrono>
#include <sys/resource.h>

namespace nf::editor {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Gives way to all others by `nice`, 0 to 19, beyond `base`, the priority that the thread began with. Linux has one for
// each thread, and the threads that a tracer starts have that of the one that starts them. Where the process may not
// become quicker again it stays slow: nothing to be done.
inline void give_way(int base, int nice) {
  setpriority(PRIO_PROCESS, 0, std::min(base + std::clamp(nice, 0, 19), 19));
}

}  // namespace nf::editor
