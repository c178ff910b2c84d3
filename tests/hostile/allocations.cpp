#include "tests/hostile/allocations.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace cycloid::hostile {
namespace {

// Plain numbers: the tests that count use one thread.
Allocations counted;
std::size_t live_at_reset = 0;
std::size_t live_now = 0;

/// In front of every block, as large as the strictest alignment of ordinary allocations.
constexpr std::size_t kHeadBytes = alignof(std::max_align_t);

void* allocate(std::size_t bytes) {
  void* block = std::malloc(bytes + kHeadBytes);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<std::size_t*>(block) = bytes;
  live_now += bytes;
  counted.total_bytes += bytes;
  counted.largest_bytes = std::max(counted.largest_bytes, bytes);
  if (live_now > live_at_reset)
    counted.peak_bytes = std::max(counted.peak_bytes, live_now - live_at_reset);
  return static_cast<std::byte*>(block) + kHeadBytes;
}

void release(void* pointer) {
  if (pointer == nullptr) return;
  void* block = static_cast<std::byte*>(pointer) - kHeadBytes;
  live_now -= *static_cast<std::size_t*>(block);
  std::free(block);
}

}  // namespace

void reset_allocations() {
  counted = {};
  live_at_reset = live_now;
}

Allocations allocations() {
  Allocations now = counted;
  now.live_bytes = live_now > live_at_reset ? live_now - live_at_reset : 0;
  return now;
}

}  // namespace cycloid::hostile

void* operator new(std::size_t bytes) {
  return cycloid::hostile::allocate(bytes);
}
void* operator new[](std::size_t bytes) {
  return cycloid::hostile::allocate(bytes);
}
void operator delete(void* pointer) noexcept {
  cycloid::hostile::release(pointer);
}
void operator delete[](void* pointer) noexcept {
  cycloid::hostile::release(pointer);
}
void operator delete(void* pointer, std::size_t) noexcept {
  cycloid::hostile::release(pointer);
}
void operator delete[](void* pointer, std::size_t) noexcept {
  cycloid::hostile::release(pointer);
}
