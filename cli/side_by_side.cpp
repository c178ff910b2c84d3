#include "cli/side_by_side.hpp"

// WebAssembly without -pthread has a <thread> without std::thread in it.
#if defined(__wasm__) && !defined(_REENTRANT)

namespace cycloid::cli {

void side_by_side(std::size_t count, int, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace cycloid::cli

#else

#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace cycloid::cli {

void side_by_side(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
  std::vector<std::exception_ptr> thrown(count);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stopped{false};
  const auto take_turns = [&] {
    for (std::size_t i = next++; i < count && !stopped; i = next++) {
      try {
        work(i);
      } catch (...) {
        thrown[i] = std::current_exception();
        stopped = true;
      }
    }
  };
  std::vector<std::thread> helpers;
  const std::size_t threads = std::min(count, static_cast<std::size_t>(std::max(jobs, 1)));
  helpers.reserve(threads);
  for (std::size_t i = 1; i < threads; ++i) {
    try {
      helpers.emplace_back(take_turns);
    } catch (const std::system_error&) {  // The system gives no more: those that there are do it.
      break;
    }
  }
  take_turns();
  for (std::thread& helper : helpers) helper.join();
  for (const std::exception_ptr& exception : thrown)
    if (exception) std::rethrow_exception(exception);
}

}  // namespace cycloid::cli

#endif
