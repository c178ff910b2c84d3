#include "solver/workers.hpp"

namespace cycloid::solver {

Workers::Workers(int count) {
  for (int i = 1; i < count; ++i) threads_.emplace_back([this] { thread_main(); });
}

Workers::~Workers() {
  stop_.store(true);
  generation_.fetch_add(1);
  generation_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Workers::dispatch(int size, int grain, void* context, Call call) {
  size_ = size;
  grain_ = grain;
  context_ = context;
  call_ = call;
  next_.store(0);
  busy_.store(static_cast<int>(threads_.size()));
  generation_.fetch_add(1);
  generation_.notify_all();
  run_chunks();
  // The job's fields may only be written again when every thread has left it.
  for (int busy = busy_.load(); busy != 0; busy = busy_.load()) busy_.wait(busy);
}

void Workers::run_chunks() {
  for (int begin = next_.fetch_add(grain_); begin < size_; begin = next_.fetch_add(grain_))
    call_(context_, Range{begin, begin + grain_ < size_ ? begin + grain_ : size_});
}

void Workers::thread_main() {
  // Generation 0 is the constructor's: a thread that starts late still sees the first job.
  for (std::uint32_t seen = 0;;) {
    generation_.wait(seen);
    seen = generation_.load();
    if (stop_.load()) return;
    run_chunks();
    if (busy_.fetch_sub(1) == 1) busy_.notify_all();
  }
}

}  // namespace cycloid::solver
