#pragma once

#include <cstddef>
#include <vector>

#include "solver/workers.hpp"

namespace cycloid::solver {

/// Sorts by keys below `kinds`, and leaves those of one key in the order that they had.
/// @param key_of  Of i, for i in [0, count).
/// @param ends  By key, where those of it end in the order; they begin where those of the key
/// before end.
/// @param place  Called with i and its place in the order.
template <class KeyOf, class Place>
void counting_sort(std::size_t count, std::size_t kinds, KeyOf&& key_of, std::vector<int>& ends,
                   Place&& place) {
  ends.assign(kinds + 1, 0);
  for (std::size_t i = 0; i < count; ++i) ++ends[key_of(i) + 1];
  for (std::size_t key = 1; key <= kinds; ++key) ends[key] += ends[key - 1];
  for (std::size_t i = 0; i < count; ++i) place(i, static_cast<std::size_t>(ends[key_of(i)]++));
}

/// Where those of a key are. @pre `ends` is of counting_sort.
inline Range range_of_key(const std::vector<int>& ends, std::size_t key) {
  return {key == 0 ? 0 : ends[key - 1], ends[key]};
}

}  // namespace cycloid::solver
