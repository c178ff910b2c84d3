#pragma once

#include <bit>
#include <cstdint>

#include "protocol/state/range_coder.hpp"

namespace cycloid::protocol {

/// The two directions of one format behind one face: each call says a value and returns it, or
/// returns the one that was said. So a format is written down once, and cannot be read otherwise
/// than it was written.
class SayingCoder {
 public:
  static constexpr bool kReads = false;
  explicit SayingCoder(std::vector<std::byte>& into) : coder_(into) {}
  bool bit(AdaptiveBit& model, bool value) {
    coder_.bit(model, value);
    return value;
  }
  std::uint32_t raw(std::uint32_t value, unsigned count) {
    coder_.raw(value, count);
    return value;
  }
  template <unsigned kBits>
  std::uint32_t symbol(AdaptiveSymbol<kBits>& model, std::uint32_t value) {
    model.encode(coder_, value);
    return value;
  }
  void finish() { coder_.finish(); }

 private:
  RangeEncoder coder_;
};

/// The other direction; what it is given as a value is not looked at.
class HearingCoder {
 public:
  static constexpr bool kReads = true;
  explicit HearingCoder(std::span<const std::byte> bytes) : coder_(bytes) {}
  bool bit(AdaptiveBit& model, bool) { return coder_.bit(model); }
  std::uint32_t raw(std::uint32_t, unsigned count) { return coder_.raw(count); }
  template <unsigned kBits>
  std::uint32_t symbol(AdaptiveSymbol<kBits>& model, std::uint32_t) {
    return model.decode(coder_);
  }
  bool has_more() const { return coder_.has_more(); }

 private:
  RangeDecoder coder_;
};

/// What has been learned of a number's distance from its guess.
struct DistanceModel {
  AdaptiveSymbol<5> width;  ///< Of the magnitude, less 1.
  AdaptiveBit negative;
};

/// A distance that is not 0, modulo 2^32: its width in bits, its sign, then the bits behind the
/// highest, which are noise.
template <class Coder>
std::uint32_t code_distance(Coder& coder, DistanceModel& model, std::uint32_t distance) {
  const bool negative = coder.bit(model.negative, distance >> 31 != 0);
  const std::uint32_t said = negative ? 0u - distance : distance;
  const auto width = coder.symbol(model.width, static_cast<unsigned>(std::bit_width(said)) - 1u);
  const std::uint32_t top = 1u << width;
  const std::uint32_t magnitude = top | coder.raw(said & (top - 1u), width);
  return negative ? 0u - magnitude : magnitude;
}

/// The bits of a float as an integer that rises with it, and back.
constexpr std::uint32_t ordered_bits(std::uint32_t bits) {
  return bits >> 31 != 0 ? ~bits : bits | 0x80000000u;
}
constexpr std::uint32_t bits_of_ordered(std::uint32_t ordered) {
  return ordered >> 31 != 0 ? ordered & 0x7fffffffu : ~ordered;
}

}  // namespace cycloid::protocol
