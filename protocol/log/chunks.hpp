#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "protocol/codec.hpp"

namespace cycloid::protocol {

/// The middle layer of a log: after the header come blocks of 32 KiB, so that a reader who has lost
/// the thread finds it again at a place that it can compute. A block begins with a head, then come
/// chunks, none of which crosses its end; a record that is longer goes on in the next chunk. What
/// is left of a block that can hold no chunk is zero.
///
/// Each chunk ends with a CRC-32C over the salt, the check before and its own bytes, so that none
/// can be changed, moved, lost or borrowed from another log unnoticed.
inline constexpr std::size_t kLogBlockBytes = 32768;
/// Number of the block (4), next tick (8), check before (4), check of these and the salt (4).
inline constexpr std::size_t kBlockHeadBytes = 20;
inline constexpr std::size_t kChunkHeadBytes = 2;
inline constexpr std::size_t kCheckBytes = 4;
inline constexpr std::size_t kChunkPayloadMax = 8191;  ///< 13 bits.

enum class RecordKind : std::uint8_t { kTick = 1, kKeyframe = 2, kFooter = 3 };

/// Register of a CRC-32C that has taken the salt, from which every check of a file goes on.
std::uint32_t salted(std::uint64_t salt);
/// Over the salt, the check before and the bytes.
std::uint32_t chunk_check(std::uint32_t salted, std::uint32_t before,
                          std::span<const std::byte> bytes);
/// Over the salt and the fields of a block's head.
std::uint32_t block_check(std::uint32_t salted, std::span<const std::byte> fields);

/// Cuts records into chunks and blocks.
class ChunkWriter {
 public:
  /// @param check  Of the header, from which the chain goes on.
  ChunkWriter(std::uint64_t salt, std::uint32_t check, std::size_t header_bytes)
      : salted_(salted(salt)), check_(check), header_bytes_(header_bytes) {}

  /// @param next_tick  The tick that the next tick record is of, for the head of a block.
  void record(RecordKind kind, std::span<const std::byte> payload, std::uint64_t next_tick,
              Bytes& into);

  /// Where the next record's first chunk would begin, and the check before it. Begins a block where
  /// the last one is full.
  struct Place {
    std::uint64_t at = 0;
    std::uint32_t before = 0;
  };
  Place next_place(std::uint64_t next_tick, Bytes& into);

 private:
  std::size_t room() const { return kLogBlockBytes - body_bytes_ % kLogBlockBytes; }
  void begin_block_if_due(std::uint64_t next_tick, Bytes& into);
  void chunk(RecordKind kind, bool more, std::span<const std::byte> payload, Bytes& into);

  std::uint32_t salted_;
  std::uint32_t check_;
  std::size_t header_bytes_;
  std::uint64_t body_bytes_ = 0;
};

/// One chunk where it stands.
struct LogChunk {
  RecordKind kind = RecordKind::kTick;
  bool more = false;  ///< The record goes on in the next chunk.
  std::span<const std::byte> payload;
  std::size_t at = 0;        ///< Its first byte.
  std::uint32_t before = 0;  ///< The check before it.
};

/// Goes from chunk to chunk. Holds nothing of the bytes.
class ChunkReader {
 public:
  ChunkReader() = default;
  /// @param at  Byte of a chunk or of a block's head; `before` is the check before it.
  ChunkReader(std::span<const std::byte> log, std::uint64_t salt, std::size_t header_bytes,
              std::size_t at, std::uint32_t before)
      : log_(log),
        salted_(salted(salt)),
        header_bytes_(header_bytes),
        at_(at),
        good_(at),
        check_(before) {}

  enum class Found : std::uint8_t { kChunk, kEnd, kDamage, kOutOfOrder };

  /// The next chunk; kEnd where the bytes end behind a whole one, kDamage where something else
  /// stands, kOutOfOrder where the head of a block is good and not that of the next block.
  Found next(LogChunk& chunk);

  std::size_t at() const { return at_; }      ///< Where the next chunk begins, or the damage.
  std::size_t good() const { return good_; }  ///< End of the last good chunk or head.
  /// What the head said of a block that was entered since the last call.
  std::optional<std::uint64_t> take_block_tick() { return std::exchange(block_tick_, {}); }

  /// What still lies behind damage at `at()`.
  struct Behind {
    bool any = false;                   ///< A good chunk or head: no interrupted write.
    std::optional<std::uint64_t> tick;  ///< The highest that a good head of a block names.
  };
  /// O(bytes left). @pre next() has returned kDamage
  Behind behind() const;

 private:
  std::size_t block_left(std::size_t at) const {
    return kLogBlockBytes - (at - header_bytes_) % kLogBlockBytes;
  }
  Found enter_block();
  bool skip_rest();

  std::span<const std::byte> log_;
  std::uint32_t salted_ = 0;
  std::size_t header_bytes_ = 0;
  std::size_t at_ = 0;
  std::size_t good_ = 0;
  std::uint32_t check_ = 0;
  std::optional<std::uint64_t> block_tick_;
};

}  // namespace cycloid::protocol
