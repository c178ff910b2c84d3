#include <cstring>
#include <type_traits>

#include "solver/stages/island_rows.hpp"

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

/// All that the pair of a joint's row says.
struct HeldJoint {
  std::uint32_t body_a;
  std::uint32_t body_b;
  std::uint32_t is_held;
  std::uint32_t moves;
};

/// Numbers taken down one after the other, and whether they are those that stood there before.
class Ledger {
 public:
  Ledger(std::vector<std::uint32_t>& words, std::size_t count) : words_(words) {
    same_ = words_.size() == count;
    words_.resize(count);
  }

  template <class T>
  void put(const T& record) {
    static_assert(std::has_unique_object_representations_v<T> && sizeof(T) % 4 == 0);
    std::uint32_t* at = words_.data() + next_;
    next_ += sizeof(T) / 4;
    if (same_ && std::memcmp(at, &record, sizeof record) == 0) return;
    same_ = false;
    std::memcpy(at, &record, sizeof record);
  }

  bool is_same() const { return same_; }

 private:
  std::vector<std::uint32_t>& words_;
  std::size_t next_ = 0;
  bool same_;
};

template <int D>
static bool moves(const StepScratch<D>& scratch, std::uint32_t slot) {
  return scratch.masses[slot].inverse_mass > 0.0f;
}

/// @returns whether all that pairs are made of is as it was.
template <int D, int W>
static bool is_held_as_before(StepScratch<D>& scratch) {
  using Block = HeldBlock<D, W>;
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const std::size_t words =
      2 + (sizeof(Block) * blocks.size() + sizeof(HeldJoint) * scratch.joint_rows.size()) / 4;
  Ledger ledger(scratch.islands_solved.held_words, words);
  ledger.put(static_cast<std::uint32_t>(kLaneCount<W>));
  ledger.put(static_cast<std::uint32_t>(scratch.masses.size()));
  for (const ContactBlock<D, W>& block : blocks) {
    Block held;
    std::memcpy(held.body_a, block.body_a, sizeof held.body_a);
    std::memcpy(held.body_b, block.body_b, sizeof held.body_b);
    held.moves_a = block.moves_a;
    held.moves_b = block.moves_b;
    std::memcpy(held.has_point, block.has_point, sizeof held.has_point);
    ledger.put(held);
  }
  for (const JointRow<D>& row : scratch.joint_rows) {
    const std::uint32_t a_moves = moves(scratch, row.body_a) ? 1 : 0;
    const std::uint32_t b_moves = moves(scratch, row.body_b) ? 2 : 0;
    ledger.put(HeldJoint{row.body_a, row.body_b, is_held(row) ? 1u : 0u, a_moves | b_moves});
  }
  return ledger.is_same();
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
bool list_held(StepScratch<D>& scratch) {
  if (is_held_as_before<D, W>(scratch)) return true;
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
  static constexpr auto kList = &list_held<D, W>;
};
template struct InstantiateHeld<2, 1>;
template struct InstantiateHeld<2, 4>;
template struct InstantiateHeld<2, 8>;
template struct InstantiateHeld<2, 16>;
template struct InstantiateHeld<2, kAvx2Lanes>;
template struct InstantiateHeld<2, kAvx512Lanes>;
template struct InstantiateHeld<3, 1>;
template struct InstantiateHeld<3, 4>;
template struct InstantiateHeld<3, 8>;
template struct InstantiateHeld<3, 16>;
template struct InstantiateHeld<3, kAvx2Lanes>;
template struct InstantiateHeld<3, kAvx512Lanes>;

}  // namespace cycloid::solver
