#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cycloid::protocol {

/// Most words of a record, so that coders need no memory for one; checked when this is compiled.
inline constexpr std::size_t kRecordWordsMax = 128;

/// How a word of a record is guessed and what is left of it coded.
enum class WordKind : std::uint8_t { kInteger, kFloat };

/// One array of World::encode: records of so many words of 4 bytes.
struct ArrayLayout {
  std::string name;
  std::vector<WordKind> words;
  bool by_key = false;  ///< Sorted by the first two words, which name the record; else by place.
  /// Where a body's motion lies in its record; 0 words where the record has none.
  struct Motion {
    std::uint32_t position = 0;
    std::uint32_t velocity = 0;
    std::uint32_t rotation = 0;
    std::uint32_t spin = 0;
    std::uint32_t axes = 0;  ///< Words of `position` and `velocity`; 0: nothing moves.
    std::uint32_t rotation_words = 0;
    std::uint32_t spin_words = 0;
  } motion;
};

/// The canonical encoding of a world of one dimension, as solver/visit.hpp lists it.
struct StateLayout {
  static constexpr std::size_t kArrays = 19;
  std::uint32_t dimension = 0;
  std::vector<WordKind> header;  ///< With the magic number and the dimension in front.
  std::uint32_t tick = 0;        ///< Word of the header, the lower half.
  std::uint32_t tick_s = 0;
  std::array<ArrayLayout, kArrays> arrays;
};

/// @pre dimension is 2 or 3.
const StateLayout& state_layout(std::uint32_t dimension);

/// A canonical encoding cut into its arrays. Views of the bytes that it was cut from.
struct CutState {
  const StateLayout* layout = nullptr;
  std::span<const std::byte> header;
  std::array<std::span<const std::byte>, StateLayout::kArrays> arrays;  ///< Without the counts.

  std::uint32_t count(std::size_t array) const;  ///< Records.
};

/// Nothing where the bytes are not what World::encode writes, by their sizes; what the words say is
/// not looked at.
std::optional<CutState> cut_state(std::span<const std::byte> encoding);

}  // namespace cycloid::protocol
