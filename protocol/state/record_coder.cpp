#include "protocol/state/record_coder.hpp"

#include <algorithm>

#include "solver/motion.hpp"

namespace cycloid::protocol {

RecordCoder::RecordCoder(const ArrayLayout& layout) : motion_(layout.motion) {
  std::vector<std::uint32_t> order;
  auto add = [&](std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) order.push_back(first + i);
  };
  add(motion_.velocity, motion_.axes);
  add(motion_.spin, motion_.spin_words);
  const std::size_t velocities = order.size();
  add(motion_.position, motion_.axes);
  add(motion_.rotation, motion_.rotation_words);
  const std::size_t moving = order.size();
  for (std::uint32_t i = 0; i < layout.words.size(); ++i)
    if (std::find(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(moving), i) ==
        order.begin() + static_cast<std::ptrdiff_t>(moving))
      order.push_back(i);
  for (const std::uint32_t place : order) words_.push_back({place, layout.words[place], {}, {}});
  if (moving > 0) {
    add_block(0, velocities);
    add_block(velocities, moving);
  }
  for (std::size_t at = moving; at < order.size(); at += kBlockWords)
    add_block(at, std::min(at + kBlockWords, order.size()));
}

void RecordCoder::add_block(std::size_t first, std::size_t end) {
  blocks_.push_back({first, end, {}});
}

static float float_at(std::span<const std::uint32_t> words, std::size_t place) {
  return std::bit_cast<float>(words[place]);
}

/// Replaces a guess, but never by what is not finite: its bits differ between targets.
static void put_finite(float value, std::uint32_t& guess) {
  if (value - value == 0.0f) guess = std::bit_cast<std::uint32_t>(value);
}

/// The rotation after a turn at a constant spin, not made of length 1 again.
template <int D>
static void guess_rotation(const ArrayLayout::Motion& motion, float elapsed_s,
                           std::span<const std::uint32_t> current, std::span<std::uint32_t> guess) {
  solver::Spin<D> turn;
  solver::Rotation<D> before;
  for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
    turn[i] = elapsed_s * float_at(current, motion.spin + static_cast<std::size_t>(i));
  // Also false for what is no number; within it, no bits leave the range of the sine.
  constexpr float kTurnMax = 100.0f;
  if (!(dot(turn, turn) < kTurnMax * kTurnMax)) return;
  for (int i = 0; i < solver::Dim<D>::kRotation; ++i)
    before[i] = float_at(guess, motion.rotation + static_cast<std::size_t>(i));
  const solver::Rotation<D> after = solver::compose(solver::rotation_by(turn), before);
  for (int i = 0; i < solver::Dim<D>::kRotation; ++i)
    put_finite(after[i], guess[motion.rotation + static_cast<std::size_t>(i)]);
}

/// Where the velocities that are known by now have taken the body.
static void guess_pose(const ArrayLayout::Motion& motion, float elapsed_s,
                       std::span<const std::uint32_t> current, std::span<std::uint32_t> guess) {
  for (std::size_t i = 0; i < motion.axes; ++i) {
    const float from = float_at(guess, motion.position + i);
    put_finite(from + elapsed_s * float_at(current, motion.velocity + i),
               guess[motion.position + i]);
  }
  if (motion.rotation_words == 2) guess_rotation<2>(motion, elapsed_s, current, guess);
  if (motion.rotation_words == 4) guess_rotation<3>(motion, elapsed_s, current, guess);
}

template <class Coder>
void RecordCoder::code_word(Coder& coder, Word& word, std::uint32_t guess, std::uint32_t& current) {
  if (word.kind == WordKind::kFloat) {
    const std::uint32_t from = ordered_bits(guess);
    const std::uint32_t distance =
        code_distance(coder, word.distance, ordered_bits(current) - from);
    if constexpr (Coder::kReads) current = bits_of_ordered(from + distance);
  } else {
    const std::uint32_t distance = code_distance(coder, word.distance, current - guess);
    if constexpr (Coder::kReads) current = guess + distance;
  }
}

template <class Coder>
void RecordCoder::code(Coder& coder, std::span<const std::uint32_t> base, float elapsed_s,
                       std::span<std::uint32_t> current) {
  std::array<std::uint32_t, kRecordWordsMax> guesses;
  const std::span<std::uint32_t> guess = std::span(guesses).first(base.size());
  std::copy(base.begin(), base.end(), guess.begin());
  bool block_before = false;
  for (Block& block : blocks_) {
    if (&block == &blocks_[0] + 1 && motion_.axes > 0 && elapsed_s != 0.0f)
      guess_pose(motion_, elapsed_s, current, guess);
    bool any = false;
    for (std::size_t i = block.first; i < block.end; ++i)
      any = any || current[words_[i].place] != guess[words_[i].place];
    block_before = coder.bit(block.changed[block_before ? 1 : 0], any);
    bool before = true;
    for (std::size_t i = block.first; i < block.end; ++i) {
      Word& word = words_[i];
      std::uint32_t& value = current[word.place];
      const std::uint32_t guessed = guess[word.place];
      if (block_before) before = coder.bit(word.changed[before ? 1 : 0], value != guessed);
      if (block_before && before)
        code_word(coder, word, guessed, value);
      else if constexpr (Coder::kReads)
        value = guessed;
    }
  }
}

template void RecordCoder::code(SayingCoder&, std::span<const std::uint32_t>, float,
                                std::span<std::uint32_t>);
template void RecordCoder::code(HearingCoder&, std::span<const std::uint32_t>, float,
                                std::span<std::uint32_t>);

}  // namespace cycloid::protocol
