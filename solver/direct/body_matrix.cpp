#include "solver/direct/body_matrix.hpp"

#include <algorithm>
#include <utility>

#include "solver/lane_widths.hpp"
#include "solver/least_first.hpp"

namespace cycloid::solver {

template <int D>
void BodyMatrix<D>::begin(int nodes) {
  const auto count = static_cast<std::size_t>(nodes);
  first_link_.assign(count, -1);
  degree_.assign(count, 0);
  eliminated_.assign(count, 0);
  is_last_.assign(count, 0);
  links_.clear();
  marks_.assign(count, Mark{-1, -1});
  steps_.assign(1, EliminationStep{-1, 0, 0});
  entries_.clear();
  targets_.clear();
  diagonal_.resize(count);
  pivots_.resize(count);
  beside_.clear();
}

template <int D>
int BodyMatrix<D>::find(int a, int b) const {
  for (int i = first_link_[static_cast<std::size_t>(a)]; i >= 0;) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    if (link.node == b) return link.block;
    i = link.next;
  }
  return -1;
}

template <int D>
int BodyMatrix<D>::join(int a, int b) {
  const bool a_has_less =
      degree_[static_cast<std::size_t>(a)] < degree_[static_cast<std::size_t>(b)];
  const int found = a_has_less ? find(a, b) : find(b, a);
  return found >= 0 ? found : add_link(a, b);
}

template <int D>
int BodyMatrix<D>::add_link(int a, int b) {
  const int block = static_cast<int>(beside_.size());
  beside_.emplace_back();
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
    int& first = first_link_[static_cast<std::size_t>(from)];
    links_.push_back({to, block, first});
    first = static_cast<int>(links_.size()) - 1;
    ++degree_[static_cast<std::size_t>(from)];
  }
  return block;
}

/// Marks the neighbours of a node with their blocks: to search its list for each of them would take
/// the square of it, and lists grow as nodes fill in.
template <int D>
void BodyMatrix<D>::mark_neighbours(int node) {
  for (int i = first_link_[static_cast<std::size_t>(node)]; i >= 0;) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    marks_[static_cast<std::size_t>(link.node)] = {node, link.block};
    i = link.next;
  }
}

/// By which nodes stand in line: the degree, behind all those that are not put last.
template <int D>
int BodyMatrix<D>::rank(int node) const {
  constexpr int kBehindAll = 1 << 28;
  const auto at = static_cast<std::size_t>(node);
  return degree_[at] + (is_last_[at] != 0 ? kBehindAll : 0);
}

/// Puts a node in line by its present degree. Two entries in line of the same rank and step are of
/// different nodes, or they are the same; so who comes next depends on nothing else.
template <int D>
void BodyMatrix<D>::wait(int node) {
  put_in_line<Waiting>({rank(node), static_cast<int>(steps_.size()), node}, line_);
}

/// Block products that eliminating a node of so many neighbours takes.
static int products_of(int neighbours) {
  return neighbours + neighbours * (neighbours + 1) / 2;
}

/// Takes a node out of the graph and joins its neighbours. @returns the block products it takes.
template <int D>
int BodyMatrix<D>::eliminate(int node) {
  const std::size_t begin = entries_.size();
  eliminated_[static_cast<std::size_t>(node)] = 1;
  for (int i = first_link_[static_cast<std::size_t>(node)]; i >= 0;) {
    const Link& link = links_[static_cast<std::size_t>(i)];
    i = link.next;
    if (eliminated_[static_cast<std::size_t>(link.node)] == 0)
      entries_.push_back({link.node, link.block, link.node < node});
  }
  // Total order: a node has one link to each neighbour.
  std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(begin), entries_.end(),
            [](const ColumnEntry& a, const ColumnEntry& b) { return a.node < b.node; });
  for (std::size_t i = begin; i < entries_.size(); ++i) {
    const int one = entries_[i].node;
    --degree_[static_cast<std::size_t>(one)];
    if (i > begin) mark_neighbours(one);
    for (std::size_t j = begin; j < i; ++j) {
      const int other = entries_[j].node;
      const Mark mark = marks_[static_cast<std::size_t>(other)];
      targets_.push_back(mark.neighbour_of == one ? mark.block : add_link(one, other));
    }
  }
  for (std::size_t i = begin; i < entries_.size(); ++i) wait(entries_[i].node);
  if (column_.size() < entries_.size() - begin) column_.resize(entries_.size() - begin);
  return products_of(static_cast<int>(entries_.size() - begin));
}

template <int D>
bool BodyMatrix<D>::analyse(Range nodes, int products_max, Range& steps) {
  const EliminationStep first = steps_.back();
  const auto begin = static_cast<int>(steps_.size()) - 1;
  line_.clear();
  for (int node = nodes.begin; node < nodes.end; ++node) wait(node);
  int products = 0;
  while (!line_.empty() && products <= products_max) {
    const auto [rank_then, since, node] = take_least(line_);
    const auto at = static_cast<std::size_t>(node);
    if (eliminated_[at] != 0 || rank_then != rank(node)) continue;  // Its degree is an old one.
    products += eliminate(node);
    steps_.back().node = node;
    steps_.push_back({-1, static_cast<int>(entries_.size()), static_cast<int>(targets_.size())});
  }
  if (products > products_max) {
    steps_.resize(static_cast<std::size_t>(begin));
    steps_.push_back(first);
    entries_.resize(static_cast<std::size_t>(first.entries));
    targets_.resize(static_cast<std::size_t>(first.targets));
    return false;
  }
  steps = {begin, static_cast<int>(steps_.size()) - 1};
  return true;
}

template <int D>
Range BodyMatrix<D>::last_of(Range steps) const {
  int first = steps.end;
  while (first > steps.begin) {
    const int node = steps_[static_cast<std::size_t>(first) - 1].node;
    if (is_last_[static_cast<std::size_t>(node)] == 0) break;
    --first;
  }
  return {first, steps.end};
}

template <int D>
int BodyMatrix<D>::products(Range steps) const {
  int products = 0;
  for (int s = steps.begin; s < steps.end; ++s) {
    const auto at = static_cast<std::size_t>(s);
    products += products_of(steps_[at + 1].entries - steps_[at].entries);
  }
  return products;
}

template <int D>
void BodyMatrix<D>::clear(Range steps) {
  const auto& begin = steps_[static_cast<std::size_t>(steps.begin)];
  const auto& end = steps_[static_cast<std::size_t>(steps.end)];
  for (int s = steps.begin; s < steps.end; ++s)
    diagonal(steps_[static_cast<std::size_t>(s)].node) = Block{};
  for (int e = begin.entries; e < end.entries; ++e)
    beside(entries_[static_cast<std::size_t>(e)].block) = Block{};
}

template <int D>
void BodyMatrix<D>::keep(Range steps) {
  kept_diagonal_.resize(diagonal_.size());
  kept_beside_.resize(beside_.size());
  copy_blocks(steps, diagonal_, beside_, kept_diagonal_, kept_beside_);
}

template <int D>
void BodyMatrix<D>::restore(Range steps) {
  copy_blocks(steps, kept_diagonal_, kept_beside_, diagonal_, beside_);
}

template <int D>
void BodyMatrix<D>::copy_blocks(Range steps, const std::vector<Block>& from_diagonal,
                                const std::vector<Block>& from_beside,
                                std::vector<Block>& to_diagonal,
                                std::vector<Block>& to_beside) const {
  for (int s = steps.begin; s < steps.end; ++s) {
    const EliminationStep& step = steps_[static_cast<std::size_t>(s)];
    const auto node = static_cast<std::size_t>(step.node);
    to_diagonal[node] = from_diagonal[node];
    for (int e = step.entries; e < steps_[static_cast<std::size_t>(s) + 1].entries; ++e) {
      const auto block = static_cast<std::size_t>(entries_[static_cast<std::size_t>(e)].block);
      to_beside[block] = from_beside[block];
    }
  }
}

/// Replaces v by what the pivot answers to it.
template <int N, class T>
static void divide(const Pivot<N>& pivot, Vec<N, T>& v) {
  for (int i = 0; i < N; ++i)
    for (int k = 0; k < i; ++k) v[i] -= pivot.lower[i][k] * v[k];
  for (int i = N; i-- > 0;) {
    v[i] = pivot.inverse[i] * v[i];
    for (int k = i + 1; k < N; ++k) v[i] -= pivot.lower[k][i] * v[k];
  }
}

template <int D>
void BodyMatrix<D>::factor(Range steps) {
  const FactoredBlocks<D> of{steps_.data(),  entries_.data(), targets_.data(), diagonal_.data(),
                             beside_.data(), pivots_.data(),  column_.data()};
  if constexpr (kHasAvxKernels) {
    if (lanes_ == kAvx2Lanes || lanes_ == kAvx512Lanes)
      return BlockKernels<D, kAvx2Lanes>::factor(steps, of);
  }
  BlockKernels<D, 4>::factor(steps, of);
}

template <int D>
template <class T>
void BodyMatrix<D>::solve(Range steps, ByNode<T>& by_node) const {
  solve_lower(steps, by_node);
  solve_upper(steps, by_node);
}

template <int D>
template <class T>
void BodyMatrix<D>::solve_lower(Range steps, ByNode<T>& by_node) const {
  for (int s = steps.begin; s < steps.end; ++s) {
    const EliminationStep& step = steps_[static_cast<std::size_t>(s)];
    const Vec<kFreedoms, T>& from = by_node[static_cast<std::size_t>(step.node)];
    for (int e = step.entries; e < steps_[static_cast<std::size_t>(s) + 1].entries; ++e) {
      const ColumnEntry& entry = entries_[static_cast<std::size_t>(e)];
      const Block& lower = beside_[static_cast<std::size_t>(entry.block)];
      Vec<kFreedoms, T>& to = by_node[static_cast<std::size_t>(entry.node)];
      for (int i = 0; i < kFreedoms; ++i)
        for (int j = 0; j < kFreedoms; ++j) to[i] -= lower.at(i, j) * from[j];
    }
  }
}

template <int D>
template <class T>
void BodyMatrix<D>::solve_upper(Range steps, ByNode<T>& by_node) const {
  for (int s = steps.end; s-- > steps.begin;) {
    const EliminationStep& step = steps_[static_cast<std::size_t>(s)];
    Vec<kFreedoms, T>& to = by_node[static_cast<std::size_t>(step.node)];
    divide(pivots_[static_cast<std::size_t>(step.node)], to);
    for (int e = step.entries; e < steps_[static_cast<std::size_t>(s) + 1].entries; ++e) {
      const ColumnEntry& entry = entries_[static_cast<std::size_t>(e)];
      const Block& lower = beside_[static_cast<std::size_t>(entry.block)];
      const Vec<kFreedoms, T>& from = by_node[static_cast<std::size_t>(entry.node)];
      for (int i = 0; i < kFreedoms; ++i)
        for (int j = 0; j < kFreedoms; ++j) to[j] -= lower.at(i, j) * from[i];
    }
  }
}

template class BodyMatrix<2>;
template class BodyMatrix<3>;

template <int D, class T>
struct InstantiateSolve {
  static constexpr auto kSolve = &BodyMatrix<D>::template solve<T>;
  static constexpr auto kLower = &BodyMatrix<D>::template solve_lower<T>;
  static constexpr auto kUpper = &BodyMatrix<D>::template solve_upper<T>;
};
template struct InstantiateSolve<2, Wide>;
template struct InstantiateSolve<2, WidePair>;
template struct InstantiateSolve<3, Wide>;
template struct InstantiateSolve<3, WidePair>;

}  // namespace cycloid::solver
