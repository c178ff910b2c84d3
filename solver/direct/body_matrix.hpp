#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "solver/dim.hpp"
#include "solver/direct/wide.hpp"
#include "solver/workers.hpp"

namespace cycloid::solver {

/// What one body's freedoms, or those of a body and its neighbour, do to each other.
template <int N>
struct SquareBlock {
  Wide m[N][N];
};

/// A symmetric positive definite matrix of blocks, one row of blocks per body (node), factored as
/// L D L^T without pivoting: for islands of bodies that hold each other, whatever loops they form.
///
/// Nodes are eliminated by least degree, the lowest first among equals, so trees and chains fill in
/// nothing. In doubles, because the stiffness of what holds hides the masses of what it holds.
/// Source: George and Liu, "Computer Solution of Large Sparse Positive Definite Systems" (1981).
template <int D>
class BodyMatrix {
 public:
  static constexpr int kFreedoms = Dim<D>::kFreedoms;
  using Block = SquareBlock<kFreedoms>;
  using Vector = Vec<kFreedoms, Wide>;

  /// An empty pattern of this many nodes. Keeps its memory from call to call.
  void begin(int nodes);
  /// The block between two different nodes; makes one where there is none.
  int join(int a, int b);
  /// Orders the nodes [begin, end), which must be joined to no others, and finds what fills in.
  /// @returns false, and forgets them, where factoring would take more block products than
  /// `products_max`; else `steps` holds what `clear`, `factor` and `solve` ask for.
  bool analyse(Range nodes, int products_max, Range& steps);

  /// Block products that `factor` of all analysed nodes takes.
  std::uint64_t products() const { return products_; }

  /// Sets the blocks of these steps to zero, to be summed up by `diagonal` and `beside`.
  void clear(Range steps);
  /// Of which only the lower triangle is read.
  Block& diagonal(int node) { return diagonal_[static_cast<std::size_t>(node)]; }
  /// Rows are those of the higher node, columns those of the lower.
  Block& beside(int block) { return beside_[static_cast<std::size_t>(block)]; }

  void factor(Range steps);
  /// Replaces the right-hand sides of these steps' nodes by the solution. @pre factor(steps).
  void solve(Range steps, std::span<Vector> by_node) const;

 private:
  /// A node's neighbour and the block between them; a list in `links_`.
  struct Link {
    int node;
    int block;
    int next;
  };
  /// A block of the column of an eliminated node.
  struct Entry {
    int node;
    int block;
    bool transposed;  ///< Before it is factored: its rows are those of the eliminated node.
  };
  struct Step {
    int node;
    int entries;  ///< The first one; the next step's are the end.
    int targets;  ///< The first block that it changes beside the diagonal.
  };

  int find(int a, int b) const;
  void wait(int node);
  int take_least();
  int eliminate(int node);
  void eliminate_numbers(const Step& step, const Step& next);

  std::vector<int> first_link_;  ///< By node.
  std::vector<int> degree_;
  std::vector<std::uint8_t> eliminated_;
  std::vector<Link> links_;
  std::vector<std::pair<int, int>> heap_;  ///< Degree and node: none before what it halves to.
  std::vector<Step> steps_;                ///< One more than there are.
  std::vector<Entry> entries_;
  std::vector<int> targets_;
  std::vector<Block> diagonal_;
  std::vector<Block> inverse_;  ///< Of the pivots.
  std::vector<Block> beside_;   ///< By block; factored, those of L, rows of the later node.
  std::vector<Block> column_;   ///< Of the node being eliminated, before it is divided by.
  std::uint64_t products_ = 0;
};

}  // namespace cycloid::solver
