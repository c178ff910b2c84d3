#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace cycloid::server {

/// Fills the bytes with chance. A value, so that a simulation can seed it.
using RandomSource = std::function<void(std::span<std::byte>)>;

/// The operating system's, fit for keys.
RandomSource system_random();

/// Readies libsodium; every function of this folder that needs it calls this first. Ends the
/// process where the machine has no source of chance at all.
void ready_sodium();

}  // namespace cycloid::server
