#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace cycloid::solver {

/// A line in which the least is served first: a binary heap, none before what it halves to. By
/// operator<, a total order but for entries that are the same; so who comes next depends on nothing
/// else, as it would with the libraries' heaps where entries are equal.

template <class T>
void put_in_line(const T& entry, std::vector<T>& line) {
  std::size_t at = line.size();
  line.push_back(entry);
  while (at > 0 && line[at] < line[(at - 1) / 2]) {
    std::swap(line[at], line[(at - 1) / 2]);
    at = (at - 1) / 2;
  }
}

/// The least entry, which leaves the line. @pre there is one.
template <class T>
T take_least(std::vector<T>& line) {
  const T least = line.front();
  line.front() = line.back();
  line.pop_back();
  for (std::size_t at = 0, child = 1; child < line.size(); child = 2 * at + 1) {
    if (child + 1 < line.size() && line[child + 1] < line[child]) ++child;
    if (!(line[child] < line[at])) break;
    std::swap(line[at], line[child]);
    at = child;
  }
  return least;
}

}  // namespace cycloid::solver
