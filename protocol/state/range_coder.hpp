#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cycloid::protocol {

/// What a coder has learned of one binary decision: how likely a 0 is, in 65536ths. The first
/// decisions count for more, so that a short message learns too.
struct AdaptiveBit {
  std::uint16_t zero = 1u << 15;
  std::uint16_t seen = 0;

  /// Rises to 1/32: slower would follow a scene's change of mood late, faster would learn noise.
  void learn(bool bit) {
    constexpr std::array<std::uint8_t, 8> kShift = {1, 2, 2, 3, 3, 4, 4, 5};
    const unsigned shift = kShift[seen];
    if (seen + 1u < kShift.size()) ++seen;
    // Stays within [32, 65536 - 32]: neither answer is ever impossible.
    if (bit)
      zero = static_cast<std::uint16_t>(zero - ((zero - 32u) >> shift));
    else
      zero = static_cast<std::uint16_t>(zero + ((65504u - zero) >> shift));
  }
};

/// Writes binary decisions at close to what they are worth in bits. Integers alone, so equal
/// decisions are equal bytes everywhere. Source: the carry-propagating byte-wise range coder of
/// LZMA; ours has finer probabilities and ends on as few bytes as tell its value from others.
class RangeEncoder {
 public:
  /// Appends to `into`, which must outlive the encoder.
  explicit RangeEncoder(std::vector<std::byte>& into) : into_(into), begin_(into.size()) {}

  void bit(AdaptiveBit& model, bool value) {
    const std::uint32_t bound = (range_ >> 16) * model.zero;
    if (value) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    model.learn(value);
    normalise();
  }

  /// The low `count` bits of a value, none likelier than another. @pre count <= 32.
  void raw(std::uint32_t value, unsigned count) {
    for (; count > 16; count -= 16) raw_part(value >> (count - 16) & 0xffffu, 16);
    raw_part(value & ((1u << count) - 1u), count);
  }

  /// Call once, last.
  void finish();

 private:
  void raw_part(std::uint32_t value, unsigned count) {
    range_ >>= count;
    low_ += std::uint64_t{range_} * value;
    normalise();
  }
  void normalise() {
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      shift_low();
    }
  }
  void shift_low() {
    if (low_ < 0xff000000u || low_ > 0xffffffffu) {
      const auto carry = static_cast<std::uint32_t>(low_ >> 32);
      if (begun_) into_.push_back(static_cast<std::byte>(held_ + carry));
      for (; pending_ > 0; --pending_) into_.push_back(static_cast<std::byte>(0xffu + carry));
      held_ = static_cast<std::uint32_t>(low_ >> 24) & 0xffu;
      begun_ = true;
    } else {
      ++pending_;
    }
    low_ = (low_ & 0x00ffffffu) << 8;
  }

  std::vector<std::byte>& into_;
  std::size_t begin_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  std::uint32_t held_ = 0;   ///< The last byte out of `low_`, to which a carry may still come.
  std::size_t pending_ = 0;  ///< Bytes 0xff behind it, which a carry would run through.
  bool begun_ = false;
};

/// Reads what RangeEncoder wrote, with models in the same states. Whatever the bytes, it answers
/// and reads nothing outside of them: behind their end it reads zeros.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next();
  }

  bool bit(AdaptiveBit& model) {
    const std::uint32_t bound = (range_ >> 16) * model.zero;
    const bool value = value_ >= bound;
    if (value) {
      value_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    model.learn(value);
    normalise();
    return value;
  }

  std::uint32_t raw(unsigned count) {
    std::uint32_t value = 0;
    for (; count > 16; count -= 16) value = value << 16 | raw_part(16);
    return value << count | raw_part(count);
  }

  /// Whether bytes are left that no decision came from: they are no part of the message.
  bool has_more() const { return at_ < bytes_.size(); }

 private:
  std::uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at]) : 0u;
  }
  std::uint32_t raw_part(unsigned count) {
    range_ >>= count;
    const std::uint32_t most = (1u << count) - 1u;
    std::uint32_t value = value_ / range_;
    // Only bytes that no encoder wrote come here with more.
    if (value > most) value = most;
    value_ -= value * range_;
    normalise();
    return value;
  }
  void normalise() {
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      value_ = value_ << 8 | next();
    }
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t range_ = 0xffffffffu;
  std::uint32_t value_ = 0;
};

/// One of 2^kBits symbols, decided bit by bit from the highest, each with what it has learned
/// behind the bits before it.
template <unsigned kBits>
struct AdaptiveSymbol {
  std::array<AdaptiveBit, 1u << kBits> nodes;

  void encode(RangeEncoder& coder, std::uint32_t symbol) {
    std::uint32_t node = 1;
    for (unsigned i = kBits; i-- > 0;) {
      const bool bit = (symbol >> i & 1u) != 0;
      coder.bit(nodes[node], bit);
      node = node << 1 | static_cast<std::uint32_t>(bit);
    }
  }
  std::uint32_t decode(RangeDecoder& coder) {
    std::uint32_t node = 1;
    for (unsigned i = 0; i < kBits; ++i)
      node = node << 1 | static_cast<std::uint32_t>(coder.bit(nodes[node]));
    return node - (1u << kBits);
  }
};

}  // namespace cycloid::protocol
