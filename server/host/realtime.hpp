#pragma once

#include <string>

namespace cycloid::server {

/// The calling thread before all that are not of real time (SCHED_FIFO).
/// @returns "", or why it stays as it is.
std::string make_thread_realtime();

/// Keeps the memory of the process from being paged out, where that cannot make a later allocation
/// fail.
/// @returns "", or why it stays as it is.
std::string lock_memory();

}  // namespace cycloid::server
