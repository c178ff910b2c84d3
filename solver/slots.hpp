#pragma once

#include <cstdint>
#include <vector>

namespace cycloid::solver {

/// The slot that the next record takes: the last freed, else a new one. Fails at the limit.
template <class Record>
bool has_room(const std::vector<Record>& slots, const std::vector<std::uint32_t>& free,
              std::size_t wanted, std::uint32_t limit) {
  return slots.size() - free.size() + wanted <= limit;
}

template <class Record>
std::uint32_t take_slot(std::vector<Record>& slots, std::vector<std::uint32_t>& free) {
  if (free.empty()) {
    slots.push_back(Record{});
    return static_cast<std::uint32_t>(slots.size() - 1);
  }
  const std::uint32_t index = free.back();
  free.pop_back();
  return index;
}

/// Empties a slot for the next one to take; whoever still names it is refused by its generation.
template <class Record>
void free_slot(std::uint32_t index, std::vector<Record>& slots, std::vector<std::uint32_t>& free) {
  const std::uint32_t generation = slots[index].generation + 1;
  slots[index] = Record{};
  slots[index].generation = generation;
  free.push_back(index);
}

}  // namespace cycloid::solver
