#pragma once

#include <cstdint>

#include "solver/collision/bounds_row.hpp"
#include "solver/lanes.hpp"

namespace cycloid::solver {

/// What a search has found since it was asked last: numbers of boxes, ascending.
struct FoundBoxes {
  static constexpr int kMax = 64;
  std::uint32_t numbers[kMax];
  int count = 0;
};

/// The rows of a tree, level by level: box i of row r is of leaf 16 r + i, and one level up of row
/// 16 r + i. The last level has one row.
template <int D>
struct RowsOfTree {
  /// A sixteenth of what an int counts, a sixteenth of that, and so on.
  static constexpr int kLevelsMax = 8;

  const BoundsRow<D>* rows;
  const int* first_row;  ///< Of each level, from the leaves up.
  int levels;
};

/// A search of a tree or of rows, and where it goes on.
template <int D>
struct BoundsSearch {
  Bounds<D> box;
  bool has_begun = false;
  int level = 0;  ///< Of a tree; above its last one where nothing is left. Of rows: the next.
  int row[RowsOfTree<D>::kLevelsMax];                    ///< On the way to the leaves.
  std::uint32_t overlapping[RowsOfTree<D>::kLevelsMax];  ///< Boxes still to be gone into.
};

/// Searches, compiled for each instruction set: bounds_kernels.cpp, bounds_kernels_avx2.cpp and
/// bounds_kernels_avx512.cpp. What they find does not depend on W.
template <int D, int W>
struct BoundsKernels {
  /// Lists leaves whose boxes overlap that of the search, in their order, until there are no more
  /// or `found` could overflow. @returns whether it is to be called again. @pre levels > 0.
  static bool search_tree(const RowsOfTree<D>& tree, BoundsSearch<D>& search, FoundBoxes& found);
  /// The same of the boxes of `count` rows: number 16 r + i of box i of row r.
  static bool search_rows(const BoundsRow<D>* rows, int count, BoundsSearch<D>& search,
                          FoundBoxes& found);
};

/// Calls found(number) for all that `search(search, found)` lists, which calls a kernel.
template <int D, class Search, class Found>
void for_each_found(const Bounds<D>& box, Search&& search_on, Found&& act) {
  BoundsSearch<D> search;
  search.box = box;
  for (bool goes_on = true; goes_on;) {
    FoundBoxes found;
    goes_on = search_on(search, found);
    for (int i = 0; i < found.count; ++i) act(found.numbers[i]);
  }
}

}  // namespace cycloid::solver
