#include "solver/processors.hpp"

#if defined(__linux__)

#include <sched.h>

namespace cycloid::solver {

int processor_now() {
  return sched_getcpu();
}

Processors::Processors() {
  cpu_set_t given;
  if (sched_getaffinity(0, sizeof given, &given) != 0) return;
  may_.assign(CPU_SETSIZE, 0);
  for (std::size_t i = 0; i < may_.size(); ++i) {
    if (!CPU_ISSET(i, &given)) continue;
    may_[i] = 1;
    ++count_;
  }
}

void Processors::leave(int processor) const {
  cpu_set_t others;
  CPU_ZERO(&others);
  bool any = false;
  for (std::size_t i = 0; i < may_.size(); ++i) {
    if (may_[i] == 0 || static_cast<int>(i) == processor) continue;
    CPU_SET(i, &others);
    any = true;
  }
  if (any) sched_setaffinity(0, sizeof others, &others);
}

}  // namespace cycloid::solver

#else

namespace cycloid::solver {

int processor_now() {
  return -1;
}
Processors::Processors() = default;
void Processors::leave(int) const {}

}  // namespace cycloid::solver

#endif
