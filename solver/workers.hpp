#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

namespace cycloid::solver {

/// Indices [begin, end).
struct Range {
  int begin = 0;
  int end = 0;
};

/// A count that all threads add to. Who adds first cannot be seen as long as only this is asked:
/// whether the sum of all is over a limit, and what follows if it is does not use who was cut
/// short; and the sum, once all are done.
class Tally {
 public:
  explicit Tally(std::uint64_t limit = 0) : limit_(limit) {}
  void add(std::uint64_t count) {
    if (count > 0) sum_.fetch_add(count, std::memory_order_relaxed);
  }
  bool is_over() const { return sum() > limit_; }
  std::uint64_t sum() const { return sum_.load(std::memory_order_relaxed); }

 private:
  std::uint64_t limit_;
  std::atomic<std::uint64_t> sum_{0};
};

/// How many hold a thing, whichever threads take and drop it. Begins with one.
class OwnerCount {
 public:
  void take() { owners_.fetch_add(1, std::memory_order_relaxed); }
  /// Whether the one that drops it was the last; then it may end the thing.
  bool drop() { return owners_.fetch_sub(1, std::memory_order_acq_rel) == 1; }
  /// Whether who asks holds it alone; then what others did with it is done.
  bool is_one() const { return owners_.load(std::memory_order_acquire) == 1; }

 private:
  std::atomic<std::uint32_t> owners_{1};
};

/// Numbers from 0 on, below how many threads there are, each lent to one at a time: which part of a
/// memory is whose. Who has which cannot be seen, as long as nothing is read there that its
/// borrower has not written.
class Seats {
 public:
  int take() {
    std::uint64_t free = free_.load(std::memory_order_relaxed);
    while (!free_.compare_exchange_weak(free, free & (free - 1), std::memory_order_acquire)) {
    }
    return std::countr_zero(free);
  }
  void give_back(int seat) { free_.fetch_or(std::uint64_t{1} << seat, std::memory_order_release); }

 private:
  std::atomic<std::uint64_t> free_{~std::uint64_t{0}};  ///< As many as there may be workers.
};

/// A number that is made of what does not change, once. Two threads that ask for it at the same
/// time may both make it, and make the same.
class KeptNumber {
 public:
  KeptNumber() = default;
  KeptNumber(const KeptNumber& other) : number_(other.load()) {}
  /// What it was made of has gone with it.
  KeptNumber(KeptNumber&& other) noexcept : number_(other.load()) { other.forget(); }
  KeptNumber& operator=(KeptNumber other) noexcept {
    number_.store(other.load(), std::memory_order_relaxed);
    return *this;
  }

  template <class Make>
  std::uint64_t get(Make&& make) {
    std::uint64_t number = load();
    if (number != kNotMade) return number;
    number = make();
    number_.store(number, std::memory_order_relaxed);
    return number;
  }
  /// @pre nobody else asks for it.
  void forget() { number_.store(kNotMade, std::memory_order_relaxed); }

 private:
  std::uint64_t load() const { return number_.load(std::memory_order_relaxed); }

  static constexpr std::uint64_t kNotMade = 0;  // Were it made 0, it would be made each time.
  std::atomic<std::uint64_t> number_{kNotMade};
};

/// Things that are lent for a while, from any thread, and kept for whoever comes next: who borrows
/// gets one that somebody gave back, whatever is left in it, or a new one.
template <class T>
class Depot {
 public:
  Depot() = default;
  Depot(const Depot&) = delete;
  Depot& operator=(const Depot&) = delete;
  ~Depot() {
    for (std::atomic<T*>& place : places_) delete place.load();
  }

  std::unique_ptr<T> borrow() {
    for (std::atomic<T*>& place : places_)
      if (place.load(std::memory_order_relaxed) != nullptr)
        if (T* kept = place.exchange(nullptr, std::memory_order_acquire); kept != nullptr)
          return std::unique_ptr<T>(kept);
    return std::make_unique<T>();
  }
  /// What finds no place ends.
  void give_back(std::unique_ptr<T> thing) {
    for (std::atomic<T*>& place : places_) {
      T* none = nullptr;
      if (place.compare_exchange_strong(none, thing.get(), std::memory_order_release,
                                        std::memory_order_relaxed)) {
        thing.release();
        return;
      }
    }
  }

 private:
  std::array<std::atomic<T*>, 64> places_{};  ///< As many as there may be workers.
};

/// How often a thread of Workers::together has come to a meeting: in a line of its own, which only
/// it writes and all others look at.
struct alignas(64) Meetings {
  std::atomic<std::uint32_t> count{0};
};

/// One of the threads that do a job together, or the only one.
class Member {
 public:
  Member() = default;
  Member(int number, int count, Meetings* meetings)
      : number_(number), count_(count), meetings_(meetings) {}

  /// Its part of a range, in pieces of two: the same part in every job, so what it reads is what it
  /// wrote before. A range of few pieces has no part for some.
  Range share_of(const Range& whole) const {
    if (count_ == 1) return whole;
    return {begin_of(number_, whole), leads() ? whole.end : begin_of(number_ + 1, whole)};
  }
  /// From 0 on; the one that leads is the last.
  int number() const { return number_; }
  /// Whether it is the one that does what is not shared: the thread that has called.
  bool leads() const { return number_ == count_ - 1; }
  /// Waits for all others to come as often; then each sees what any has written before.
  /// @pre all of them come as often.
  void meet() {
    if (count_ > 1) wait_for_others();
  }

 private:
  int begin_of(int number, const Range& whole) const {
    constexpr std::int64_t kPiece = 2;
    const std::int64_t pieces = (whole.end - whole.begin + kPiece - 1) / kPiece;
    return whole.begin + static_cast<int>(pieces * number / count_ * kPiece);
  }
  void wait_for_others();

  int number_ = 0;
  int count_ = 1;
  Meetings* meetings_ = nullptr;  ///< Of each member; null where it is alone.
};

/// A fixed pool that runs ranges. The only thread-aware code of the solver.
///
/// Ranges of `grain` depend on the work alone, parts of a Member on the number of threads as well.
/// Neither can be seen, nor which thread runs what: each writes what no other reads or writes at
/// the same time, and what comes of an index does not depend on where a range begins or ends. On a
/// target without threads the calling thread runs them all.
class Workers {
 public:
  /// @pre 1 <= count <= 64; the calling thread is one of them.
  explicit Workers(int count);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Threads that take part, the calling one included.
  int count() const { return rests_ ? 1 : count_; }
  /// Lets all but the calling thread rest, or take part again; none is ended. @pre no job runs.
  void rest(bool rests) { rests_ = rests; }

  /// Calls run(Range) for consecutive ranges that cover [0, size); returns when all are done.
  template <class Run>
  void parallel_for(int size, int grain, Run&& run) {
    if (size <= grain || count() == 1) {
      for (int begin = 0; begin < size; begin += grain)
        run(Range{begin, begin + grain < size ? begin + grain : size});
      return;
    }
    dispatch(size, grain, &run,
             [](void* context, Range range) { (*static_cast<Run*>(context))(range); });
  }

  /// Calls run(Member&) on every thread at the same time; returns when all are done. For work in
  /// many short parts, each of which needs what all have done in the one before: to meet takes less
  /// time than to come for a job, and a part is always the same thread's.
  template <class Run>
  void together(Run&& run) {
    if (threads_ == nullptr || rests_) {
      Member alone;
      return run(alone);
    }
    using Job = std::remove_reference_t<Run>;
    dispatch_to_all(&run,
                    [](void* context, Member member) { (*static_cast<Job*>(context))(member); });
  }

 private:
  using Call = void (*)(void*, Range);
  using MemberCall = void (*)(void*, Member);
  void dispatch(int size, int grain, void* context, Call call);
  void dispatch_to_all(void* context, MemberCall call);

  struct Threads;
  int count_;
  bool rests_ = false;
  std::unique_ptr<Threads> threads_;
};

}  // namespace cycloid::solver
