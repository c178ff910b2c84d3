#include "protocol/log/chunks.hpp"

#include <algorithm>
#include <array>

#include "protocol/crc32c.hpp"
#include "protocol/little_endian.hpp"

namespace cycloid::protocol {
namespace {

constexpr std::size_t kChunkBytesMin = kChunkHeadBytes + 1 + kCheckBytes;
constexpr std::size_t kBlockFieldBytes = kBlockHeadBytes - kCheckBytes;
constexpr std::uint16_t kMoreBit = 1u << 13;
constexpr int kKindShift = 14;

std::uint32_t check_at(std::span<const std::byte> log, std::size_t at) {
  return solver::load_little<std::uint32_t>(log.data() + at);
}

}  // namespace

std::uint32_t salted(std::uint64_t salt) {
  std::array<std::byte, 8> bytes{};
  solver::store_little(salt, bytes.data());
  return crc32c(bytes);
}

std::uint32_t chunk_check(std::uint32_t salted, std::uint32_t before,
                          std::span<const std::byte> bytes) {
  std::array<std::byte, 4> chain{};
  solver::store_little(before, chain.data());
  return crc32c(bytes, crc32c(chain, salted));
}

std::uint32_t block_check(std::uint32_t salted, std::span<const std::byte> fields) {
  return crc32c(fields, salted);
}

void ChunkWriter::begin_block_if_due(std::uint64_t next_tick, Bytes& into) {
  const bool inside = body_bytes_ % kLogBlockBytes != 0;
  if (inside && room() >= kChunkBytesMin) return;
  if (inside) {
    const std::size_t rest = room();
    into.insert(into.end(), rest, std::byte{0});
    body_bytes_ += rest;
  }
  const std::size_t begin = into.size();
  append_little(static_cast<std::uint32_t>(body_bytes_ / kLogBlockBytes), into);
  append_little(next_tick, into);
  append_little(check_, into);
  check_ = block_check(salted_, std::span<const std::byte>(into).subspan(begin));
  append_little(check_, into);
  body_bytes_ += kBlockHeadBytes;
}

ChunkWriter::Place ChunkWriter::next_place(std::uint64_t next_tick, Bytes& into) {
  begin_block_if_due(next_tick, into);
  return {header_bytes_ + body_bytes_, check_};
}

void ChunkWriter::chunk(RecordKind kind, bool more, std::span<const std::byte> payload,
                        Bytes& into) {
  const std::size_t begin = into.size();
  const auto head = static_cast<std::uint16_t>(payload.size() | (more ? kMoreBit : 0u) |
                                               static_cast<unsigned>(kind) << kKindShift);
  append_little(head, into);
  into.insert(into.end(), payload.begin(), payload.end());
  check_ = chunk_check(salted_, check_, std::span<const std::byte>(into).subspan(begin));
  append_little(check_, into);
  body_bytes_ += into.size() - begin;
}

void ChunkWriter::record(RecordKind kind, std::span<const std::byte> payload,
                         std::uint64_t next_tick, Bytes& into) {
  do {
    begin_block_if_due(next_tick, into);
    const std::size_t most = std::min(kChunkPayloadMax, room() - kChunkHeadBytes - kCheckBytes);
    const std::size_t count = std::min(most, payload.size());
    chunk(kind, count < payload.size(), payload.first(count), into);
    payload = payload.subspan(count);
  } while (!payload.empty());
}

ChunkReader::Found ChunkReader::enter_block() {
  if (log_.size() - at_ < kBlockHeadBytes) return Found::kDamage;
  const auto fields = log_.subspan(at_, kBlockFieldBytes);
  const std::uint32_t check = check_at(log_, at_ + kBlockFieldBytes);
  if (block_check(salted_, fields) != check) return Found::kDamage;
  LittleReader reader{fields};
  const bool is_next = reader.take<std::uint32_t>() == (at_ - header_bytes_) / kLogBlockBytes;
  const auto tick = reader.take<std::uint64_t>();
  if (!is_next || reader.take<std::uint32_t>() != check_) return Found::kOutOfOrder;
  block_tick_ = tick;
  check_ = check;
  at_ += kBlockHeadBytes;
  good_ = at_;
  return Found::kChunk;
}

bool ChunkReader::skip_rest() {
  const std::size_t rest = block_left(at_);
  if (log_.size() - at_ < rest) return false;
  const auto zeros = log_.subspan(at_, rest);
  if (std::any_of(zeros.begin(), zeros.end(), [](std::byte b) { return b != std::byte{0}; }))
    return false;
  at_ += rest;
  return true;
}

/// How long the chunk at `at` says it is, check included; 0 if none is that long within `left`.
static std::size_t chunk_bytes(std::span<const std::byte> log, std::size_t at, std::size_t left) {
  left = std::min(left, log.size() - at);
  if (left < kChunkBytesMin) return 0;
  const auto head = solver::load_little<std::uint16_t>(log.data() + at);
  const std::size_t payload_bytes = head & kChunkPayloadMax;
  if (head >> kKindShift == 0 || payload_bytes == 0) return 0;
  const std::size_t bytes = kChunkHeadBytes + payload_bytes + kCheckBytes;
  return bytes <= left ? bytes : 0;
}

ChunkReader::Found ChunkReader::next(LogChunk& chunk) {
  if (at_ == log_.size()) return Found::kEnd;
  if (block_left(at_) < kChunkBytesMin && !skip_rest()) return Found::kDamage;
  if ((at_ - header_bytes_) % kLogBlockBytes == 0) {
    const Found found = enter_block();
    if (found != Found::kChunk) return found;
    if (at_ == log_.size()) return Found::kEnd;
  }
  const std::size_t bytes = chunk_bytes(log_, at_, block_left(at_));
  if (bytes == 0) return Found::kDamage;
  const std::uint32_t check = check_at(log_, at_ + bytes - kCheckBytes);
  if (chunk_check(salted_, check_, log_.subspan(at_, bytes - kCheckBytes)) != check)
    return Found::kDamage;
  const auto head = solver::load_little<std::uint16_t>(log_.data() + at_);
  chunk.kind = static_cast<RecordKind>(head >> kKindShift);
  chunk.more = (head & kMoreBit) != 0;
  chunk.payload = log_.subspan(at_ + kChunkHeadBytes, bytes - kChunkHeadBytes - kCheckBytes);
  chunk.at = at_;
  chunk.before = check_;
  at_ += bytes;
  good_ = at_;
  check_ = check;
  return Found::kChunk;
}

namespace {

/// The checks of all pieces of a range, each in constant time: a CRC is linear, so that of a piece
/// follows from those of the two beginnings of the range that it lies between.
class PieceChecks {
 public:
  explicit PieceChecks(std::span<const std::byte> range) : prefix_(range.size() + 1) {
    for (std::size_t i = 0; i < range.size(); ++i) prefix_[i + 1] = step(prefix_[i], range[i]);
    powers_.resize(std::min(range.size(), kChunkHeadBytes + kChunkPayloadMax) + 1);
    powers_[0] = 1u << 31;
    for (std::size_t i = 1; i < powers_.size(); ++i) powers_[i] = step(powers_[i - 1], {});
  }

  /// crc32c(bytes from `begin` to `end` of the range, crc).
  std::uint32_t of(std::size_t begin, std::size_t end, std::uint32_t crc) const {
    return ~(times(~crc ^ prefix_[begin], powers_[end - begin]) ^ prefix_[end]);
  }

 private:
  static std::uint32_t step(std::uint32_t value, std::byte byte) {
    return (value >> 8) ^ detail::kCrc32cTable[(value ^ static_cast<std::uint32_t>(byte)) & 0xffu];
  }
  /// The product of two polynomials over GF(2) modulo that of the CRC, highest power lowest.
  static std::uint32_t times(std::uint32_t a, std::uint32_t b) {
    std::uint32_t product = 0;
    for (std::uint32_t bit = 1u << 31; bit != 0; bit >>= 1) {
      if ((a & bit) != 0) product ^= b;
      b = (b >> 1) ^ ((b & 1) != 0 ? 0x82f63b78u : 0u);
    }
    return product;
  }

  std::vector<std::uint32_t> prefix_;  ///< Register after so many bytes, from 0.
  std::vector<std::uint32_t> powers_;  ///< x^(8 i).
};

/// Whether a good chunk begins anywhere in [begin, end), a part of one block.
bool any_chunk(std::span<const std::byte> log, std::uint32_t salted, std::size_t begin,
               std::size_t end) {
  if (end <= begin) return false;
  const PieceChecks checks(log.subspan(begin, end - begin));
  for (std::size_t at = begin; at < end; ++at) {
    const std::size_t bytes = chunk_bytes(log, at, end - at);
    if (bytes == 0) continue;
    const std::uint32_t chain = crc32c(log.subspan(at - kCheckBytes, kCheckBytes), salted);
    const std::size_t check_place = at + bytes - kCheckBytes;
    if (checks.of(at - begin, check_place - begin, chain) == check_at(log, check_place))
      return true;
  }
  return false;
}

}  // namespace

ChunkReader::Behind ChunkReader::behind() const {
  Behind behind;
  // Only the check itself may be damaged: then what follows goes on from the right one.
  const bool at_head = (at_ - header_bytes_) % kLogBlockBytes == 0;
  const std::size_t bytes = at_head ? std::min(kBlockHeadBytes, log_.size() - at_)
                                    : chunk_bytes(log_, at_, block_left(at_));
  if (bytes > kCheckBytes) {
    const auto body = log_.subspan(at_, bytes - kCheckBytes);
    ChunkReader after = *this;
    after.check_ = at_head ? block_check(salted_, body) : chunk_check(salted_, check_, body);
    after.at_ = at_ + bytes;
    LogChunk chunk;
    behind.any = after.next(chunk) == Found::kChunk;
  }
  const std::size_t block_end = at_ + block_left(at_);
  for (std::size_t head = block_end; head + kBlockHeadBytes <= log_.size();
       head += kLogBlockBytes) {
    const auto fields = log_.subspan(head, kBlockFieldBytes);
    if (block_check(salted_, fields) != check_at(log_, head + kBlockFieldBytes)) continue;
    const auto tick = solver::load_little<std::uint64_t>(fields.data() + 4);
    behind.any = true;
    behind.tick = std::max(behind.tick.value_or(0), tick);
  }
  for (std::size_t begin = at_ + 1, end = block_end; !behind.any && begin < log_.size();
       begin = end, end += kLogBlockBytes)
    behind.any = any_chunk(log_, salted_, begin, std::min(end, log_.size()));
  return behind;
}

}  // namespace cycloid::protocol
