#include "solver/collision/sort_pairs.hpp"

#include <algorithm>

namespace cycloid::solver {

/// Below so many comparing takes less time than counting.
static constexpr std::size_t kCountedMin = 256;
static constexpr int kDigitBits = 11;
static constexpr std::uint32_t kDigits = 1u << kDigitBits;

/// One pass of a radix sort: `to` has the pairs by one digit of a slot, those with the same digit
/// in their order before.
template <class SlotOf>
static void sort_by_digit(int shift, SlotOf&& slot_of, const std::vector<ShapePair>& from,
                          std::vector<ShapePair>& to) {
  std::uint32_t next[kDigits] = {};
  const auto digit_of = [&](const ShapePair& pair) {
    return (slot_of(pair) >> shift) & (kDigits - 1);
  };
  for (const ShapePair& pair : from) ++next[digit_of(pair)];
  std::uint32_t begin = 0;
  for (std::uint32_t& count : next) {
    const std::uint32_t end = begin + count;
    count = begin;
    begin = end;
  }
  for (const ShapePair& pair : from) to[next[digit_of(pair)]++] = pair;
}

void sort_pairs(std::uint32_t shapes, std::vector<ShapePair>& room, std::vector<ShapePair>& pairs) {
  if (pairs.size() < kCountedMin) {
    // Total order: the key is the whole pair.
    std::sort(pairs.begin(), pairs.end(),
              [](const ShapePair& a, const ShapePair& b) { return a.key() < b.key(); });
    return;
  }
  room.resize(pairs.size());
  const auto sort_by = [&](auto&& slot_of) {
    for (int shift = 0; shift < 32 && (shapes - 1) >> shift != 0; shift += kDigitBits) {
      sort_by_digit(shift, slot_of, pairs, room);
      pairs.swap(room);
    }
  };
  sort_by([](const ShapePair& pair) { return pair.shape_b; });
  sort_by([](const ShapePair& pair) { return pair.shape_a; });
}

}  // namespace cycloid::solver
