#include "tests/hostile/allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace cycloid::hostile {
namespace {

// Workers of a world allocate at the same time.
std::atomic<std::size_t> total = 0;
std::atomic<std::size_t> largest = 0;
std::atomic<std::size_t> peak = 0;
std::atomic<std::size_t> live_now = 0;
std::atomic<std::size_t> live_at_reset = 0;

void raise(std::atomic<std::size_t>& most, std::size_t to) {
  for (std::size_t now = most; now < to && !most.compare_exchange_weak(now, to);) {
  }
}

std::size_t since_reset(std::size_t live) {
  return live > live_at_reset ? live - live_at_reset : 0;
}

/// In front of every block, as large as the strictest alignment of ordinary allocations.
constexpr std::size_t kHeadBytes = alignof(std::max_align_t);

void* allocate(std::size_t bytes) {
  void* block = std::malloc(bytes + kHeadBytes);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<std::size_t*>(block) = bytes;
  total += bytes;
  raise(largest, bytes);
  raise(peak, since_reset(live_now += bytes));
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
  total = largest = peak = 0;
  live_at_reset = live_now.load();
}

Allocations allocations() {
  Allocations counted;
  counted.total_bytes = total;
  counted.largest_bytes = largest;
  counted.peak_bytes = peak;
  counted.live_bytes = since_reset(live_now);
  return counted;
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
