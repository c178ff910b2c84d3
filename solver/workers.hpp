#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

namespace cycloid::solver {

/// Indices [begin, end).
struct Range {
  int begin = 0;
  int end = 0;
};

/// A count that all threads add to. Who adds first cannot be seen as long as only this is asked:
/// whether the sum of all is over a limit, and what follows if it is does not use who was cut
/// short.
class Tally {
 public:
  explicit Tally(std::uint64_t limit) : limit_(limit) {}
  void add(std::uint64_t count) { sum_.fetch_add(count, std::memory_order_relaxed); }
  bool is_over() const { return sum_.load(std::memory_order_relaxed) > limit_; }

 private:
  std::uint64_t limit_;
  std::atomic<std::uint64_t> sum_{0};
};

/// A fixed pool that runs ranges. The only thread-aware code of the solver.
///
/// The split into ranges of `grain` depends on the work alone, never on the number of threads, and
/// every range writes what no other reads or writes; so which thread runs a range cannot be seen.
/// On a target without threads the calling thread runs them all.
class Workers {
 public:
  /// @pre 1 <= count <= 64; the calling thread is one of them.
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int count() const { return count_; }

  /// Calls run(Range) for consecutive ranges that cover [0, size); returns when all are done.
  template <class Run>
  void parallel_for(int size, int grain, Run&& run) {
    if (size <= grain || count_ == 1) {
      for (int begin = 0; begin < size; begin += grain)
        run(Range{begin, begin + grain < size ? begin + grain : size});
      return;
    }
    dispatch(size, grain, &run,
             [](void* context, Range range) { (*static_cast<Run*>(context))(range); });
  }

 private:
  using Call = void (*)(void*, Range);
  void dispatch(int size, int grain, void* context, Call call);

  struct Threads;
  int count_;
  std::unique_ptr<Threads> threads_;
};

}  // namespace cycloid::solver
