#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "protocol/codec.hpp"
#include "protocol/log/values.hpp"

namespace cycloid::scenes {
struct Scene;
}

namespace cycloid::protocol {

/// A header with the scene, its digest and its name; who writes the log fills in the rest.
LogHeader log_header_of(const scenes::Scene& scene);

/// Whether the bytes begin as those of a log do, of whatever format.
bool looks_like_log(std::span<const std::byte> bytes);

/// Appends the header with its check, which is returned: the chain of checks begins with it.
std::uint32_t append_log_header(const LogHeader& header, Bytes& into);

/// A header that was read. `bytes` is 0 where it is not good, and `reason` says why not; kOpen
/// stands for a good one.
struct ReadHeader {
  LogState state = LogState::kCorrupt;
  std::string reason;
  LogHeader header;
  std::size_t bytes = 0;  ///< Of the header; the blocks begin behind it.
  std::uint32_t check = 0;
};

/// @param solver_versions  Whose logs verify here; see kBitCompatibleSolverVersions.
ReadHeader read_log_header(std::span<const std::byte> bytes,
                           std::span<const std::uint32_t> solver_versions);

}  // namespace cycloid::protocol
