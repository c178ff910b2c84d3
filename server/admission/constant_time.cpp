#include "server/admission/constant_time.hpp"

#include <sodium.h>

namespace cycloid::server {

bool equal_in_constant_time(std::span<const std::byte> a, std::span<const std::byte> b) {
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace cycloid::server
