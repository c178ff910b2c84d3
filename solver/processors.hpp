#pragma once

#include <cstdint>
#include <vector>

namespace cycloid::solver {

/// The processor that runs the calling thread; below 0 where the system does not say. No result may
/// depend on it, only where a thread goes on.
int processor_now();

/// The processors that the calling thread may run on, as it finds them.
class Processors {
 public:
  Processors();
  /// 0 where the system does not say.
  int count() const { return count_; }
  /// Has the calling thread go on at once, and from now on, on any of them but this one. Does
  /// nothing where that is none, or the system does not let it.
  void leave(int processor) const;

 private:
  std::vector<std::uint8_t> may_;  ///< By number.
  int count_ = 0;
};

}  // namespace cycloid::solver
