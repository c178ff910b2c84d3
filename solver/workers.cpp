#include "solver/workers.hpp"

#if defined(__wasm__) && !defined(_REENTRANT)

namespace cycloid::solver {

/// WebAssembly without threads: nothing to hold.
struct Workers::Threads {};

Workers::Workers(int count) : count_(count) {}
Workers::~Workers() = default;

void Workers::dispatch(int size, int grain, void* context, Call call) {
  for (int begin = 0; begin < size; begin += grain)
    call(context, Range{begin, begin + grain < size ? begin + grain : size});
}

void Workers::dispatch_to_all(void* context, MemberCall call) {
  call(context, Member());
}

/// Nobody else is there; only named so that the list of them counts as used.
void Member::wait_for_others() {
  static_cast<void>(meetings_);
}

}  // namespace cycloid::solver

#else

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "solver/processors.hpp"

namespace cycloid::solver {

/// How often a thread looks for what it waits for before it sleeps, a few hundred microseconds in
/// all: to wake a sleeping thread takes longer than most of the hundred jobs of a step, and what
/// one thread does alone between them takes up to that long. After the first looks, which take five
/// microseconds or so, it yields in between, so where there are more workers than processors the
/// others go on meanwhile.
static constexpr int kLooks = 5000;
static constexpr int kEagerLooks = 4000;

/// A number to wait for. Not std::atomic's own `wait`: where the system has no futex, such as on
/// Windows, GCC 12's library looks at the number before it takes the lock that it sleeps by, and a
/// change between the two wakes nobody.
template <class T>
struct Awaited {
  std::atomic<T> value{};

  /// Returns once the value is not `old`.
  void wait_while(T old) {
    for (int i = 0; i < kLooks; ++i) {
      if (value.load() != old) return;
      if (i >= kEagerLooks) std::this_thread::yield();
    }
    std::unique_lock lock(mutex);
    sleepers.fetch_add(1);
    changed.wait(lock, [&] { return value.load() != old; });
    sleepers.fetch_sub(1);
  }
  /// Behind a change of the value. Either it sees who is about to sleep, or who is about to sleep
  /// sees the change: both look at the one after they have written the other.
  void tell() {
    if (sleepers.load() == 0) return;
    { const std::lock_guard lock(mutex); }  // Whoever has looked already sleeps by now.
    changed.notify_all();
  }

 private:
  std::atomic<int> sleepers{0};
  std::mutex mutex;
  std::condition_variable changed;
};

/// The chunks of a job that one thread begins with, and others take from once their own are done.
/// In the next job of that size it begins with the same ones, which its cache still holds.
struct alignas(64) Share {
  std::atomic<int> next{0};
  int end = 0;

  /// Where the next chunk begins; from `end` on there is none. Looks before it takes, for most
  /// shares of others are empty, and to write to them would hold their owners up.
  int take(int grain) {
    const int begin = next.load(std::memory_order_relaxed);
    return begin < end ? next.fetch_add(grain, std::memory_order_relaxed) : begin;
  }
};

/// The threads beside the calling one, and the job that all of them share. A job comes in one line
/// of the cache with the number that tells of it, and its end is told in another.
struct Workers::Threads {
  explicit Threads(int count);
  ~Threads();
  void start();
  void wait_for_all();
  void share_out();
  void run_job(std::size_t own);
  void run_chunks(std::size_t own);
  void thread_main(std::size_t own);

  alignas(64) int size = 0;
  int grain = 1;
  void* context = nullptr;
  Call call = nullptr;
  MemberCall member_call = nullptr;  ///< Of a job that all do together; then there is no `call`.
  int caller_on = -1;                ///< Processor of the calling thread as the job began.
  Awaited<std::uint32_t> generation;
  alignas(64) Awaited<int> busy;
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  std::vector<Share> shares;       ///< By thread; the calling one's is the last.
  std::vector<Meetings> meetings;  ///< The same.
};

Workers::Workers(int count) : count_(count) {
  if (count > 1) threads_ = std::make_unique<Threads>(count - 1);
}

Workers::~Workers() = default;

Workers::Threads::Threads(int count)
    : shares(static_cast<std::size_t>(count) + 1), meetings(shares.size()) {
  for (std::size_t i = 0; i + 1 < shares.size(); ++i)
    threads.emplace_back([this, i] { thread_main(i); });
}

Workers::Threads::~Threads() {
  stop.store(true);
  generation.value.fetch_add(1);
  generation.tell();
  for (std::thread& thread : threads) thread.join();
}

void Workers::dispatch(int size, int grain, void* context, Call call) {
  Threads& pool = *threads_;
  pool.size = size;
  pool.grain = grain;
  pool.context = context;
  pool.call = call;
  pool.share_out();
  pool.start();
  pool.run_chunks(pool.threads.size());
  pool.wait_for_all();
}

void Workers::dispatch_to_all(void* context, MemberCall call) {
  Threads& pool = *threads_;
  pool.context = context;
  pool.call = nullptr;
  pool.member_call = call;
  pool.start();
  pool.run_job(pool.threads.size());
  pool.wait_for_all();
}

void Workers::Threads::start() {
  caller_on = processor_now();
  busy.value.store(static_cast<int>(threads.size()), std::memory_order_relaxed);
  generation.value.fetch_add(1);  // Whoever sees it sees all that was written before.
  generation.tell();
}

/// The job's fields may only be written again when every thread has left it.
void Workers::Threads::wait_for_all() {
  for (int left = busy.value.load(); left != 0; left = busy.value.load()) busy.wait_while(left);
}

void Workers::Threads::share_out() {
  const auto chunks = static_cast<std::size_t>((size + grain - 1) / grain);
  const auto begin_of = [&](std::size_t share) {
    return static_cast<int>(chunks * share / shares.size()) * grain;
  };
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i].next.store(begin_of(i), std::memory_order_relaxed);
    shares[i].end = begin_of(i + 1);
  }
}

void Workers::Threads::run_chunks(std::size_t own) {
  for (std::size_t i = 0; i < shares.size(); ++i) {
    Share& share = shares[(own + i) % shares.size()];
    for (int begin = share.take(grain); begin < share.end; begin = share.take(grain))
      call(context, Range{begin, begin + grain < size ? begin + grain : size});
  }
}

void Workers::Threads::run_job(std::size_t own) {
  if (call != nullptr) return run_chunks(own);
  const auto count = static_cast<int>(meetings.size());
  member_call(context, Member(static_cast<int>(own), count, meetings.data()));
}

/// A thread that has slept is woken on the processor of the one that calls, where the system knows
/// of no cache that processors share, as in most virtual machines; there it waits until that one
/// has done all by itself. Of 120 ticks, one in 16 ms, two threads shared one processor in 119. So
/// whoever finds itself there goes elsewhere, and stays away; but for where there are fewer
/// processors than threads.
void Workers::Threads::thread_main(std::size_t own) {
  const Processors processors;
  const bool may_leave = processors.count() >= static_cast<int>(shares.size());
  // Generation 0 is the constructor's: a thread that starts late still sees the first job.
  for (std::uint32_t seen = 0;;) {
    generation.wait_while(seen);
    seen = generation.value.load();
    if (stop.load()) return;
    if (may_leave && processor_now() == caller_on) processors.leave(caller_on);
    run_job(own);
    if (busy.value.fetch_sub(1) == 1) busy.tell();
  }
}

/// All have come equally often when a job begins, so nobody has to set a number back.
void Member::wait_for_others() {
  std::atomic<std::uint32_t>& own = meetings_[number_].count;
  const std::uint32_t now = own.load(std::memory_order_relaxed) + 1;
  own.store(now, std::memory_order_release);
  for (int i = 0; i < count_; ++i) {
    const std::atomic<std::uint32_t>& other = meetings_[i].count;
    // Who is ahead has come once more, at most: it waits there for this one.
    for (int look = 0; other.load(std::memory_order_acquire) == now - 1; ++look)
      if (look >= kEagerLooks) std::this_thread::yield();
  }
}

}  // namespace cycloid::solver

#endif
