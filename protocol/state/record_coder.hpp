#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/state/layout.hpp"
#include "protocol/state/word_coder.hpp"

namespace cycloid::protocol {

/// What has been learned of the records of one array while a delta is coded.
class RecordCoder {
 public:
  explicit RecordCoder(const ArrayLayout& layout);

  /// A record as it differs from `base`; words of the layout's count each. `elapsed_s` is the time
  /// from `base` to `current`, 0 where the two are not one body at two times.
  template <class Coder>
  void code(Coder& coder, std::span<const std::uint32_t> base, float elapsed_s,
            std::span<std::uint32_t> current);

  AdaptiveBit& changed() { return changed_[was_changed_ ? 1 : 0]; }
  void remember(bool changed) { was_changed_ = changed; }

 private:
  /// So many words share one decision whether any of them has changed.
  static constexpr std::size_t kBlockWords = 8;
  struct Word {
    std::uint32_t place = 0;
    WordKind kind = WordKind::kInteger;
    std::array<AdaptiveBit, 2> changed;
    DistanceModel distance;
  };
  struct Block {
    std::size_t first = 0;
    std::size_t end = 0;
    std::array<AdaptiveBit, 2> changed;
  };

  template <class Coder>
  void code_word(Coder& coder, Word& word, std::uint32_t guess, std::uint32_t& current);
  void add_block(std::size_t first, std::size_t end);

  ArrayLayout::Motion motion_;
  std::vector<Word> words_;    ///< In the order in which they are coded: velocities first.
  std::vector<Block> blocks_;  ///< The second one of a body that moves begins with its pose.
  std::array<AdaptiveBit, 2> changed_;
  bool was_changed_ = false;
};

}  // namespace cycloid::protocol
