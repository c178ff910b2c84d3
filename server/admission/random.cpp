#include "server/admission/random.hpp"

#include <sodium.h>

#include <cstdlib>

namespace cycloid::server {

void ready_sodium() {
  static const bool kReady = sodium_init() >= 0;
  if (!kReady) std::abort();
}

RandomSource system_random() {
  return [](std::span<std::byte> bytes) {
    ready_sodium();
    randombytes_buf(bytes.data(), bytes.size());
  };
}

}  // namespace cycloid::server
