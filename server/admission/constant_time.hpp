#pragma once

#include <cstddef>
#include <span>

namespace cycloid::server {

/// Whether two secrets are the same, in a time that tells their lengths and nothing else of them.
bool equal_in_constant_time(std::span<const std::byte> a, std::span<const std::byte> b);

}  // namespace cycloid::server
