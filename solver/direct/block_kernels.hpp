#pragma once

#include "solver/dim.hpp"
#include "solver/direct/wide.hpp"
#include "solver/workers.hpp"

namespace cycloid::solver {

/// What one body's freedoms, or those of a body and its neighbour, do to each other. By columns,
/// because lanes take the numbers of a column at once.
template <int N>
struct SquareBlock {
  static constexpr int kHeight = N == 3 ? 4 : N;  ///< What fills up lanes is 0.
  Wide columns[N][kHeight];

  Wide& at(int row, int column) { return columns[column][row]; }
  Wide at(int row, int column) const { return columns[column][row]; }
};

/// L D L^T of a node's own block, once nothing is left before it.
template <int N>
struct Pivot {
  Wide lower[N][N];  ///< Strictly below the diagonal.
  Wide inverse[N];   ///< Of D.
};

/// A block of the column of an eliminated node.
struct ColumnEntry {
  int node;
  int block;
  bool transposed;  ///< Before it is factored: its rows are those of the eliminated node.
};
struct EliminationStep {
  int node;
  int entries;  ///< The first one; the next step's are the end.
  int targets;  ///< The first block that it changes beside the diagonal.
};

/// What a BodyMatrix is factored from, and into.
template <int D>
struct FactoredBlocks {
  using Block = SquareBlock<Dim<D>::kFreedoms>;
  const EliminationStep* steps;  ///< One more than there are.
  const ColumnEntry* entries;
  const int* targets;
  Block* diagonal;                   ///< By node; of those only the lower triangle is read.
  Block* beside;                     ///< By block.
  Pivot<Dim<D>::kFreedoms>* pivots;  ///< By node.
  Block* column;                     ///< To work in: one for each entry of a step.
};

/// How blocks are factored: the same operations on each number, whatever W, so the same bits.
/// Compiled for vectors of two doubles (W = 4) and of four (kAvx2Lanes): block_kernels.cpp and
/// block_kernels_avx2.cpp, from the text in block_lanes.hpp.
template <int D, int W>
struct BlockKernels {
  /// BodyMatrix::factor.
  static void factor(Range steps, const FactoredBlocks<D>& of);
};

}  // namespace cycloid::solver
