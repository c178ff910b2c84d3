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

}  // namespace cycloid::solver

#else

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace cycloid::solver {

/// How often a thread looks for what it waits for before it sleeps, some tens of microseconds in
/// all: to wake a sleeping thread takes longer than most of the hundred jobs of a step. It yields
/// between looks, so where there are more workers than processors the others go on meanwhile.
static constexpr int kLooks = 200;

/// Returns once `value` is not `old`, or sooner.
template <class T>
static void wait_while(const std::atomic<T>& value, T old) {
  for (int i = 0; i < kLooks; ++i) {
    if (value.load() != old) return;
    std::this_thread::yield();
  }
  value.wait(old);
}

/// The threads beside the calling one, and the job that all of them share.
struct Workers::Threads {
  explicit Threads(int count);
  ~Threads();
  void run_chunks();
  void thread_main();

  std::vector<std::thread> threads;
  std::atomic<std::uint32_t> generation{0};
  std::atomic<int> next{0};
  std::atomic<int> busy{0};
  std::atomic<bool> stop{false};
  int size = 0;
  int grain = 1;
  void* context = nullptr;
  Call call = nullptr;
};

Workers::Workers(int count) : count_(count) {
  if (count > 1) threads_ = std::make_unique<Threads>(count - 1);
}

Workers::~Workers() = default;

Workers::Threads::Threads(int count) {
  for (int i = 0; i < count; ++i) threads.emplace_back([this] { thread_main(); });
}

Workers::Threads::~Threads() {
  stop.store(true);
  generation.fetch_add(1);
  generation.notify_all();
  for (std::thread& thread : threads) thread.join();
}

void Workers::dispatch(int size, int grain, void* context, Call call) {
  Threads& pool = *threads_;
  pool.size = size;
  pool.grain = grain;
  pool.context = context;
  pool.call = call;
  pool.next.store(0);
  pool.busy.store(static_cast<int>(pool.threads.size()));
  pool.generation.fetch_add(1);
  pool.generation.notify_all();
  pool.run_chunks();
  // The job's fields may only be written again when every thread has left it.
  for (int busy = pool.busy.load(); busy != 0; busy = pool.busy.load()) wait_while(pool.busy, busy);
}

void Workers::Threads::run_chunks() {
  for (int begin = next.fetch_add(grain); begin < size; begin = next.fetch_add(grain))
    call(context, Range{begin, begin + grain < size ? begin + grain : size});
}

void Workers::Threads::thread_main() {
  // Generation 0 is the constructor's: a thread that starts late still sees the first job.
  for (std::uint32_t seen = 0;;) {
    wait_while(generation, seen);
    seen = generation.load();
    if (stop.load()) return;
    run_chunks();
    if (busy.fetch_sub(1) == 1) busy.notify_all();
  }
}

}  // namespace cycloid::solver

#endif
