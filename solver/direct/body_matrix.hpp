#pragma once

#include <cstdint>
#include <vector>

#include "solver/direct/block_kernels.hpp"

namespace cycloid::solver {

/// A symmetric positive definite matrix of blocks, one row of blocks per body (node), factored as
/// L D L^T without pivoting: for islands of bodies that hold each other, whatever loops they form.
///
/// Nodes are eliminated by least degree, among equals those first that have had it for longest,
/// then the lowest: so trees and chains fill in nothing, and a chain goes from both its ends, whose
/// steps need not wait for each other. Nodes that were put last come behind all others; what only
/// they change can then be solved again without the rest. In doubles, because the stiffness of what
/// holds hides the masses of what it holds.
/// Source: George and Liu, "Computer Solution of Large Sparse Positive Definite Systems" (1981).
template <int D>
class BodyMatrix {
 public:
  static constexpr int kFreedoms = Dim<D>::kFreedoms;
  using Block = SquareBlock<kFreedoms>;
  using Vector = Vec<kFreedoms, Wide>;
  using VectorPair = Vec<kFreedoms, WidePair>;
  template <class T>
  using ByNode = std::vector<Vec<kFreedoms, T>>;

  /// In lanes of which width `factor` works, see lane_widths.hpp. Changes no bit.
  void use_lanes(int width) { lanes_ = width; }

  /// An empty pattern of this many nodes. Keeps its memory from call to call.
  void begin(int nodes);
  /// The block between two different nodes; makes one where there is none.
  int join(int a, int b);
  /// Has a node eliminated behind those that were not put last.
  void put_last(int node) { is_last_[static_cast<std::size_t>(node)] = 1; }
  /// Orders the nodes [begin, end), which must be joined to no others, and finds what fills in.
  /// @returns false, and forgets them, where factoring would take more block products than
  /// `products_max`; else `steps` holds what `clear`, `factor` and `solve` ask for.
  bool analyse(Range nodes, int products_max, Range& steps);

  /// Which of an island's steps are of nodes that were put last.
  Range last_of(Range steps) const;
  /// Block products that `factor` of these steps takes.
  int products(Range steps) const;

  /// Sets the blocks of these steps to zero, to be summed up by `diagonal` and `beside`.
  void clear(Range steps);
  /// Of which only the lower triangle is read.
  Block& diagonal(int node) { return diagonal_[static_cast<std::size_t>(node)]; }
  /// Rows are those of the higher node, columns those of the lower.
  Block& beside(int block) { return beside_[static_cast<std::size_t>(block)]; }

  /// Sets aside the blocks that these steps begin with, and brings them back.
  /// @pre they are summed up, and the steps before them factored.
  void keep(Range steps);
  void restore(Range steps);

  /// Factors steps, whose blocks are summed up. @pre the steps of the island before are factored.
  void factor(Range steps);
  /// Replaces the right-hand sides of these steps' nodes by the solution: T is Wide, or WidePair
  /// for two of them at once. @pre factor(steps).
  template <class T>
  void solve(Range steps, ByNode<T>& by_node) const;
  /// Its two halves: forward through the steps, and back through them. @pre of `solve_upper`: the
  /// steps behind have been gone back through.
  template <class T>
  void solve_lower(Range steps, ByNode<T>& by_node) const;
  template <class T>
  void solve_upper(Range steps, ByNode<T>& by_node) const;

 private:
  /// A node's neighbour and the block between them; a list in `links_`.
  struct Link {
    int node;
    int block;
    int next;
  };
  /// Whose neighbour a node was found to be last, and the block between them: links are for good.
  struct Mark {
    int neighbour_of;
    int block;
  };
  /// A node in line to be eliminated.
  struct Waiting {
    int rank;   ///< Its degree, behind all others if it was put last.
    int since;  ///< The step that gave it that.
    int node;
    bool operator<(const Waiting& other) const {
      if (rank != other.rank) return rank < other.rank;
      return since != other.since ? since < other.since : node < other.node;
    }
  };

  int find(int a, int b) const;
  int add_link(int a, int b);
  void mark_neighbours(int node);
  int rank(int node) const;
  void wait(int node);
  int eliminate(int node);
  void copy_blocks(Range steps, const std::vector<Block>& from_diagonal,
                   const std::vector<Block>& from_beside, std::vector<Block>& to_diagonal,
                   std::vector<Block>& to_beside) const;

  int lanes_ = 4;
  std::vector<int> first_link_;  ///< By node.
  std::vector<int> degree_;
  std::vector<std::uint8_t> eliminated_;
  std::vector<std::uint8_t> is_last_;
  std::vector<Link> links_;
  std::vector<Mark> marks_;             ///< By node.
  std::vector<Waiting> line_;           ///< least_first.hpp.
  std::vector<EliminationStep> steps_;  ///< One more than there are.
  std::vector<ColumnEntry> entries_;
  std::vector<int> targets_;
  std::vector<Block> diagonal_;
  std::vector<Pivot<kFreedoms>> pivots_;
  std::vector<Block> beside_;  ///< By block; factored, those of L, rows of the later node.
  std::vector<Block> column_;  ///< Of the node being eliminated, not all divided by its pivot yet.
  std::vector<Block> kept_diagonal_;
  std::vector<Block> kept_beside_;
};

}  // namespace cycloid::solver
