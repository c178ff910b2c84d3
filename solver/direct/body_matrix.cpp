#include "solver/direct/body_matrix.hpp"

#include <algorithm>

namespace cycloid::solver {

template <int D>
void BodyMatrix<D>::begin(int nodes) {
  const auto count = static_cast<std::size_t>(nodes);
  first_link_.assign(count, -1);
  degree_.assign(count, 0);
  eliminated_.assign(count, 0);
  links_.clear();
  steps_.assign(1, Step{-1, 0, 0});
  entries_.clear();
  targets_.clear();
  diagonal_.resize(count);
  inverse_.resize(count);
  beside_.clear();
  products_ = 0;
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
  if (found >= 0) return found;
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

/// Puts a node in line by its present degree. No two entries in line are of the same degree and
/// node, or they are the same; so who comes next depends on nothing else.
template <int D>
void BodyMatrix<D>::wait(int node) {
  std::size_t at = heap_.size();
  heap_.push_back({degree_[static_cast<std::size_t>(node)], node});
  while (at > 0 && heap_[at] < heap_[(at - 1) / 2]) {
    std::swap(heap_[at], heap_[(at - 1) / 2]);
    at = (at - 1) / 2;
  }
}

/// The node whose entry is the least, which leaves the line.
template <int D>
int BodyMatrix<D>::take_least() {
  const int node = heap_.front().second;
  heap_.front() = heap_.back();
  heap_.pop_back();
  for (std::size_t at = 0, child = 1; child < heap_.size(); child = 2 * at + 1) {
    if (child + 1 < heap_.size() && heap_[child + 1] < heap_[child]) ++child;
    if (!(heap_[child] < heap_[at])) break;
    std::swap(heap_[at], heap_[child]);
    at = child;
  }
  return node;
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
            [](const Entry& a, const Entry& b) { return a.node < b.node; });
  for (std::size_t i = begin; i < entries_.size(); ++i) {
    --degree_[static_cast<std::size_t>(entries_[i].node)];
    for (std::size_t j = begin; j < i; ++j)
      targets_.push_back(join(entries_[i].node, entries_[j].node));
  }
  for (std::size_t i = begin; i < entries_.size(); ++i) {
    wait(entries_[i].node);
  }
  const int count = static_cast<int>(entries_.size() - begin);
  return count + count * (count + 1) / 2;
}

template <int D>
bool BodyMatrix<D>::analyse(Range nodes, int products_max, Range& steps) {
  const Step first = steps_.back();
  const auto begin = static_cast<int>(steps_.size()) - 1;
  heap_.clear();
  for (int node = nodes.begin; node < nodes.end; ++node) wait(node);
  int products = 0;
  while (!heap_.empty() && products <= products_max) {
    const int degree = heap_.front().first;
    const int node = take_least();
    const auto at = static_cast<std::size_t>(node);
    if (eliminated_[at] != 0 || degree != degree_[at]) continue;  // Its degree is an old one.
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
  products_ += static_cast<std::uint64_t>(products);
  steps = {begin, static_cast<int>(steps_.size()) - 1};
  return true;
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

/// By LDL^T. @pre positive definite, as a body's own mass makes it; what rounding takes of a pivot
/// beyond that is given back.
template <int N>
static void invert(const SquareBlock<N>& block, SquareBlock<N>& inverse) {
  Wide lower[N][N];
  Wide inverse_pivot[N];
  for (int i = 0; i < N; ++i) {
    Wide row[N];
    Wide pivot = block.m[i][i];
    for (int j = 0; j < i; ++j) {
      row[j] = block.m[i][j];
      for (int k = 0; k < j; ++k) row[j] -= row[k] * lower[j][k];
      lower[i][j] = row[j] * inverse_pivot[j];
      pivot -= row[j] * lower[i][j];
    }
    const Wide least = 1.0e-14 * block.m[i][i];
    inverse_pivot[i] = 1.0 / (pivot > least ? pivot : least);
  }
  // The inverse of L, then its transpose times D^-1 times itself.
  Wide unit[N][N];
  for (int j = 0; j < N; ++j) {
    unit[j][j] = 1.0;
    for (int i = j + 1; i < N; ++i) {
      unit[i][j] = 0.0;
      for (int k = j; k < i; ++k) unit[i][j] -= lower[i][k] * unit[k][j];
    }
  }
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) {
      Wide sum = 0.0;
      for (int k = i; k < N; ++k) sum += unit[k][i] * inverse_pivot[k] * unit[k][j];
      inverse.m[i][j] = sum;
      inverse.m[j][i] = sum;
    }
}

/// c = a b, or a b^T.
template <int N>
static void multiply(const SquareBlock<N>& a, const SquareBlock<N>& b, SquareBlock<N>& c) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      Wide sum = a.m[i][0] * b.m[0][j];
      for (int k = 1; k < N; ++k) sum += a.m[i][k] * b.m[k][j];
      c.m[i][j] = sum;
    }
}
/// c -= a b^T.
template <int N>
static void subtract_product(const SquareBlock<N>& a, const SquareBlock<N>& b, SquareBlock<N>& c) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      Wide sum = a.m[i][0] * b.m[j][0];
      for (int k = 1; k < N; ++k) sum += a.m[i][k] * b.m[j][k];
      c.m[i][j] -= sum;
    }
}

/// The same of a product that is symmetric, of which only the lower triangle is read.
template <int N>
static void subtract_square(const SquareBlock<N>& a, const SquareBlock<N>& b, SquareBlock<N>& c) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) {
      Wide sum = a.m[i][0] * b.m[j][0];
      for (int k = 1; k < N; ++k) sum += a.m[i][k] * b.m[j][k];
      c.m[i][j] -= sum;
    }
}
template <int N>
static void transpose(const SquareBlock<N>& from, SquareBlock<N>& to) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) to.m[i][j] = from.m[j][i];
}

template <int D>
void BodyMatrix<D>::eliminate_numbers(const Step& step, const Step& next) {
  const Block& pivot = inverse_[static_cast<std::size_t>(step.node)];
  const auto count = static_cast<std::size_t>(next.entries - step.entries);
  if (column_.size() < count) column_.resize(count);
  std::size_t target = static_cast<std::size_t>(step.targets);
  for (std::size_t i = 0; i < count; ++i) {
    const Entry& entry = entries_[static_cast<std::size_t>(step.entries) + i];
    Block& block = beside(entry.block);
    Block& whole = column_[i];
    if (entry.transposed)
      transpose(block, whole);
    else
      whole = block;
    multiply(whole, pivot, block);
    for (std::size_t j = 0; j < i; ++j)
      subtract_product(block, column_[j], beside(targets_[target++]));
    subtract_square(block, whole, diagonal(entry.node));
  }
}

template <int D>
void BodyMatrix<D>::factor(Range steps) {
  for (int s = steps.begin; s < steps.end; ++s) {
    const Step& step = steps_[static_cast<std::size_t>(s)];
    invert(diagonal(step.node), inverse_[static_cast<std::size_t>(step.node)]);
    eliminate_numbers(step, steps_[static_cast<std::size_t>(s) + 1]);
  }
}

template <int D>
void BodyMatrix<D>::solve(Range steps, std::span<Vector> by_node) const {
  for (int s = steps.begin; s < steps.end; ++s) {
    const Step& step = steps_[static_cast<std::size_t>(s)];
    const Vector& from = by_node[static_cast<std::size_t>(step.node)];
    for (int e = step.entries; e < steps_[static_cast<std::size_t>(s) + 1].entries; ++e) {
      const Entry& entry = entries_[static_cast<std::size_t>(e)];
      const Block& lower = beside_[static_cast<std::size_t>(entry.block)];
      Vector& to = by_node[static_cast<std::size_t>(entry.node)];
      for (int i = 0; i < kFreedoms; ++i)
        for (int j = 0; j < kFreedoms; ++j) to[i] -= lower.m[i][j] * from[j];
    }
  }
  for (int s = steps.end; s-- > steps.begin;) {
    const Step& step = steps_[static_cast<std::size_t>(s)];
    const Block& pivot = inverse_[static_cast<std::size_t>(step.node)];
    Vector& to = by_node[static_cast<std::size_t>(step.node)];
    const Vector load = to;
    for (int i = 0; i < kFreedoms; ++i) {
      to[i] = 0.0;
      for (int j = 0; j < kFreedoms; ++j) to[i] += pivot.m[i][j] * load[j];
    }
    for (int e = step.entries; e < steps_[static_cast<std::size_t>(s) + 1].entries; ++e) {
      const Entry& entry = entries_[static_cast<std::size_t>(e)];
      const Block& lower = beside_[static_cast<std::size_t>(entry.block)];
      const Vector& from = by_node[static_cast<std::size_t>(entry.node)];
      for (int i = 0; i < kFreedoms; ++i)
        for (int j = 0; j < kFreedoms; ++j) to[j] -= lower.m[i][j] * from[i];
    }
  }
}

template class BodyMatrix<2>;
template class BodyMatrix<3>;

}  // namespace cycloid::solver
