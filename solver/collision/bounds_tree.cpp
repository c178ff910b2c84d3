#include "solver/collision/bounds_tree.hpp"

#include <algorithm>
#include <array>

#include "solver/lane_widths.hpp"
#include "solver/radix_sort.hpp"

namespace cycloid::solver {

/// Of each byte its bits with D - 1 zeros behind each.
template <int D>
static constexpr std::array<std::uint32_t, 256> spread_bytes() {
  std::array<std::uint32_t, 256> spread{};
  for (std::uint32_t byte = 0; byte < spread.size(); ++byte)
    for (int i = 0; i < 8; ++i) spread[byte] |= ((byte >> i) & 1u) << (i * D);
  return spread;
}

/// Spreads the low bits of x so that D - 1 zeros follow each.
template <int D>
static std::uint32_t spread_bits(std::uint32_t x) {
  static_assert(Dim<D>::kMortonBits <= 16);
  static constexpr std::array<std::uint32_t, 256> kSpread = spread_bytes<D>();
  return kSpread[x & 255u] | kSpread[(x >> 8) & 255u] << (8 * D);
}

/// Cells along each axis of a box of the world, whose centres of boxes become codes.
template <int D>
class MortonCells {
 public:
  explicit MortonCells(const Bounds<D>& world) : lower_(world.lower) {
    for (int i = 0; i < D; ++i)
      per_length_[i] = kCells / max(world.upper[i] - world.lower[i], 1.0e-6f);
  }
  std::uint32_t code_of(const Bounds<D>& box) const {
    std::uint32_t code = 0;
    for (int i = 0; i < D; ++i) {
      const float centre = 0.5f * (box.lower[i] + box.upper[i]);
      const float cell = clamp((centre - lower_[i]) * per_length_[i], 0.0f, kCells);
      code |= spread_bits<D>(static_cast<std::uint32_t>(cell)) << i;
    }
    return code;
  }

 private:
  static constexpr float kCells = static_cast<float>((1 << Dim<D>::kMortonBits) - 1);
  Vec<D> lower_;
  Vec<D> per_length_;  ///< 1/m
};

/// So many leaves a thread takes at once, and so many rows of them.
static constexpr int kLeafGrain = 512;
static constexpr int kRowGrain = kLeafGrain / BoundsRow<2>::kBoxes;
/// To share out the sorting of fewer takes more time than it saves.
static constexpr std::size_t kLeavesSharedMin = 1024;

template <int D>
static Bounds<D> bounds_of_leaves(const std::vector<typename BoundsTree<D>::Leaf>& leaves,
                                  Range range) {
  Bounds<D> bounds = leaves[static_cast<std::size_t>(range.begin)].bounds;
  for (int i = range.begin; i < range.end; ++i)
    bounds = merged(bounds, leaves[static_cast<std::size_t>(i)].bounds);
  return bounds;
}

template <int D>
void BoundsTree<D>::find_keys(const std::vector<Leaf>& leaves, Workers& workers,
                              TreeRoom<D>& room) {
  const auto count = static_cast<int>(leaves.size());
  room.worlds.resize(static_cast<std::size_t>((count + kLeafGrain - 1) / kLeafGrain));
  workers.parallel_for(count, kLeafGrain, [&](Range range) {
    room.worlds[static_cast<std::size_t>(range.begin / kLeafGrain)] =
        bounds_of_leaves<D>(leaves, range);
  });
  Bounds<D> world = room.worlds[0];
  for (const Bounds<D>& other : room.worlds) world = merged(world, other);
  const MortonCells<D> cells(world);
  room.keys.resize(leaves.size());
  workers.parallel_for(count, kLeafGrain, [&](Range range) {
    for (auto i = static_cast<std::uint32_t>(range.begin);
         i < static_cast<std::uint32_t>(range.end); ++i) {
      const std::uint64_t code = cells.code_of(leaves[i].bounds);
      room.keys[i] = {(code << 32) | leaves[i].id, i};
    }
  });
}

/// By Morton code, and by id where two codes are the same: a crowd in one cell. Keys are integers
/// that no two leaves share, so there is one order of them, whatever a library's sort does with
/// equals, and whether it counts or compares.
static void sort_keys(std::vector<TreeKey>& keys, std::vector<TreeKey>& room) {
  // Total order: the whole key, whose low half is the id, and ids are unique.
  const auto is_before = [](const TreeKey& a, const TreeKey& b) { return a.code < b.code; };
  if (keys.size() < kRadixSortMin) return std::sort(keys.begin(), keys.end(), is_before);
  const auto place_of = [](const TreeKey& key) {
    return static_cast<std::uint32_t>(key.code >> 32);
  };
  room.resize(keys.size());
  radix_sort(~std::uint32_t{0}, place_of, room, keys);
  for (auto first = keys.begin(); first != keys.end();) {
    auto last = first + 1;
    while (last != keys.end() && place_of(*last) == place_of(*first)) ++last;
    // Total order: the same; of these the high halves are equal, so it is that of the ids.
    if (last - first > 1) std::sort(first, last, is_before);
    first = last;
  }
}

/// Cuts the order into as many stretches, about as long as one another: by a few of the keys.
/// Where the cuts are cannot be seen in the order.
static void cut_into_stretches(const std::vector<TreeKey>& keys, std::size_t stretches,
                               std::vector<std::uint64_t>& cuts) {
  constexpr std::size_t kLookedAt = 64;
  cuts.resize(stretches * kLookedAt);
  for (std::size_t i = 0; i < cuts.size(); ++i) cuts[i] = keys[i * keys.size() / cuts.size()].code;
  // Total order: equal integers are one and the same.
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t s = 0; s < stretches; ++s) cuts[s] = cuts[s * kLookedAt];
  cuts[0] = 0;
  cuts.resize(stretches);
  cuts.push_back(~std::uint64_t{0});
}

/// Sorts the keys, stretch by stretch. @returns how many there are.
template <int D>
static int sort_stretches(Workers& workers, TreeRoom<D>& room) {
  const int count = room.keys.size() < kLeavesSharedMin ? 1 : workers.count();
  if (room.stretches.size() < static_cast<std::size_t>(count))
    room.stretches.resize(static_cast<std::size_t>(count));
  if (count == 1) {
    sort_keys(room.keys, room.stretches[0].room);
    return 1;
  }
  cut_into_stretches(room.keys, static_cast<std::size_t>(count), room.cuts);
  workers.parallel_for(count, 1, [&](Range one) {
    const auto at = static_cast<std::size_t>(one.begin);
    TreeStretch& stretch = room.stretches[at];
    stretch.keys.clear();
    for (const TreeKey& key : room.keys)
      if (key.code >= room.cuts[at] && key.code < room.cuts[at + 1]) stretch.keys.push_back(key);
    sort_keys(stretch.keys, stretch.room);
  });
  return count;
}

template <int D>
void BoundsTree<D>::build(const std::vector<Leaf>& leaves, Workers& workers, TreeRoom<D>& room) {
  leaves_.resize(leaves.size());
  if (leaves.empty()) return;
  find_keys(leaves, workers, room);
  const int stretches = sort_stretches(workers, room);
  const auto keys_of = [&](const TreeStretch& stretch) -> const std::vector<TreeKey>& {
    return stretches == 1 ? room.keys : stretch.keys;
  };
  std::size_t end = 0;
  for (int s = 0; s < stretches; ++s) {
    TreeStretch& stretch = room.stretches[static_cast<std::size_t>(s)];
    stretch.begin = end;
    end += keys_of(stretch).size();
  }
  workers.parallel_for(stretches, 1, [&](Range one) {
    const TreeStretch& stretch = room.stretches[static_cast<std::size_t>(one.begin)];
    std::size_t rank = stretch.begin;
    for (const TreeKey& key : keys_of(stretch)) leaves_[rank++] = leaves[key.leaf];
  });
  build_rows(workers);
}

/// Fills rows from `first` on with so many boxes, of which only the last has empty places.
template <int D>
template <class BoxOf>
void BoundsTree<D>::fill_rows(int first, int count, Workers& workers, BoxOf&& box_of) {
  constexpr int kBoxes = BoundsRow<D>::kBoxes;
  workers.parallel_for((count + kBoxes - 1) / kBoxes, kRowGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      BoundsRow<D> row;
      for (int place = 0; place < kBoxes; ++place) {
        const int at = i * kBoxes + place;
        if (at < count)
          row.set(place, box_of(at));
        else
          row.clear(place);
      }
      rows_[static_cast<std::size_t>(first + i)] = row;
    }
  });
}

template <int D>
void BoundsTree<D>::build_rows(Workers& workers) {
  constexpr int kBoxes = BoundsRow<D>::kBoxes;
  levels_ = 0;
  int end = 0;
  for (int count = size(); levels_ == 0 || count > 1; ++levels_) {
    first_row_[levels_] = end;
    count = (count + kBoxes - 1) / kBoxes;
    end += count;
  }
  rows_.resize(static_cast<std::size_t>(end));
  fill_rows(0, size(), workers, [&](int rank) -> const Bounds<D>& { return leaf(rank).bounds; });
  for (int level = 1; level < levels_; ++level) {
    const int below = first_row_[level - 1];
    const int begin = first_row_[level];
    fill_rows(begin, begin - below, workers,
              [&](int child) { return rows_[static_cast<std::size_t>(below + child)].all(); });
  }
}

template <int D>
bool BoundsTree<D>::search_on(BoundsSearch<D>& search, FoundBoxes& found) const {
  const RowsOfTree<D> tree{rows_.data(), first_row_, levels_};
  return at_widest([&]<int W>() { return BoundsKernels<D, W>::search_tree(tree, search, found); });
}

template class BoundsTree<2>;
template class BoundsTree<3>;

}  // namespace cycloid::solver
