#pragma once

#include <cstring>

#include "solver/direct/block_kernels.hpp"

namespace cycloid::solver {

/// The text of BlockKernels, for the files that compile it and no others. Every function is a
/// template on W.

/// The numbers of a column of a block; the fourth, which only fills up the vector, stays 0. Loads
/// and stores go by a vector of its own, without which GCC 12 takes the struct apart.
template <int N, int W>
struct WideColumn {
  static_assert(N == 3);
  typedef Wide Four __attribute__((vector_size(32)));
  Four four;

  [[gnu::always_inline]] static WideColumn load(const Wide* from) {
    Four numbers;
    std::memcpy(&numbers, from, sizeof numbers);
    return {numbers};
  }
  [[gnu::always_inline]] static WideColumn row_of(const SquareBlock<N>& block, int row) {
    const auto& of = block.columns;
    return {Four{of[0][row], of[1][row], of[2][row], 0.0}};
  }
  [[gnu::always_inline]] void store(Wide* to) const {
    const Four numbers = four;
    std::memcpy(to, &numbers, sizeof numbers);
  }
  friend WideColumn operator*(WideColumn a, Wide scale) { return {a.four * scale}; }
  friend WideColumn operator+(WideColumn a, WideColumn b) { return {a.four + b.four}; }
  friend WideColumn operator-(WideColumn a, WideColumn b) { return {a.four - b.four}; }
};

template <int W>
struct WideColumn<6, W> {
  typedef Wide Four __attribute__((vector_size(32)));
  typedef Wide Two __attribute__((vector_size(16)));
  Four four;
  Two two;

  [[gnu::always_inline]] static WideColumn load(const Wide* from) {
    Four first;
    Two last;
    std::memcpy(&first, from, sizeof first);
    std::memcpy(&last, from + 4, sizeof last);
    return {first, last};
  }
  [[gnu::always_inline]] static WideColumn row_of(const SquareBlock<6>& block, int row) {
    const auto& of = block.columns;
    return {Four{of[0][row], of[1][row], of[2][row], of[3][row]}, Two{of[4][row], of[5][row]}};
  }
  [[gnu::always_inline]] void store(Wide* to) const {
    const Four first = four;
    const Two last = two;
    std::memcpy(to, &first, sizeof first);
    std::memcpy(to + 4, &last, sizeof last);
  }
  friend WideColumn operator*(WideColumn a, Wide scale) { return {a.four * scale, a.two * scale}; }
  friend WideColumn operator+(WideColumn a, WideColumn b) {
    return {a.four + b.four, a.two + b.two};
  }
  friend WideColumn operator-(WideColumn a, WideColumn b) {
    return {a.four - b.four, a.two - b.two};
  }
};

/// A = L D L^T. @pre positive definite, as a body's own mass makes it; what rounding takes of a
/// pivot beyond that is given back.
template <int N, int W>
[[gnu::always_inline]] inline void factor_pivot(const SquareBlock<N>& block, Pivot<N>& pivot) {
  for (int i = 0; i < N; ++i) {
    Wide row[N];
    Wide left = block.columns[i][i];
    for (int j = 0; j < i; ++j) {
      row[j] = block.columns[j][i];
      for (int k = 0; k < j; ++k) row[j] -= row[k] * pivot.lower[j][k];
      pivot.lower[i][j] = row[j] * pivot.inverse[j];
      left -= row[j] * pivot.lower[i][j];
    }
    const Wide least = 1.0e-14 * block.columns[i][i];
    pivot.inverse[i] = 1.0 / (left > least ? left : least);
  }
}

/// Replaces b by b L^-T, and sets c = b D^-1 of that. Not by an inverse of the pivot, whose errors
/// would hide the masses behind a stiff one.
template <int N, int W>
[[gnu::always_inline]] inline void divide(const Pivot<N>& pivot, WideColumn<N, W> (&b)[N],
                                          WideColumn<N, W> (&c)[N]) {
  for (int j = 0; j < N; ++j) {
    for (int k = 0; k < j; ++k) b[j] = b[j] - b[k] * pivot.lower[j][k];
    c[j] = b[j] * pivot.inverse[j];
  }
}

/// Replaces c by c L^-1: with what `divide` has made, the block over the pivot.
template <int N, int W>
[[gnu::always_inline]] inline void divide_by_lower(const Pivot<N>& pivot,
                                                   WideColumn<N, W> (&c)[N]) {
  for (int j = N; j-- > 0;)
    for (int k = j + 1; k < N; ++k) c[j] = c[j] - c[k] * pivot.lower[k][j];
}

/// target -= a b^T.
template <int N, int W>
[[gnu::always_inline]] inline void subtract_product(const WideColumn<N, W> (&a)[N],
                                                    const SquareBlock<N>& b,
                                                    SquareBlock<N>& target) {
  for (int j = 0; j < N; ++j) {
    WideColumn<N, W> sum = a[0] * b.columns[0][j];
    for (int k = 1; k < N; ++k) sum = sum + a[k] * b.columns[k][j];
    (WideColumn<N, W>::load(target.columns[j]) - sum).store(target.columns[j]);
  }
}

/// The columns of a block, or those of its transpose: number by number, because what would be
/// stored so and loaded as a vector at once has to wait for the cache.
template <int N, int W>
[[gnu::always_inline]] inline void load_columns(const SquareBlock<N>& block, bool transposed,
                                                WideColumn<N, W> (&columns)[N]) {
  if (transposed)
    for (int j = 0; j < N; ++j) columns[j] = WideColumn<N, W>::row_of(block, j);
  else
    for (int j = 0; j < N; ++j) columns[j] = WideColumn<N, W>::load(block.columns[j]);
}

/// Takes a factored node out of the blocks of its neighbours. Of their own, products are symmetric,
/// and only the lower triangle is of use.
template <int D, int W>
[[gnu::always_inline]] inline void eliminate_node(const EliminationStep& step, int entries_end,
                                                  const FactoredBlocks<D>& of) {
  constexpr int kSize = Dim<D>::kFreedoms;
  const Pivot<kSize>& pivot = of.pivots[step.node];
  const int* target = of.targets + step.targets;
  for (int e = step.entries; e < entries_end; ++e) {
    const ColumnEntry& entry = of.entries[e];
    SquareBlock<kSize>& block = of.beside[entry.block];
    SquareBlock<kSize>& divided = of.column[e - step.entries];
    WideColumn<kSize, W> b[kSize];
    WideColumn<kSize, W> c[kSize];
    load_columns(block, entry.transposed, b);
    divide(pivot, b, c);
    for (int j = 0; j < kSize; ++j) c[j].store(divided.columns[j]);
    for (int before = 0; before < e - step.entries; ++before)
      subtract_product(b, of.column[before], of.beside[*target++]);
    subtract_product(b, divided, of.diagonal[entry.node]);
    divide_by_lower(pivot, c);
    for (int j = 0; j < kSize; ++j) c[j].store(block.columns[j]);
  }
}

template <int D, int W>
void BlockKernels<D, W>::factor(Range steps, const FactoredBlocks<D>& of) {
  for (int s = steps.begin; s < steps.end; ++s) {
    const EliminationStep& step = of.steps[s];
    factor_pivot<Dim<D>::kFreedoms, W>(of.diagonal[step.node], of.pivots[step.node]);
    eliminate_node<D, W>(step, of.steps[s + 1].entries, of);
  }
}

}  // namespace cycloid::solver
