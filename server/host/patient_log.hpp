#pragma once

#include <spdlog/logger.h>

#include <chrono>
#include <cstddef>
#include <memory>

namespace cycloid::server {

/// Lines that wait for their reader.
inline constexpr std::size_t kLogLinesWaitingMax = 4096;
/// How long the end of a log waits for its reader.
inline constexpr std::chrono::seconds kLogFarewell{1};

/// Writes lines to a descriptor from a thread of its own: nobody who logs waits for who reads, and
/// a reader that stops reading stops no match. Where too many lines wait the oldest are left out;
/// the next one that is read has the number of these before it. The end of the logger waits until
/// all has been written, `kLogFarewell` at most.
/// @param descriptor  Open as long as the logger is there; it is not closed.
std::shared_ptr<spdlog::logger> log_to(int descriptor);

}  // namespace cycloid::server
