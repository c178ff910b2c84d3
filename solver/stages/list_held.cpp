#include <cstring>
#include <type_traits>
#include <utility>

#include "solver/stages/island_rows.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// All that the pairs of a block of contacts say.
template <int D, int W>
struct HeldBlock {
  LaneIndices<W> body_a;
  LaneIndices<W> body_b;
  LaneBits moves_a;
  LaneBits moves_b;
  LaneBits has_point[Dim<D>::kManifoldPoints];
};

/// Takes a record down. @returns whether it is the one that stood there before.
template <class T>
static bool put(const T& record, std::uint32_t* at) {
  static_assert(std::has_unique_object_representations_v<T> && sizeof(T) % 4 == 0);
  if (std::memcmp(at, &record, sizeof record) == 0) return true;
  std::memcpy(at, &record, sizeof record);
  return false;
}

template <int D, int W>
static HeldBlock<D, W> held_by(const ContactBlock<D, W>& block) {
  HeldBlock<D, W> held;
  std::memcpy(held.body_a, block.body_a, sizeof held.body_a);
  std::memcpy(held.body_b, block.body_b, sizeof held.body_b);
  held.moves_a = block.moves_a;
  held.moves_b = block.moves_b;
  std::memcpy(held.has_point, block.has_point, sizeof held.has_point);
  return held;
}

template <int D>
static bool moves(const StepScratch<D>& scratch, std::uint32_t slot) {
  return scratch.masses[slot].inverse_mass > 0.0f;
}

/// Takes down all that pairs are made of: three numbers that say how, and what blocks hold; of the
/// joints `color` tells. @returns whether all is as it was.
template <int D, int W>
static bool is_held_as_before(Workers& workers, StepScratch<D>& scratch) {
  constexpr std::size_t kOfBlock = sizeof(HeldBlock<D, W>) / 4;
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  std::vector<std::uint32_t>& words = scratch.islands_solved.held_words;
  constexpr std::size_t kBlocksAt = 3;
  const std::size_t count = kBlocksAt + kOfBlock * blocks.size();
  Tally changes;
  if (words.size() != count) changes.add(1);
  words.resize(count);
  const std::uint32_t how[kBlocksAt] = {static_cast<std::uint32_t>(kLaneCount<W>),
                                        static_cast<std::uint32_t>(scratch.masses.size()),
                                        static_cast<std::uint32_t>(blocks.size())};
  if (!put(how, words.data())) changes.add(1);
  workers.parallel_for(static_cast<int>(blocks.size()), kBodyGrain, [&](Range range) {
    bool same = true;
    for (int i = range.begin; i < range.end; ++i) {
      const auto block = static_cast<std::size_t>(i);
      same = put(held_by(blocks[block]), words.data() + kBlocksAt + kOfBlock * block) && same;
    }
    if (!same) changes.add(1);
  });
  return std::exchange(scratch.islands_solved.joints_as_listed, true) && changes.sum() == 0;
}

template <int D, int W>
static void list_pairs_of(const ContactBlock<D, W>& block, int place, std::vector<HeldPair>& held) {
  for (int lane = 0; lane < kLaneCount<W>; ++lane) {
    const LaneBits bit = LaneBits{1} << lane;
    if ((block.has_point[0] & bit) == 0) continue;
    int points = 0;
    for (const LaneBits lanes : block.has_point) points += (lanes & bit) != 0 ? 1 : 0;
    held.push_back({block.body_a[lane], block.body_b[lane], place, lane, points,
                    (block.moves_a & bit) != 0, (block.moves_b & bit) != 0});
  }
}

template <int D, int W>
bool list_held(Workers& workers, StepScratch<D>& scratch) {
  if (is_held_as_before<D, W>(workers, scratch)) return true;
  std::vector<HeldPair>& held = scratch.islands_solved.held;
  held.clear();
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    list_pairs_of<D, W>(blocks[i], static_cast<int>(i), held);
  for (std::size_t i = 0; i < scratch.joint_rows.size(); ++i) {
    const JointRow<D>& row = scratch.joint_rows[i];
    if (!is_held(row)) continue;
    held.push_back({row.body_a, row.body_b, static_cast<int>(i), -1, 1, moves(scratch, row.body_a),
                    moves(scratch, row.body_b)});
  }
  return false;
}

template <int D, int W>
struct InstantiateHeld {
  decltype(&list_held<D, W>) list = &list_held<D, W>;
};
template struct AtEveryWidth<InstantiateHeld>;

}  // namespace cycloid::solver
