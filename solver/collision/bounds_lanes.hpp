#pragma once

#include "solver/collision/bounds_kernels.hpp"

namespace cycloid::solver {

/// The text of BoundsKernels, for the files that compile it and no others. Every function is a
/// template on W, so that those compiled for one instruction set have names of their own.

/// Bit i tells whether box i of the row overlaps.
template <int D, int W>
[[gnu::always_inline]] inline std::uint32_t overlapping(const BoundsRow<D>& row,
                                                        const Bounds<D>& box) {
  using L = Lanes<W>;
  std::uint32_t bits = 0;
  for (int at = 0; at < BoundsRow<D>::kBoxes; at += kLaneCount<W>) {
    typename L::Mask apart{};
    for (int i = 0; i < D; ++i)
      apart = apart | (L::load(row.lower[i] + at) > L(box.upper.v[i])) |
              (L(box.lower.v[i]) > L::load(row.upper[i] + at));
    bits |= bits_of<W>(~apart) << at;
  }
  return bits;
}

/// Lists the boxes of a row of leaves.
template <int D, int W>
[[gnu::always_inline]] inline void list_found(int row, std::uint32_t bits, FoundBoxes& found) {
  const auto first = static_cast<std::uint32_t>(BoundsRow<D>::kBoxes * row);
  for (; bits != 0; bits &= bits - 1)
    found.numbers[found.count++] = first + static_cast<std::uint32_t>(__builtin_ctz(bits));
}

/// Goes into a row of a tree.
template <int D, int W>
[[gnu::always_inline]] inline void go_into(const RowsOfTree<D>& tree, int level, int row,
                                           BoundsSearch<D>& search) {
  search.level = level;
  search.row[level] = row;
  search.overlapping[level] = overlapping<D, W>(tree.rows[tree.first_row[level] + row], search.box);
}

template <int D, int W>
bool BoundsKernels<D, W>::search_tree(const RowsOfTree<D>& tree, BoundsSearch<D>& search,
                                      FoundBoxes& found) {
  if (!search.has_begun) go_into<D, W>(tree, tree.levels - 1, 0, search);
  search.has_begun = true;
  while (search.level < tree.levels) {
    const int level = search.level;
    const int row = search.row[level];
    std::uint32_t& bits = search.overlapping[level];
    if (level == 0) {
      if (found.count > FoundBoxes::kMax - BoundsRow<D>::kBoxes) return true;
      list_found<D, W>(row, bits, found);
      bits = 0;
    }
    if (bits == 0) {
      ++search.level;
      continue;
    }
    const int child = BoundsRow<D>::kBoxes * row + __builtin_ctz(bits);
    bits &= bits - 1;
    go_into<D, W>(tree, level - 1, child, search);
  }
  return false;
}

template <int D, int W>
bool BoundsKernels<D, W>::search_rows(const BoundsRow<D>* rows, int count, BoundsSearch<D>& search,
                                      FoundBoxes& found) {
  for (; search.level < count; ++search.level) {
    if (found.count > FoundBoxes::kMax - BoundsRow<D>::kBoxes) return true;
    list_found<D, W>(search.level, overlapping<D, W>(rows[search.level], search.box), found);
  }
  return false;
}

}  // namespace cycloid::solver
